#!/bin/bash
# the soak for 4 h of robot time a seed and as long of matches, one of them new in each run and printed: about an hour
set -euo pipefail
# shellcheck source=scripts/lib/project.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/project.sh"

need build test
RC10_SOAK_HOURS=${RC10_SOAK_HOURS:-4} RC10_MATCH_HOURS=${RC10_MATCH_HOURS:-4} RC10_SOAK_SEED=${RC10_SOAK_SEED:-$(date +%s)} \
    exec "$(dirname "${BASH_SOURCE[0]}")/soak.sh"
