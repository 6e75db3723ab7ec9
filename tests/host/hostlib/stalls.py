"""Moments in which the machine stood still or had no core free: by its kernel, and by our clock.

A test that is interrupted by such a moment may begin anew; no word of the program under test is a
reason by itself. A plugin of pytest, which tells at the end what began anew.
"""

from __future__ import annotations

import threading
import time
from pathlib import Path

import pytest

# A thread that only sleeps is woken at once where a core runs at all.
LOOK_S = 0.02
LATE_S = 0.06
# So long some process had to wait for a core: a lease of 150 ms may have ended meanwhile.
WINDOW_S = 0.2
WAITING_US = 80_000
PRESSURE = Path("/proc/pressure/cpu")


def waited_us() -> int:
    """Time in which some process waited for a core; 0 where nobody counts it (no PSI)."""
    try:
        some = PRESSURE.read_text().splitlines()[0]
    except OSError:
        return 0
    return int(some.rpartition("total=")[2])


class StallWitness(threading.Thread):
    """Looks all the time, from its start on."""

    def __init__(self) -> None:
        super().__init__(daemon=True)
        self.last_s = float("-inf")
        self._ended = threading.Event()

    def end(self) -> None:
        self._ended.set()
        self.join()

    def run(self) -> None:
        looks = [(time.monotonic(), waited_us())]
        while not self._ended.wait(LOOK_S):
            now_s = time.monotonic()
            if now_s - looks[-1][0] > LATE_S:
                self.last_s = now_s
            looks = [look for look in looks if now_s - look[0] < WINDOW_S]
            looks.append((now_s, waited_us()))
            if looks[-1][1] - looks[0][1] > WAITING_US:
                self.last_s = now_s


WITNESS = StallWitness()
# Tests of this process, and of those of pytest-xdist.
BEGUN_ANEW: list[str] = []
FROM_WORKER = "begun anew"


def stood_still_since(begin_s: float, what: str) -> bool:
    """Whether the machine did, by time.monotonic(): then `what` begins anew, and is told."""
    stood_still = WITNESS.last_s >= begin_s
    if stood_still:
        BEGUN_ANEW.append(what)
    return stood_still


def pytest_sessionstart() -> None:
    WITNESS.start()


def pytest_sessionfinish(session: pytest.Session) -> None:
    WITNESS.end()
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput[FROM_WORKER] = BEGUN_ANEW


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: object) -> None:
    BEGUN_ANEW.extend(getattr(node, "workeroutput", {}).get(FROM_WORKER, ()))


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    for what in BEGUN_ANEW:
        terminalreporter.write_line(f"NOTE begun anew, for the machine stood still: {what}")
