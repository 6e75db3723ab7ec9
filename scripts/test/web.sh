#!/bin/bash
# the page of rc10-web: its types, its size, and each part of it in a real Chromium
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test web
need_python
export RC10_BUILD=$repo/build/dev

is_smaller_than() {
    local bytes most=$(($1 * 1024))
    shift
    bytes=$(find "$repo/build/web" -type f "$@" -print0 | xargs -0 cat | gzip -9 | wc -c)
    echo "$bytes bytes"
    # Length of an empty file, compressed: 20 bytes.
    [ "$bytes" -gt 20 ] && [ "$bytes" -le "$most" ]
}

# Size that a slow network brings in a second.
is_small() {
    is_smaller_than 200 "$@"
}

# Addresses in the page: names of XML namespaces alone, which no browser fetches.
asks_nobody_else() {
    local status=0
    grep -rohE 'https?://[^"'"'"' )]*' "$repo"/build/web --include='*.js' --include='*.css' --include='*.html' \
        >"$scratch/addresses" || status=$?
    [ "$status" -le 1 ] || return  # more: grep did not look
    status=0
    grep -vE '^http://www\.w3\.org/' "$scratch/addresses" || status=$?
    [ "$status" -eq 1 ]
}

step "the page is made, its types are right" "$repo/scripts/web.sh" check
step "at most 200 KiB, compressed, without what is loaded later" is_small ! -name editor.js ! -name mcap.js
step "the editor, which only one part loads: at most 200 KiB, compressed" is_small -name editor.js
step "what saves as MCAP, loaded for that: at most 50 KiB, compressed" is_smaller_than 50 -name mcap.js
step "it asks no other computer" asks_nobody_else
if must_build dev rc10-web rc10d rc10ctl rc10-lcm; then
    suite tests/studio "$repo/tests/host/run" tests/studio
fi
finish
