"""The line of scripts/lib/progress.sh moves while a command takes its time."""

from __future__ import annotations

import contextlib
import os
import pty
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.timeout(60)
REPO = Path(__file__).resolve().parents[2]
# Seconds pass when the test says so; the command ends when the test says so.
SCRIPT = """
. '{repo}/scripts/lib/progress.sh'
sleep() {{ read -r _ <&3; }}
progress "compiling" 95 bash -c 'echo "[3/7] a.cpp"; echo >&4; read -r status; exit "$status"'
"""


class Script:
    """A script that shows progress, with the clock and the end of its command in our hands."""

    def __init__(self, stderr: int, clock: Path) -> None:
        os.mkfifo(clock)
        self._folder = clock.parent
        self._printed, printed = os.pipe()
        # By both ends, so that neither open waits.
        self._clock = os.open(clock, os.O_RDWR)
        with clock.open("rb+", buffering=0) as fd:
            self.process = subprocess.Popen(
                ["bash", "-c", f"exec 3<&{fd.fileno()} 4>&{printed}\n{SCRIPT.format(repo=REPO)}"],
                stdin=subprocess.PIPE,
                stdout=subprocess.DEVNULL,
                stderr=stderr,
                pass_fds=[fd.fileno(), printed],
                env={**os.environ, "TMPDIR": str(clock.parent)},
                text=True,
                process_group=0,
            )
        os.close(printed)

    def wait_for_output(self) -> None:
        """The command has printed into its log. The time limit of the test ends this."""
        assert os.read(self._printed, 1) == b"\n"

    def files(self) -> set[str]:
        return {path.name for path in self._folder.iterdir()}

    def let_seconds_pass(self, count: int) -> None:
        os.write(self._clock, b"\n" * count)

    def end_command(self, status: int) -> int:
        self.process.communicate(f"{status}\n", timeout=60)
        return self.process.returncode

    def close(self) -> None:
        os.close(self._clock)
        os.close(self._printed)
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.communicate()


@contextlib.contextmanager
def script(stderr: int, folder: Path) -> Iterator[Script]:
    running = Script(stderr, folder / "clock")
    try:
        yield running
    finally:
        running.close()


def read_until(fd: int, text: str) -> str:
    """Output up to that text. Without it, the time limit of the test ends this."""
    got = ""
    while text not in got:
        got += os.read(fd, 4096).decode()
    return got


@pytest.fixture
def terminal() -> Iterator[tuple[int, int]]:
    ends = pty.openpty()
    yield ends
    for fd in ends:
        os.close(fd)


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    ends = os.pipe()
    yield ends
    for fd in ends:
        with contextlib.suppress(OSError):
            os.close(fd)


def test_on_a_terminal_the_line_moves_and_goes(terminal: tuple[int, int], tmp_path: Path) -> None:
    ours, theirs = terminal
    with script(theirs, tmp_path) as running:
        running.wait_for_output()
        for second in ("0:01", "0:02"):
            running.let_seconds_pass(1)
            line = f"\rcompiling: {second} of about 1:35, file 3 of 7\x1b[K"
            assert read_until(ours, "\x1b[K") == line
        assert running.end_command(0) == 0
        assert read_until(ours, "\x1b[K") == "\r\x1b[K", "nothing of it is left"


def test_no_file_is_left_however_it_ends(pipe: tuple[int, int], tmp_path: Path) -> None:
    _, theirs = pipe
    with script(theirs, tmp_path) as running:
        running.wait_for_output()
        os.killpg(running.process.pid, signal.SIGKILL)
        running.process.wait()
        assert running.files() == {"clock"}


def test_without_a_terminal_it_is_said_once(pipe: tuple[int, int], tmp_path: Path) -> None:
    ours, theirs = pipe
    with script(theirs, tmp_path) as running:
        running.let_seconds_pass(1)
        said = read_until(ours, "\n")
        running.let_seconds_pass(3)
        assert running.end_command(0) == 0
        os.close(theirs)
        assert said + os.read(ours, 4096).decode() == "compiling (about 1:35 on 2 cores)\n"


def test_a_command_that_fails_shows_its_output(pipe: tuple[int, int], tmp_path: Path) -> None:
    ours, theirs = pipe
    with script(theirs, tmp_path) as running:
        assert running.end_command(7) == 7
        os.close(theirs)
        assert os.read(ours, 4096).decode() == "[3/7] a.cpp\n", "done at once: no line"
