"""Moments in which the machine stood still or kept a test's processes from its cores.

A test that is interrupted by such a moment may begin anew; no word of the program under test is a
reason by itself, nor is a wait of other work. A plugin of pytest, which tells at the end what began
anew.
"""

from __future__ import annotations

import contextlib
import threading
import time
from pathlib import Path

import pytest
from descendants import descendants

# A thread that only sleeps is woken at once where a core runs at all.
LOOK_S = 0.02
LATE_S = 0.06
# So long one of their threads had to wait for a core: a lease of 150 ms may have ended meanwhile.
WINDOW_S = 0.2
WAITING_NS = 60_000_000


def waited_ns() -> dict[Path, int]:
    """Time for which each thread of a test has waited for a core; none where nobody counts it."""
    waited = {}
    for pid in descendants():
        with contextlib.suppress(OSError, IndexError):  # ended
            for thread in Path(f"/proc/{pid}/task").iterdir():
                waited[thread] = int((thread / "schedstat").read_text().split()[1])
    return waited


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
        looked_s = asked_s = time.monotonic()
        waited: dict[Path, int] = {}
        while not self._ended.wait(LOOK_S):
            now_s = time.monotonic()
            if now_s - looked_s > LATE_S:
                self.last_s = now_s
            if now_s - asked_s >= WINDOW_S:
                before, waited, asked_s = waited, waited_ns(), now_s
                if any(ns - before.get(thread, ns) > WAITING_NS for thread, ns in waited.items()):
                    self.last_s = now_s
            looked_s = time.monotonic()


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
