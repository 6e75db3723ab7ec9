#!/bin/bash
# the C++ unit tests in the dev build but those of the soak, programs built against an installed prefix, and the Python client's tests
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test
need_python

if must_build dev; then
    ctest_in dev but faults_test # the soak's, which takes as long as all others
    suite tests/install "$repo/tests/install/run" "$repo/build/dev"
fi
pytest_in python
finish
