#!/bin/bash
# The project's tests; it installs what they need.
#   scripts/test.sh [PART...]     default: the tests that show that a fresh clone works here
# The last line is "N passed, N failed, N skipped". In CI (CI=true) nothing may be skipped.
set -euo pipefail
unset CDPATH # a `cd` that finds a folder by it prints that

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
# shellcheck source=scripts/lib/project.sh
. "$here/lib/project.sh"
# shellcheck source=scripts/lib/nearest.sh
. "$here/lib/nearest.sh"
# shellcheck source=scripts/lib/progress.sh
. "$here/lib/progress.sh"

# Order of starting: a part that leaves cores free starts beside those before it.
default=(unit kernel host pages)
ci=("${default[@]}" lint web demo tidy benchmarks faults soak)
# The two long parts that use one core each go beside each other.
all=("${default[@]}" package vm lint web demo clang benchmarks faults sanitize soak fuzz)
# Long, a Debian of its own, or from the net: not among all.
nightly=(arm64 fresh long_fuzz long_soak long_stream mutants registry)
parts=(build "${all[@]}" tidy "${nightly[@]}")

about() {
    sed -n '2s/^# //p' "$here/test/$1.sh"
}

usage() {
    echo "usage: scripts/test.sh [PART or set...]     default: default"
    local part
    for part in "${parts[@]}"; do
        printf '  %-11s %s\n' "$part" "$(about "$part")"
    done
    printf '  %-11s %s\n' default "${default[*]}" ci "${ci[*]}" all "${all[*]}" nightly "${nightly[*]}"
    echo "Minutes of each set: CONTRIBUTING.md"
}

wanted=()
for part in "${@:-default}"; do
    case $part in
        default | ci | all | nightly)
            declare -n set=$part
            [ "$part" != all ] || export RC10_GRID_S=60
            wanted+=("${set[@]}")
            ;;
        -h | --help) usage && exit ;;
        *)
            if [[ $part == *' '* || " ${parts[*]} " != *" $part "* ]]; then
                echo "test.sh: no part '$part'$(did_you_mean "$part" "${parts[@]}" default ci all nightly)" >&2
                echo "test.sh: scripts/test.sh --help lists them" >&2
                exit 2
            fi
            wanted+=("$part")
            ;;
    esac
done

# Costs of a set are those of the set alone.
name=
[ $# -gt 1 ] || name=${1:-default}

# Packages of all parts, at once.
mapfile -t groups < <(for part in "${wanted[@]}"; do sed -n 's/^need //p' "$here/test/$part.sh"; done | tr ' ' '\n' | sort -u)
# apt ignores Ctrl-C where it unpacks, and bash then forgets it.
trap 'exit 130' INT
missing=$("$here/install-deps.sh" --missing "${groups[@]}")
if [ -n "$missing" ]; then
    # run_parts.py says it as well, but Python is among the packages.
    cold_s=$(sed -n "/\"$name\": {/,/}/s/.*\"cold_s\": \([0-9]*\).*/\1/p" "$here/test/budget.json")
    how_long="How long they take: CONTRIBUTING.md."
    [ -z "$cold_s" ] || how_long="About $(as_minutes "$cold_s") on 2 cores, with the Debian packages, which come first."
    echo "rc10d's tests: ${wanted[*]}. $how_long"
    "$here/install-deps.sh" --may-ask "${groups[@]}"
fi
progress "test.sh: installing Debian packages" 90 need "${groups[@]}"
exec /usr/bin/python3 "$here/lib/run_parts.py" --name "$name" "${wanted[@]}"
