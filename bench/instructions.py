"""Instructions inside Scheduler::tick(), counted by valgrind."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

# Two runs: their difference has no start.
SPANS = (100, 600)


def instructions_per_tick(tick_bench: Path, *fleet: str) -> float:
    """Figure of a whole tick of one fleet of bench/fleet.cpp; "full" after it: at its bounds."""
    first, second = (_collected(tick_bench, fleet, ticks) for ticks in SPANS)
    return (second - first) / (SPANS[1] - SPANS[0])


def _collected(tick_bench: Path, fleet: tuple[str, ...], ticks: int) -> int:
    command = [
        *("valgrind", "--tool=callgrind", "--callgrind-out-file=/dev/null"),
        "--toggle-collect=rc10::Scheduler::tick(*",
        *(str(tick_bench), "--ticks", str(ticks), *fleet),
    ]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    found = re.search(r"Collected\s*:\s*(\d+)", done.stderr)
    if not found or found[1] == "0":
        raise RuntimeError("valgrind counted nothing")
    return int(found[1])
