#!/bin/bash
# Makes the Python environment of the tests and tools, with ./python installed editable.
#   scripts/venv.sh       the last line printed is the path of its python
# RC10_VENV: where (default: .venv in the repository).
set -euo pipefail

repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv=${RC10_VENV:-$repo/.venv}
requirements=("$repo/python/requirements-dev.txt" "$repo/scripts/requirements.txt")

# Debian's own, not one that a version manager put first on PATH.
base=/usr/bin/python3
[ -x "$base" ] || base=$(command -v python3)

inputs() {
    "$base" --version
    echo "$venv"
    cat "${requirements[@]}" "$repo"/python/{pyproject.toml,hatch_build.py} "$repo"/lcm_types/*.lcm
}

# Whoever owns what a link points to would find it emptied.
if [ -L "$venv" ]; then
    echo "venv: $venv is a link: remove it, or say with RC10_VENV where the environment shall be" >&2
    exit 1
fi
mkdir -p "$venv"
venv=$(cd "$venv" && pwd)
exec 9<"$venv"
flock 9
hash=$(inputs | sha256sum)
if [ "$(cat "$venv/.inputs" 2>/dev/null)" != "$hash" ]; then
    echo "venv: making $venv" >&2
    "$base" -m venv --clear "$venv" >&2
    pip=("$venv/bin/python" -m pip --quiet --disable-pip-version-check install)
    "${pip[@]}" "${requirements[@]/#/--requirement=}" >&2
    # What it is built with is among the requirements.
    "${pip[@]}" --no-build-isolation --no-deps --editable "$repo/python" >&2
    echo "$hash" >"$venv/.inputs"
fi
echo "$venv/bin/python"
