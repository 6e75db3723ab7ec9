#!/bin/bash
# the README's first command: the release build, whose files are compiled together per folder, and three seconds of the demo
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

step "scripts/demo.sh" "$repo/scripts/demo.sh" --seconds 3
# The other programs and layers of that build.
if must_build release; then passed=$((passed + 1)); fi
finish
