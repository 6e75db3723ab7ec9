# Sourced by the runners beside it: what they check, and the folder of packages they are given. Their last line is
# "N passed, N failed, N skipped".
# shellcheck shell=bash

repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
packages=$(realpath -m "${1:-$repo/build/packages}")
scratch=$(mktemp -d "${TMPDIR:-/tmp}/rc10-package.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
passed=0 failed=0

# check NAME COMMAND...: shows what it printed if it failed.
check() {
    if "${@:2}" >"$scratch/log" 2>&1; then
        passed=$((passed + 1))
        echo "ok      $1"
    else
        failed=$((failed + 1))
        sed 's/^/    /' "$scratch/log"
        echo "FAILED  $1"
    fi
}

finish() {
    echo "$passed passed, $failed failed, 0 skipped"
    [ "$failed" -eq 0 ]
}

# as_archive FOLDER: copies the packages there, as an archive for apt, and prints its line for mmdebstrap.
as_archive() {
    mkdir "$1"
    cp "$packages"/*.deb "$1"
    (cd "$1" && dpkg-scanpackages --multiversion . >Packages 2>/dev/null)
    # mmdebstrap reads it as another user.
    chmod -R go+rX "$scratch"
    echo "deb [trusted=yes] copy:$1 ./"
}
