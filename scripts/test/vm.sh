#!/bin/bash
# a real CAN controller driver on a PREEMPT_RT kernel, in QEMU; instructions and lateness counted on one, and instructions of a tick
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test vm
need_python
export RC10_BUILD=$repo/build/dev

if must_build dev && must_build dev benchmarks; then
    in_guests tests/vm "$repo/tests/vm/run"
    pytest_in tests/counted
fi
finish
