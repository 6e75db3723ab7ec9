#!/bin/bash
# the soak for 4 h of robot time a seed: about half an hour
set -euo pipefail
RC10_SOAK_HOURS=${RC10_SOAK_HOURS:-4} exec "$(dirname "${BASH_SOURCE[0]}")/soak.sh"
