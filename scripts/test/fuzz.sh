#!/bin/bash
# each fuzz target for a while, from the seeds in tests/fuzz/corpus (RC10_FUZZ_SECONDS, default 10)
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test lint
seconds=${RC10_FUZZ_SECONDS:-10}
findings=$repo/build/fuzz/findings

# What is found stays in build/fuzz/findings: give the file to the target to see it again.
fuzz() {
    local target=$1 name corpus=("$scratch/corpus") status=0 executions
    name=$(basename "$target")
    mkdir -p "$scratch/corpus" "$findings"
    [ ! -d "$repo/tests/fuzz/corpus/$name" ] || corpus+=("$repo/tests/fuzz/corpus/$name")
    "$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
        -artifact_prefix="$findings/$name-" "${corpus[@]}" >"$scratch/log" 2>&1 || status=$?
    rm -rf "$scratch/corpus"
    if [ "$status" -ne 0 ]; then
        tail -n 60 "$scratch/log"
        return "$status"
    fi
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$scratch/log")
    echo "$executions executions"
}

if must_build fuzz tests/fuzz/all; then
    for target in "$repo"/build/fuzz/fuzz/*_fuzz; do
        step "$(basename "$target")" fuzz "$target"
    done
fi
finish
