#!/bin/bash
# the benchmarks compile without a warning
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test
need_python

if must_build dev benchmarks; then passed=1; fi
finish
