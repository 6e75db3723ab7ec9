#!/bin/bash
# each fuzz target for a while, from the seeds in tests/fuzz/corpus (RC10_FUZZ_SECONDS, default 10)
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test lint
seconds=${RC10_FUZZ_SECONDS:-10}
findings=$repo/build/asan/findings

# libFuzzer takes 0 as for ever.
if ! [[ $seconds =~ ^[1-9][0-9]*$ ]]; then
    echo "FAILED fuzz: RC10_FUZZ_SECONDS=$seconds: give a whole number of seconds above 0"
    echo "0 passed, 1 failed, 0 skipped"
    exit 1
fi

# Findings stay in build/asan/findings: give the file to the target to see one again.
fuzz() {
    local target=$1 name corpus log=$scratch/$2.log
    name=$(basename "$target")
    corpus=("$scratch/$name.corpus")
    mkdir -p "${corpus[0]}" "$findings"
    [ ! -d "$repo/tests/fuzz/corpus/$name" ] || corpus+=("$repo/tests/fuzz/corpus/$name")
    "$target" -max_total_time="$seconds" -timeout=120 -rss_limit_mb=2048 -print_final_stats=1 \
        -artifact_prefix="$findings/$name-" "${corpus[@]}" >"$log" 2>&1
}

# Result of a target that has run.
judge() {
    if [ "$1" -ne 0 ]; then
        tail -n 60 "$2"
        return 1
    fi
    sed -n 's/^stat::number_of_executed_units: *\(.*\)/\1 executions/p' "$2"
}

# One target on each core.
if must_build asan tests/fuzz/all; then
    declare -A pids=()
    # By their sources: Ninja leaves the programs of those that are gone.
    for source in "$repo"/tests/fuzz/*_fuzz.cpp; do
        target=$repo/build/asan/fuzz/$(basename "$source" .cpp)
        while [ "$(jobs -rp | wc -l)" -ge "${RC10_JOBS:-$(nproc)}" ]; do wait -n || true; done
        name=$(basename "$target")
        fuzz "$target" "$name" &
        pids[$name]=$!
    done
    for name in "${!pids[@]}"; do
        status=0
        wait "${pids[$name]}" || status=$?
        step "$name" judge "$status" "$scratch/$name.log"
    done
fi
finish
