#!/bin/bash
# an hour of three pages that draw 30 signals, while others come and go (RC10_STREAM_MINUTES): nothing grows
set -euo pipefail
# shellcheck source=scripts/lib/results.sh
. "$(dirname "${BASH_SOURCE[0]}")/../lib/results.sh"

need build test
need_python
export RC10_BUILD=$repo/build/dev
export RC10_STREAM_MINUTES=${RC10_STREAM_MINUTES:-60}

if must_build dev rc10-web rc10d rc10ctl rc10-lcm; then
    suite tests/stream env PYTHONPATH="$repo/tests/host" "$repo/tests/host/run" tests/stream
fi
finish
