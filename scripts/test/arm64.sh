#!/bin/bash
# cross-built for arm64: packages, and programs and unit tests under qemu (on request; about half an hour)
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build package
root=$repo/scripts/lib/cross_root
packages=$scratch/packages

# The build that package.sh has made, and the tests beside it.
unit_tests() {
    "$root" cmake --preset arm64 -DRC10_BUILD_TESTS=ON --log-level=WARNING >/dev/null || return
    "$root" cmake --build --preset arm64 --target app_test motor_test module_test config_test
}

step "a Debian with the libraries of arm64" "$root"
step "packages" env RC10_PACKAGES="$packages" "$repo/scripts/package.sh" --arm64
suite tests/package/contents "$repo/tests/package/contents" "$packages" arm64
step "unit tests are built" unit_tests
suite tests/arm64 "$root" tests/arm64/run
finish
