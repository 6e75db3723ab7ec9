# Sourced by the scripts: where things are, and how they come to be.
# shellcheck shell=bash

repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

# So that a fresh clone in another folder finds what was compiled before.
export CCACHE_BASEDIR=$repo CCACHE_NOHASHDIR=1

need() {
    "$repo/scripts/install-deps.sh" "$@"
}

# Sets RC10_PYTHON.
need_python() {
    RC10_PYTHON=$("$repo/scripts/venv.sh" | tail -n 1)
    export RC10_PYTHON
}

# build PRESET [TARGET...]: configures, and builds, with $build_options. Without a terminal only what went wrong
# is shown.
build_options=()
build() {
    local preset=$1
    shift
    local compile=(cmake --build --preset "$preset" --parallel "$(nproc)")
    [ $# -eq 0 ] || compile+=(--target "$@")
    compile+=("${build_options[@]}")
    echo "-- building $preset${*:+: $*}"
    (
        cd "$repo" || return
        cmake --preset "$preset" --log-level=WARNING >/dev/null || return
        if [ -t 1 ]; then
            "${compile[@]}"
        else
            "${compile[@]}" | sed -uE '/^\[[0-9]+\/[0-9]+\] /d'
        fi
    )
}
