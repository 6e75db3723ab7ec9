#!/bin/bash
# ten minutes of robot time full of random faults and three of matches, in virtual time, judged after every tick; the proof that their oracle sees (RC10_SOAK_HOURS a seed, RC10_SOAK_SEED, RC10_MATCH_HOURS)
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test
hours=${RC10_SOAK_HOURS:-0.084}
# Always the same, so that a change is judged by what it changed; long_soak looks for what is new.
seed=${RC10_SOAK_SEED:-2}
match_hours=${RC10_MATCH_HOURS:-0.05}

soak() {
    "$repo/build/dev/tests/rc10_soak" --hours "$hours" --seed "$1"
}

# Two seeds, side by side, and after the shorter the matches.
if must_build dev rc10_soak rc10_match faults_test; then
    soak "$seed" >"$scratch/other" 2>&1 &
    other=$!
    suite "rc10_soak, seed 1" soak 1
    suite "rc10_match, seed $seed" "$repo/build/dev/tests/rc10_match" --hours "$match_hours" --seed "$seed"
    status=0
    wait "$other" || status=$?
    # shellcheck disable=SC2016  # for the inner shell
    suite "rc10_soak, seed $seed" sh -c 'cat "$1"; exit "$2"' sh "$scratch/other" "$status"
    ctest_in dev only faults_test
fi
finish
