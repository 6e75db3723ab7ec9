#!/bin/bash
# Makes the Python environment of the project, with ./python installed editable.
#   scripts/venv.sh [client]     the last line printed is the path of its python
# client: no more than a robot program needs. Otherwise all that tests and tools need.
# RC10_VENV: where (default: .venv in the repository).
set -euo pipefail
unset CDPATH # a `cd` that finds a folder by it prints that
# Packages of the caller's, which pip would take for installed ones.
unset PYTHONPATH PYTHONHOME
export PIP_USER=0

repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
# shellcheck source=scripts/lib/owner.sh
. "$repo/scripts/lib/owner.sh"
venv=${RC10_VENV:-$repo/.venv}
client=("$repo/python/requirements.txt")
all=("$repo/python/requirements-dev.txt" "$repo/scripts/requirements.txt")

case ${1:-all} in
    client | all) wanted=${1:-all} ;;
    *) echo "venv: no part '$1': usage: scripts/venv.sh [client]" >&2 && exit 2 ;;
esac

# Debian's own, not one that a version manager put first on PATH.
base=/usr/bin/python3
[ -x "$base" ] || base=$(command -v python3)

# inputs REQUIREMENTS...: a hash of all that such an environment is made from.
inputs() {
    {
        "$base" --version
        echo "$venv"
        grep "^__version__" "$repo/python/src/rc10/__init__.py"
        cat "$@" "$repo"/scripts/python-hashes.txt "$repo"/python/{pyproject.toml,hatch_build.py} "$repo"/lcm_types/*.lcm
    } | sha256sum
}

# A link's target would be emptied.
if [ -L "$venv" ]; then
    echo "venv: $venv is a link: remove it, or say with RC10_VENV where the environment shall be" >&2
    exit 1
fi
mkdir -p "$venv"
venv=$(cd "$venv" && pwd -P)
exec 9<"$venv"
flock 9
# Making an environment empties its folder; one of ours has the file .inputs from its first moment.
if [ -n "$(ls -A "$venv" 2>/dev/null)" ] && [ ! -e "$venv/.inputs" ]; then
    echo "venv: $venv has files that this script did not make: remove them, or name another folder with RC10_VENV" >&2
    exit 1
fi
# others: what the folder has beside .inputs and what was there before.
others() {
    find "$venv" -mindepth 1 -maxdepth 1 ! -path "$venv/.inputs" ! -path "$venv/.before" "$@"
}

# One that works stays until another one does: there may be no network. It lies in .before meanwhile, with its .inputs,
# and with the file .moved as soon as all of it is there.
put_back() {
    trap '' INT TERM HUP
    [ ! -e "$venv/.before/.moved" ] || others -exec rm -rf {} +
    rm -f "$venv/.before/.moved"
    find "$venv/.before" -mindepth 1 -maxdepth 1 ! -name .inputs -exec mv -t "$venv" {} +
    mv "$venv/.before/.inputs" "$venv/.inputs"
    rmdir "$venv/.before"
    trap - INT TERM HUP
    echo "venv: $venv is as it was before" >&2
}

# It was ended in the middle, and could not say so.
if [ -e "$venv/.before/.moved" ] || { [ -e "$venv/.before/.inputs" ] && [ ! -s "$venv/.inputs" ]; }; then put_back; fi
client_hash=$(inputs "${client[@]}") all_hash=$(inputs "${client[@]}" "${all[@]}")
made_from=$(cat "$venv/.inputs" 2>/dev/null || true)
if [ "$made_from" != "$all_hash" ] && { [ "$wanted" = all ] || [ "$made_from" != "$client_hash" ]; }; then
    must_be_ours "$venv" "$repo/python/src/rc10/lcm_types"
fi
pip=("$venv/bin/python" -m pip --quiet --disable-pip-version-check install)

# install REQUIREMENTS...: with the hashes of python-hashes.txt, and nothing else.
install() {
    "$base" "$repo/scripts/lib/hashed_requirements.py" "$@" >"$venv/.requirements" || return
    "${pip[@]}" --require-hashes --requirement="$venv/.requirements" >&2
}

if [ "$made_from" != "$all_hash" ] && [ "$made_from" != "$client_hash" ]; then
    echo "venv: making $venv${made_from:+ anew: what it is made from has changed}" >&2
    if [ -n "$made_from" ]; then
        rm -rf "$venv/.before"
        mkdir "$venv/.before"
        cp "$venv/.inputs" "$venv/.before/.inputs"
        : >"$venv/.inputs"
        trap put_back EXIT
        others -exec mv -t "$venv/.before" {} +
        touch "$venv/.before/.moved"
    else
        : >"$venv/.inputs"
        others -exec rm -rf {} +
    fi
    "$base" -m venv "$venv" >&2
    install "${client[@]}"
    # Its build tools are among the requirements.
    "${pip[@]}" --no-build-isolation --no-deps --editable "$repo/python" >&2
    made_from=$client_hash
    echo "$made_from" >"$venv/.inputs"
fi
if [ "$wanted" = all ] && [ "$made_from" != "$all_hash" ]; then
    echo "venv: adding to $venv what tests and tools need" >&2
    install "${all[@]}"
    echo "$all_hash" >"$venv/.inputs"
fi
trap - EXIT
rm -f "$venv/.before/.moved" # first: from here on the new one is the one that works
rm -rf "$venv/.before"
echo "$venv/bin/python"
