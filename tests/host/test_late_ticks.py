"""Late ticks: counted with a cause, and advice beside it."""

import os
import signal

from hostlib.daemon import Daemon
from hostlib.program import eventually


def late_ticks(daemon: Daemon) -> dict[str, int]:
    """By cause, without the threads that took the CPU: those are of one cause."""
    counters = daemon.stats()["counters"]
    causes = [name for name in counters if name.startswith("late ticks: ")]
    return {name: counters[name] for name in causes if " taken by " not in name}


def test_a_tick_that_is_late_is_counted_with_its_cause_and_told_with_advice(daemon: Daemon) -> None:
    daemon.wait_ready()
    before = late_ticks(daemon)
    assert len(before) == 8

    def paused_again() -> bool:
        # However short the pause is, a tick misses its time before long.
        os.kill(daemon.pid, signal.SIGSTOP)
        os.kill(daemon.pid, signal.SIGCONT)
        return sum(late_ticks(daemon).values()) > sum(before.values())

    eventually(paused_again, "a late tick is counted")
    shown = [line for line in daemon.must("stats").splitlines() if line.startswith("late ticks: ")]
    assert shown
    assert all("(" in line for line in shown)
