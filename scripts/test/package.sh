#!/bin/bash
# the Debian packages: installed, run, upgraded, removed and purged under systemd, in User-Mode Linux
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test kernel package

if must_build dev; then suite tests/package "$repo/tests/package/run" "$repo/build/dev"; fi
finish
