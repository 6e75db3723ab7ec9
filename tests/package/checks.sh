# Sourced by the runners beside it: the folder of packages they are given.
# shellcheck shell=bash

unset CDPATH # a `cd` that finds a folder by it prints that
repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
packages=$(realpath -m "${1:-$repo/build/packages}")
# shellcheck source=scripts/lib/checks.sh
. "$repo/scripts/lib/checks.sh"

# as_archive FOLDER: copies the packages there, as an archive for apt, and prints its line for mmdebstrap.
as_archive() {
    mkdir "$1"
    cp "$packages"/*.deb "$1"
    (cd "$1" && dpkg-scanpackages --multiversion . >Packages 2>/dev/null)
    # mmdebstrap reads it as another user.
    chmod -R go+rX "$scratch"
    echo "deb [trusted=yes] copy:$1 ./"
}
