#!/bin/bash
# the fault campaign on real SocketCAN, in User-Mode Linux guests in virtual time
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test kernel
need_python
export RC10_BUILD=$repo/build/dev

if must_build dev; then in_guests tests/faults "$repo/tests/faults/run"; fi
finish
