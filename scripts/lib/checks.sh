# Sourced by runners of tests in shell: named checks, and counts in the last line.
# shellcheck shell=bash

passed=0 failed=0
scratch=$(mktemp -d "${TMPDIR:-/tmp}/rc10-checks.XXXXXX")
trap 'rm -rf "$scratch"' EXIT

# check NAME COMMAND...: its output is shown if it failed. A function ends at its first line that fails.
check() {
    local status
    # As a condition, the command would go on after a line that fails.
    set +e
    (set -e && "${@:2}") >"$scratch/log" 2>&1
    status=$?
    set -e
    if [ "$status" -eq 0 ]; then
        passed=$((passed + 1))
        echo "ok      $1"
    else
        failed=$((failed + 1))
        sed 's/^/    /' "$scratch/log"
        echo "FAILED  $1"
    fi
}

# End of the runner, also before its last check if one has failed.
finish() {
    echo "$passed passed, $failed failed, 0 skipped"
    if [ "$failed" -gt 0 ]; then exit 1; fi
}
