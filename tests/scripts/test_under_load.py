"""scripts/lib/under_load.py stops a tree of processes, lets it go on, and leaves nothing behind."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import descendants
import pytest
import under_load

pytestmark = pytest.mark.timeout(60)
REPO = Path(__file__).resolve().parents[2]
SCRIPT = REPO / "scripts" / "lib" / "under_load.py"
WAITS = "tail -f /dev/null"


class Observer:
    """In the place of the command: looks at the processes while they ought to stand still."""

    def __init__(self, *stopped: int, spared: int) -> None:
        self.stopped = stopped
        self.spared = spared
        self.state_of_spared = ""

    def wait(self, seconds: float) -> int:
        for pid in self.stopped:
            wait_for_state("T", pid)
        self.state_of_spared = descendants.processes()[self.spared].state
        raise subprocess.TimeoutExpired("command", seconds)


def wait_for_state(states: str, pid: int) -> None:
    """The time limit of the test ends this."""
    while descendants.processes()[pid].state not in states:
        pass


@pytest.fixture
def tree() -> Iterator[list[int]]:
    """A process, a child of it in a session of its own, and another process."""
    parent = subprocess.Popen(
        ["bash", "-c", f"setsid {WAITS} & echo $!; wait"], stdout=subprocess.PIPE, text=True
    )
    other = subprocess.Popen(WAITS.split())
    assert parent.stdout
    grandchild = int(parent.stdout.readline())
    yield [parent.pid, grandchild, other.pid]
    os.kill(grandchild, 9)
    for process in (parent, other):
        process.kill()
        process.communicate()


def test_all_descendants_are_stopped_and_go_on(tree: list[int]) -> None:
    parent, grandchild, spared = tree
    command = Observer(parent, grandchild, spared=spared)
    under_load.pause(0.03, frozenset({spared}), command)  # type: ignore[arg-type]
    assert command.state_of_spared != "T"
    for pid in (parent, grandchild):
        wait_for_state("RSD", pid)


def test_what_somebody_else_has_stopped_stays_so(tree: list[int]) -> None:
    parent, grandchild, spared = tree
    os.kill(grandchild, 19)
    wait_for_state("T", grandchild)
    under_load.pause(0.03, frozenset({spared}), Observer(parent, spared=spared))  # type: ignore[arg-type]
    wait_for_state("RSD", parent)
    assert descendants.processes()[grandchild].state == "T"


def test_whom_a_parent_stops_at_the_last_moment_stays_so(
    tree: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    parent, grandchild, spared = tree
    send = descendants.send

    def stop_the_child_first(number: signal.Signals, pids: set[int]) -> None:
        if number == signal.SIGSTOP and parent in pids:
            os.kill(grandchild, signal.SIGSTOP)
        send(number, pids)

    monkeypatch.setattr(under_load, "send", stop_the_child_first)
    under_load.pause(0.03, frozenset({spared}), Observer(parent, spared=spared))  # type: ignore[arg-type]
    wait_for_state("RSD", parent)
    wait_for_state("T", grandchild)  # as soon as it has the processor


def run(*command: str) -> subprocess.CompletedProcess[str]:
    options = ["--hogs", "2", "--every-ms", "10", "--stop-ms", "1"]
    return subprocess.run(
        [sys.executable, SCRIPT, *options, *command], capture_output=True, text=True, check=False
    )


def test_a_command_is_stopped_now_and_then() -> None:
    ends_once_continued = (
        "import signal, sys\n"
        "signal.signal(signal.SIGCONT, lambda *_: sys.exit(7))\n"
        "while True: signal.pause()"
    )
    done = run(sys.executable, "-c", ends_once_continued)
    assert done.returncode == 7
    assert "under_load: 0 pauses" not in done.stdout


def test_it_ends_with_the_status_of_its_command() -> None:
    assert run("sh", "-c", "exit 3").returncode == 3
    assert run("sh", "-c", "kill -9 $$").returncode == 128 + 9


def test_neither_its_hogs_nor_what_the_command_left_survive(tmp_path: Path) -> None:
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    end = os.open(fifo, os.O_RDONLY | os.O_NONBLOCK)
    # Its siblings are the hogs.
    siblings = "ps -ww --ppid $PPID -o pid=,args="
    done = run("bash", "-c", f"setsid {WAITS} >{fifo} & {siblings}; exit 0")
    hogs = [int(line.split()[0]) for line in done.stdout.splitlines() if "under_load.py" in line]
    assert len(hogs) == 2
    assert not [pid for pid in hogs if Path(f"/proc/{pid}").exists()]
    os.set_blocking(end, True)
    assert os.read(end, 1) == b"", "nobody has it open any more"
    os.close(end)
