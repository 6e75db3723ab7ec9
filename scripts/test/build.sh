#!/bin/bash
# the dev build: programs and tests compile without a warning
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test
need_python

# The kernel of the guests, beside it: make and Ninja each leave cores idle at their ends. Its tests tell what failed.
case "$(uname -m) ${RC10_PARTS:-} " in
    x86_64*" kernel "* | x86_64*" faults "*)
        need kernel
        "$repo/tests/kernel/build-kernel" >/dev/null &
        [ "${RC10_JOBS:-}" != 1 ] || wait
        ;;
esac
if must_build dev; then passed=1; fi
wait
finish
