"""The guests are those of bench/peers, the counter that of bench/table."""

import signal
import sys
from pathlib import Path

BENCH = Path(__file__).resolve().parents[2] / "bench"
sys.path[:0] = [str(BENCH), str(BENCH / "peers")]

# A run that is broken off removes its folders.
signal.signal(signal.SIGTERM, signal.default_int_handler)
