#!/bin/bash
# the order of the layers; links, quotes and tables of the pages; what the test scripts themselves do
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build
need_python

step "order of the layers" "$repo/tests/layers/check_layers.py" "$repo/src"
step "public headers are closed" "$repo/tests/layers/check_public_api.py" "$repo"
pytest_in tests/layers
pytest_in tests/docs
pytest_in tests/scripts
finish
