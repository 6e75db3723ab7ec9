#!/bin/bash
# each fuzz target for ten minutes: about two hours, and rarely a finding
set -euo pipefail
# shellcheck source=scripts/lib/project.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/project.sh"

need build test lint
RC10_FUZZ_SECONDS=${RC10_FUZZ_SECONDS:-600} exec "$(dirname "${BASH_SOURCE[0]}")/fuzz.sh"
