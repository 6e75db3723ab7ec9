#!/bin/bash
# the README's first command: the release build, whose files are compiled together per folder, and three seconds of the demo
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build

demo() {
    "$repo/scripts/demo.sh" --seconds 3 | tee "$scratch/shown"
}

step "scripts/demo.sh" demo
step "it serves the page" grep -q 'http://localhost:' "$scratch/shown"
# The other programs and layers of that build.
if must_build release; then passed=$((passed + 1)); fi
finish
