# Sourced by the parts of the tests: counts what passed, failed and was skipped.
# shellcheck shell=bash

# shellcheck source=scripts/lib/project.sh
. "$(dirname "${BASH_SOURCE[0]}")/project.sh"
# shellcheck source=scripts/lib/cache.sh
. "$(dirname "${BASH_SOURCE[0]}")/cache.sh"

# Every file that does not compile, not only the first (ninja(1), -k).
build_options=(-- -k 0)

passed=0 failed=0 skipped=0
counts='^([0-9]+) passed, ([0-9]+) failed, ([0-9]+) skipped$'
scratch=$(mktemp -d "${TMPDIR:-/tmp}/rc10-test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT

fail() {
    echo "FAILED $*"
    failed=$((failed + 1))
}

# step NAME COMMAND...: one test, which passes when the command does. A function ends at its first line that fails.
step() {
    local status
    echo "-- $1"
    # As a condition, the command would go on after a line that fails.
    set +e
    (set -e && "${@:2}")
    status=$?
    set -e
    if [ "$status" -eq 0 ]; then
        passed=$((passed + 1))
    else
        fail "$1"
    fi
}

# must_build PRESET [TARGET...]: a broken build is one failed test.
must_build() {
    build "$@" && return
    fail "build of $1"
    return 1
}

# suite NAME COMMAND...: a test runner whose last line is "N passed, N failed, N skipped".
suite() {
    local status=0 last
    echo "-- $1"
    "${@:2}" 2>&1 | tee "$scratch/output" || status=$?
    last=$(tail -n 1 "$scratch/output")
    if ! [[ $last =~ $counts ]]; then
        fail "$1: it ended without a result"
        return
    fi
    passed=$((passed + BASH_REMATCH[1]))
    failed=$((failed + BASH_REMATCH[2]))
    skipped=$((skipped + BASH_REMATCH[3]))
    # Some runners return 1 for skipped tests; test.sh judges them: in CI they are failures.
    if [[ $status -ne 0 && ${BASH_REMATCH[2]} -eq 0 && ($status -ne 1 || ${BASH_REMATCH[3]} -eq 0) ]]; then
        fail "$1: status $status"
    elif [ $((BASH_REMATCH[1] + BASH_REMATCH[2] + BASH_REMATCH[3])) -eq 0 ]; then
        fail "$1: it ran no test"
    fi
}

# in_guests NAME COMMAND...: a suite whose guests are computers of x86.
in_guests() {
    if [ "$(uname -m)" = x86_64 ]; then
        suite "$@"
    else
        echo "SKIPPED $1: its guests are computers of x86, this one is $(uname -m)"
        skipped=$((skipped + 1))
    fi
}

# junit NAME COMMAND...: a test runner that takes, as one more argument, where to write JUnit's XML.
junit() {
    suite "$1" "$repo/scripts/lib/junit.py" "$scratch/report.xml" "${@:2}"
}

# ctest_in PRESET [only|but PROGRAM]: every C++ test of a build, or those of one program, or all others.
ctest_in() {
    local tree=$repo/build/$1 reports=() tests=()
    [ "${2:-}" != only ] || { reports=(--only "$3") && tests=(--tests-regex "^$3[.]"); }
    [ "${2:-}" != but ] || { reports=(--but "$3") && tests=(--exclude-regex "^$3[.]"); }
    suite "ctest, $*" "$repo/scripts/lib/junit.py" --folder "$tree/test-reports" "${reports[@]}" \
        ctest --test-dir "$tree" "${tests[@]}" --parallel "${RC10_JOBS:-$(nproc)}" --output-on-failure --no-tests=error
}

# pytest_in FOLDER [OPTION...]
pytest_in() {
    junit "pytest, $1" env --chdir="$repo/$1" "$RC10_PYTHON" -m pytest -q -p no:cacheprovider --timeout=600 \
        "${@:2}" --junitxml
}

# End of the part.
finish() {
    echo "$passed passed, $failed failed, $skipped skipped"
    if [ "$failed" -gt 0 ]; then exit 1; fi
}
