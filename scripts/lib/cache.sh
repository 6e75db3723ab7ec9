# Sourced by what serves all clones for later: its folder, $RC10_CACHE.
# shellcheck shell=bash

# can_write FOLDER: it is there, or is made.
can_write() {
    mkdir -p "$1" 2>/dev/null && [ -w "$1" ]
}

# In the clone where the home folder is read-only, or where there is none.
if [ -z "${RC10_CACHE:-}" ]; then
    RC10_CACHE=${XDG_CACHE_HOME:-${HOME:-/dev/null}/.cache}/rc10
    can_write "$RC10_CACHE" \
        || RC10_CACHE=$(CDPATH='' cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)/build/cache
fi
export RC10_CACHE
