#!/bin/bash
# clients that others publish (moteus, damiao-motor, motorbridge, python-can) turn our simulated drives, in a guest
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test kernel
need_python
export RC10_BUILD=$repo/build/dev

# Apart from the project's own, whose versions are others.
clients=$repo/build/registry
wanted=$repo/tests/registry/requirements.txt
if ! cmp -s "$wanted" "$clients/installed.txt"; then
    /usr/bin/python3 -m venv --clear "$clients"
    "$clients/bin/python" -m pip --quiet --disable-pip-version-check install --require-hashes --no-deps --requirement="$wanted"
    cp "$wanted" "$clients/installed.txt"
fi
if must_build dev rc10-sim; then suite tests/registry "$repo/tests/kernel/run" "$repo"/tests/registry/test_*.py; fi
finish
