#!/bin/bash
# The project's tests; it installs what they need.
#   scripts/test.sh [PART...]     default: all parts
# The last line is "N passed, N failed, N skipped". In CI (CI=true) nothing may be skipped.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
all=(lint unit host kernel faults vm package sanitize soak fuzz)
# Long, and only for who asks: not among all.
on_request=(arm64 fresh)
quick=(unit host lint)
counts='^([0-9]+) passed, ([0-9]+) failed, ([0-9]+) skipped$'

usage() {
    echo "usage: scripts/test.sh [PART...]"
    local part
    for part in "${all[@]}" "${on_request[@]}"; do
        printf '  %-9s %s\n' "$part" "$(sed -n '2s/^# //p' "$here/test/$part.sh")"
    done
    printf '  %-9s %s\n' quick "${quick[*]}" all "all but ${on_request[*]}, which run on request only"
}

parts=()
for part in "${@:-all}"; do
    case " ${all[*]} ${on_request[*]} " in
        *" $part "*) parts+=("$part") && continue ;;
    esac
    case $part in
        all) parts+=("${all[@]}") ;;
        quick) parts+=("${quick[@]}") ;;
        -h | --help) usage && exit ;;
        *)
            echo "test.sh: no part '$part'" >&2
            usage >&2
            exit 2
            ;;
    esac
done

log=$(mktemp "${TMPDIR:-/tmp}/rc10-test-log.XXXXXX")
trap 'rm -f "$log"' EXIT
passed=0 failed=0 skipped=0
table=

for part in "${parts[@]}"; do
    printf '\n==== %s: %s\n' "$part" "$(sed -n '2s/^# //p' "$here/test/$part.sh")"
    begin=$SECONDS
    status=0
    "$here/test/$part.sh" 2>&1 | tee "$log" || status=$?
    if [[ $(tail -n 1 "$log") =~ $counts ]]; then
        p=${BASH_REMATCH[1]} f=${BASH_REMATCH[2]} s=${BASH_REMATCH[3]}
        [ "$status" -eq 0 ] || [ "$f" -gt 0 ] || f=1
    else
        echo "FAILED $part: it ended with status $status and without a result"
        p=0 f=1 s=0
    fi
    passed=$((passed + p)) failed=$((failed + f)) skipped=$((skipped + s))
    took=$((SECONDS - begin))
    table+=$(printf '%-9s %7d %7d %7d %5d:%02d' "$part" "$p" "$f" "$s" $((took / 60)) $((took % 60)))$'\n'
done

printf '\n%-9s %7s %7s %7s %8s\n%s' part passed failed skipped min:s "$table"
bad=$failed
if [ "$skipped" -gt 0 ] && [ "${CI:-}" = true ]; then
    echo "in CI nothing may be skipped"
    bad=1
fi
echo "$passed passed, $failed failed, $skipped skipped"
[ "$bad" -eq 0 ]
