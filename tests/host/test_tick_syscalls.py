"""Cost of a tick in system calls and page faults, counted from outside."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon, Program

if TYPE_CHECKING:
    from collections.abc import Iterator

TICKS = 300
BUSES = 2
FULL_READ = " = 64"

CALL = re.compile(r"^(\w+)\((\w+)")
# Lines of strace itself; a process that was stopped and goes on (signal(7)) is in its call again.
NO_CALL = re.compile(r"^strace:|^--- |^restart_syscall\(|.* = -1 EINTR |.* = \? ERESTART")


def trace(daemon: Daemon, thread: str, folder: Path) -> list[str]:
    """The system calls of one thread while the daemon goes on for some ticks."""
    tid = daemon.threads()[thread]
    output = folder / "strace"
    with Program("strace", "-p", str(tid), "-o", output) as strace:
        line = strace.wait_line(r"attached|not permitted|ptrace")[0]
        if "attached" not in line:
            pytest.skip(f"strace cannot attach: {strace.output}")
        tick = daemon.state()["tick"]
        daemon.wait_state(lambda s: s["tick"] > tick + TICKS, f"{TICKS} ticks")
    lines = [text for text in output.read_text().splitlines() if not NO_CALL.match(text)]
    # It was inside a call when strace came, and inside another when it went.
    return lines[1:-1]


@pytest.fixture
def busy(daemon: Daemon) -> Iterator[Daemon]:
    """Every motor is under a closed loop."""
    daemon.must("enable")
    with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s"):
        daemon.wait_motor("wheel", lambda m: m["velocity_rpm"] > 50, "turns")
        yield daemon


def test_the_scheduler_waits_once_and_receives_and_sends_once_for_each_bus(
    busy: Daemon, tmp_path: Path
) -> None:
    ticks: list[list[tuple[str, str]]] = []
    for text in trace(busy, "sched", tmp_path):
        call = CALL.match(text)
        assert call, text
        if call[1] == "clock_gettime":  # CPU time, read after an overrun, which strace causes
            continue
        if call[1] in ("read", "clock_nanosleep"):  # as `scheduler.timer` chose
            ticks.append([])
        elif ticks and not text.endswith(FULL_READ):  # after a delayed tick one read is not enough
            ticks[-1].append((call[1], call[2]))
    assert len(ticks) > TICKS / 2  # strace delays ticks, and late ones are skipped
    # The last one may be cut off.
    for calls in ticks[:-1]:
        names = [name for name, _ in calls]
        assert names == ["recvmmsg"] * BUSES + ["sendmmsg"] * BUSES, calls
        assert len(set(calls)) == 2 * BUSES, f"one bus twice: {calls}"


def test_frames_wake_nobody(busy: Daemon, tmp_path: Path) -> None:
    calls = trace(busy, "rx", tmp_path)
    assert {text.split("(")[0] for text in calls} <= {"ppoll"}, calls
    assert all("(Timeout)" in text for text in calls), calls
    assert len(calls) < TICKS / 3, "it wakes ten times a second, to be seen alive"


def page_faults(daemon: Daemon, tid: int) -> tuple[int, int]:
    """Minor and major faults of one thread, proc(5)."""
    text = Path(f"/proc/{daemon.pid}/task/{tid}/stat").read_text()
    fields = text.rpartition(")")[2].split()
    return int(fields[7]), int(fields[9])


def test_no_page_faults_while_it_runs(busy: Daemon) -> None:
    state = busy.state()
    if not state["realtime"]:
        pytest.skip(f"memory is not locked: {busy.stats()['notices']}")
    threads = [busy.threads()[name] for name in ("sched", "rx")]
    before = [page_faults(busy, tid) for tid in threads]
    busy.wait_state(lambda s: s["tick"] > state["tick"] + 3000, "3000 ticks")
    assert [page_faults(busy, tid) for tid in threads] == before
    assert busy.stats()["page_faults"] == 0
