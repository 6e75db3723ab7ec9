#!/bin/bash
# the packages and the wheel that are shipped: opened, installed, run, upgraded and removed under systemd, compiled against
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build kernel package
need_python
packages=$scratch/packages

if must_build package; then
    step "packages and wheel" env RC10_PACKAGES="$packages" "$repo/scripts/package.sh"
    if [ "$failed" -eq 0 ]; then
        suite tests/package/contents "$repo/tests/package/contents" "$packages"
        suite tests/package/wheel "$repo/tests/package/wheel" "$packages"
        suite tests/package/compile "$repo/tests/package/compile" "$packages"
        in_guests tests/package/run "$repo/tests/package/run" "$packages"
    fi
fi
finish
