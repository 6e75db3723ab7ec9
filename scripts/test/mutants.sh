#!/bin/bash
# small changes of the safety core, each of which the unit tests must notice: 400 of them by RC10_MUTANTS_SEED, an hour and a half (RC10_MUTANTS; RC10_MUTANTS_PART=1/3 for a third of them)
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test
tools=$("$repo/scripts/lib/pinned_venv" "$repo/build/mutants/tools" "$repo/tests/mutants/requirements.txt")
suite "mutants" "$repo/scripts/lib/mutants.py" --mutate "$tools/mutate" --count "${RC10_MUTANTS:-400}" \
    --seed "${RC10_MUTANTS_SEED:-1}" --part "${RC10_MUTANTS_PART:-1/1}" --jobs "${RC10_JOBS:-$(nproc)}"
finish
