#!/bin/bash
# Makes the Debian packages, the Python wheel, their bill of materials (SPDX) and SHA256SUMS, into build/packages.
#   scripts/package.sh [--arm64] [--no-wheel]
# RC10_BUILD: a build tree to pack as it is, instead of making build/package (with --arm64: build/arm64).
# RC10_PACKAGES: another folder for what is made.
set -euo pipefail

# shellcheck source=scripts/lib/project.sh
. "$(dirname "${BASH_SOURCE[0]}")/lib/project.sh"
# shellcheck source=scripts/lib/nearest.sh
. "$repo/scripts/lib/nearest.sh"

preset=package wheel=yes run=()
for option in "$@"; do
    case $option in
        --arm64) preset=arm64 wheel='' run=("$repo/scripts/lib/cross_root") ;;
        --no-wheel) wheel= ;;
        *)
            echo "usage: scripts/package.sh [--arm64] [--no-wheel]"
            [[ $option =~ ^(-h|--help)$ ]] && exit
            echo "package: no option '$option'$(did_you_mean "$option" --arm64 --no-wheel)" >&2
            exit 2
            ;;
    esac
done

packages=$(realpath -m "${RC10_PACKAGES:-$repo/build/packages}")
mkdir -p "$packages"
# The same commit makes the same packages.
SOURCE_DATE_EPOCH=$(git -C "$repo" log -1 --format=%ct 2>/dev/null || date +%s)
export SOURCE_DATE_EPOCH

need build package
"$repo/scripts/web.sh" >/dev/null
tree=${RC10_BUILD:-$repo/build/$preset}
if [ -z "${RC10_BUILD:-}" ] && [ "$preset" = package ]; then
    build package
elif [ -z "${RC10_BUILD:-}" ]; then
    "${run[@]}" cmake --preset "$preset" --log-level=WARNING >/dev/null
    "${run[@]}" cmake --build --preset "$preset"
fi
rm -rf "$tree/packages"
# By its path from the repository, which is elsewhere in the root for arm64.
if ! (cd "$repo" && umask 022 \
    && "${run[@]}" cmake -E chdir "$(realpath --relative-to="$repo" "$tree")" cpack) >"$packages/cpack.log" 2>&1; then
    cat "$packages/cpack.log" >&2
    exit 1
fi
# Those of earlier versions go; the other architecture's stay.
architecture=$(dpkg-deb --field "$(find "$tree/packages" -name '*.deb' -print -quit)" Architecture)
rm -f "$packages"/{,lib}rc10*_"$architecture".deb
cp "$tree"/packages/*.deb "$packages"
rm -rf "$packages/cpack.log" "$tree/packages"

if [ -n "$wheel" ]; then
    need_python
    rm -f "$packages"/*.whl
    "$RC10_PYTHON" -m pip --quiet --disable-pip-version-check wheel --no-deps --no-build-isolation \
        --wheel-dir "$packages" "$repo/python"
fi

# Headers and archives, whose code is in the programs, as the build found them.
# shellcheck disable=SC2016  # dpkg-query expands
"${run[@]}" dpkg-query --show --showformat '${db:Status-Status} ${Package} ${Version}\n' '*-dev' \
    | sed -n 's/^installed //p' | sort -u \
    | grep -F -f <("$repo/scripts/install-deps.sh" --list build | grep -e '-dev$' | sed 's/$/ /') >"$tree/build-packages"
/usr/bin/python3 "$repo/scripts/lib/sbom.py" "$packages" "$tree/build-packages"
ls -l "$packages"
