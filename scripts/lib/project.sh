# Sourced by the scripts: where things are, and how they come to be.
# shellcheck shell=bash

unset CDPATH # a `cd` that finds a folder by it prints that
# Python packages of the caller's, which go before those that are pinned here.
unset PYTHONPATH PYTHONHOME
export PIP_USER=0
# Without symbolic links, as CMake and Python name files.
repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)
# shellcheck source=scripts/lib/owner.sh
. "$repo/scripts/lib/owner.sh"

# ccache: hits across clones in different folders.
export CCACHE_BASEDIR=$repo CCACHE_NOHASHDIR=1
# It fails each compilation where it cannot write. An old ~/.ccache stays its folder; without it the default is asked.
ccache_folder=$(ccache --get-config cache_dir 2>/dev/null) \
    || ccache_folder=${CCACHE_DIR:-${XDG_CACHE_HOME:-${HOME:-}/.cache}/ccache}
if ! mkdir -p "$ccache_folder" 2>/dev/null || [ ! -w "$ccache_folder" ]; then export CCACHE_DISABLE=1; fi

need() {
    "$repo/scripts/install-deps.sh" "$@"
}

# Sets RC10_PYTHON.
need_python() {
    RC10_PYTHON=$("$repo/scripts/venv.sh" | tail -n 1)
    export RC10_PYTHON
}

# build PRESET [TARGET...]: configures if the preset is new, and builds, with $build_options and on $RC10_JOBS cores,
# default all. Without a terminal only what went wrong is shown, unless $build_shows_files.
build_options=() build_shows_files=
build() {
    local preset=$1
    shift
    local compile=(cmake --build --preset "$preset" --parallel "${RC10_JOBS:-$(nproc)}")
    [ $# -eq 0 ] || compile+=(--target "$@")
    compile+=("${build_options[@]}")
    echo "-- building $preset${*:+: $*}"
    # As a condition, as most callers need it, it would go on after a line that fails.
    mkdir -p "$repo/build" || return
    must_be_ours "$repo/build" -maxdepth 0 || return
    must_be_ours "$repo/build/.$preset.lock" "$repo/build/$preset" || return
    (
        cd "$repo" || return
        # Two builds in one tree would disturb each other.
        { exec 8>"build/.$preset.lock"; } || return
        flock 8 || return
        # One that was copied with its clone would build that one.
        if [ -e "build/$preset/CMakeCache.txt" ] \
            && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$repo" "build/$preset/CMakeCache.txt"; then
            rm -rf "build/$preset"
        fi
        # Once: it writes the lists of tests anew, which ctest of another part may be reading.
        if [ ! "build/$preset/build.ninja" -nt CMakePresets.json ]; then
            cmake --preset "$preset" --log-level=WARNING >/dev/null || return
        fi
        if [ -t 1 ] || [ -n "$build_shows_files" ]; then
            "${compile[@]}" 8>&-
        else
            "${compile[@]}" 8>&- | sed -uE '/^\[[0-9]+\/[0-9]+\] /d'
        fi
    )
}
