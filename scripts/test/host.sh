#!/bin/bash
# the whole daemon on the simulated bus
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test languages
need_python
export RC10_BUILD=$repo/build/dev

if must_build dev; then suite tests/host "$repo/tests/host/run"; fi
finish
