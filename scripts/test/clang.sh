#!/bin/bash
# each source and header compiles by itself without a warning of clang; clang-tidy of all sources
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build lint test

# The headers made in the build are there then.
if must_build tidy rc10_lcm_headers && must_build tidy-together rc10_lcm_headers; then
    step "each source and header by itself" "$repo/scripts/lib/alone.py" "$repo/build/tidy"
    step "clang-tidy" "$repo/scripts/lib/tidy.py" "$repo/build/tidy-together"
fi
finish
