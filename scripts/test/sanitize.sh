#!/bin/bash
# the C++ unit tests under AddressSanitizer with UBSan, and those of what has threads under ThreadSanitizer
set -euo pipefail

# GCC 12's ThreadSanitizer does not start where the kernel randomises addresses by more bits than it
# expects.
if [ -z "${RC10_FIXED_ADDRESSES:-}" ] && setarch -R true 2>/dev/null; then
    RC10_FIXED_ADDRESSES=yes exec setarch -R "$0" "$@"
fi

# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test lint
export ASAN_OPTIONS=detect_stack_use_after_return=1:strict_string_checks=1
export UBSAN_OPTIONS=print_stacktrace=1
export TSAN_OPTIONS="second_deadlock_stack=1 suppressions=$repo/tests/tsan.supp"

for preset in asan tsan; do
    if must_build "$preset" unit_tests; then ctest_in "$preset"; fi
done
finish
