#!/bin/bash
# clang-tidy of each source that changed, or includes what changed, compiled by itself (RC10_TIDY_SINCE: a commit; default: a day before the newest)
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build lint test

# The last commit that is a day older than the newest. Without one, as in a shallow clone: the empty tree.
a_day_ago() {
    local day=$(($(git -C "$repo" log -1 --format=%ct) - 86400)) commit
    commit=$(git -C "$repo" rev-list -1 --before="$day" HEAD)
    echo "${commit:-$(git -C "$repo" hash-object -t tree /dev/null)}"
}

since=${RC10_TIDY_SINCE:-$(a_day_ago)}
# The headers made in the build are there then.
if must_build tidy rc10_lcm_headers; then
    step "clang-tidy of what changed since $since" \
        "$repo/scripts/lib/tidy.py" "$repo/build/tidy" --since "$since"
fi
finish
