#!/bin/bash
# hours of robot time full of random faults, in virtual time (RC10_SOAK_HOURS, default 0.4 a seed)
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test
hours=${RC10_SOAK_HOURS:-0.4}

# One seed that is always the same, and one of its own for each run, printed to see a finding again.
if must_build dev rc10_soak; then
    suite "rc10_soak, seed 1" "$repo/build/dev/tests/rc10_soak" --hours "$hours" --seed 1
    seed=$(date +%s)
    suite "rc10_soak, seed $seed" "$repo/build/dev/tests/rc10_soak" --hours "$hours" --seed "$seed"
fi
finish
