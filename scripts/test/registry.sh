#!/bin/bash
# clients that others publish (moteus, damiao-motor, motorbridge, python-can) turn our simulated drives, in a guest
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test kernel
need_python
export RC10_BUILD=$repo/build/dev

# Apart from the project's own, whose versions are others.
"$repo/scripts/lib/pinned_venv" "$repo/build/registry" "$repo/tests/registry/requirements.txt"
if must_build dev rc10-sim; then in_guests tests/registry "$repo/tests/kernel/run" "$repo"/tests/registry/test_*.py; fi
finish
