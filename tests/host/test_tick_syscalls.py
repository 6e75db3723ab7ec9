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

CALL = re.compile(r"^(\w+)\((\d+)")
# Of strace itself; a process that was stopped and goes on (signal(7)) is in its call once more.
NO_CALL = re.compile(r"^strace:|^--- |^restart_syscall\(|.* = -1 EINTR |.* = \? ERESTART")
EPOLL = re.compile(r"^epoll_wait\(.* = (\d+)$")


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
    assert len(lines) > TICKS
    return lines[1:-1]


@pytest.fixture
def busy(daemon: Daemon) -> Iterator[Daemon]:
    """Every motor is under a closed loop."""
    daemon.must("enable")
    with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s"):
        daemon.wait_motor("wheel", lambda m: m["velocity_rpm"] > 50, "turns")
        yield daemon


def test_the_scheduler_reads_its_timer_and_sends_once_for_each_bus(
    busy: Daemon, tmp_path: Path
) -> None:
    calls = trace(busy, "sched", tmp_path)
    ticks: list[list[str]] = []
    for text in calls:
        call = CALL.match(text)
        assert call, text
        if call[1] == "read":
            assert text.endswith(" = 8"), text
            ticks.append([])
        else:
            assert call[1] == "sendmmsg", text
            assert "= -1" not in text, text
            if ticks:
                ticks[-1].append(call[2])
    # The last one may be cut off.
    for sent in ticks[:-1]:
        assert len(sent) == len(set(sent)) == BUSES, sent


def test_rx_waits_and_reads_once_for_each_readable_bus(busy: Daemon, tmp_path: Path) -> None:
    readable: int | None = None
    received: set[str] = set()
    for text in trace(busy, "rx", tmp_path):
        call = CALL.match(text)
        assert call, text
        if call[1] == "epoll_wait":
            assert readable is None or len(received) == readable
            wait = EPOLL.match(text)
            assert wait, text
            readable, received = int(wait[1]), set()
        else:
            assert call[1] == "recvmmsg", text
            if readable is not None:
                assert call[2] not in received, f"twice in one turn: {text}"
                received.add(call[2])


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
