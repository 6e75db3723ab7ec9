"""A running program whose output can be waited for."""

from __future__ import annotations

import contextlib
import os
import re
import signal
import subprocess
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

T = TypeVar("T")

# Long enough for a busy machine; nothing waits this long when all is well.
PATIENCE_S = 20.0


def eventually(look: Callable[[], T], what: str, patience_s: float = PATIENCE_S) -> T:
    """Looks until the result is true and returns it; for what sends no message when it happens."""
    deadline = time.monotonic() + patience_s
    while True:
        seen = look()
        if seen:
            return seen
        assert time.monotonic() < deadline, f"not within {patience_s:g} s: {what}"
        time.sleep(0.01)


@contextlib.contextmanager
def full_pipe() -> Iterator[int]:
    """The end to write to of a pipe that nobody reads."""
    read, write = os.pipe()
    os.set_blocking(write, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(write, b"x" * 4096)
    os.set_blocking(write, True)
    try:
        yield write
    finally:
        os.close(read)
        os.close(write)


def processes_of(run_dir: Path) -> dict[int, list[str]]:
    """The command lines, by process id, of every process that has this RC10_RUN_DIR."""
    mark = f"RC10_RUN_DIR={run_dir}"
    found = {}
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if mark in process.joinpath("environ").read_text(errors="replace").split("\0"):
                words = process.joinpath("cmdline").read_text(errors="replace").split("\0")
                found[int(process.name)] = words[:-1]
        except OSError:
            continue  # ended, or another user's
    return found


class Program:
    """A process in a group of its own; leaving the `with` statement ends it."""

    def __init__(
        self, *command: str | Path, env: Mapping[str, str] | None = None, prefix: Sequence[str] = ()
    ) -> None:
        self.name = os.path.basename(command[0])
        self._lines: list[str] = []
        self._seen = 0
        self._new = threading.Condition()
        self._process = subprocess.Popen(
            [*prefix, *(str(word) for word in command)],
            env={**os.environ, **(env or {})},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            start_new_session=True,
        )
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def __enter__(self) -> Program:
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def running(self) -> bool:
        return self._process.poll() is None

    @property
    def output(self) -> str:
        with self._new:
            return "\n".join(self._lines)

    def signal(self, number: signal.Signals) -> None:
        """Sends it; after SIGSTOP, none of its threads runs on."""
        self._process.send_signal(number)
        if number == signal.SIGSTOP:
            os.waitid(os.P_PID, self.pid, os.WSTOPPED | os.WEXITED | os.WNOWAIT)

    @contextlib.contextmanager
    def stopped(self) -> Iterator[None]:
        """Stands still, as in a debugger, and goes on at the end."""
        self.signal(signal.SIGSTOP)
        try:
            yield
        finally:
            self.signal(signal.SIGCONT)

    def interrupt(self) -> None:
        """As Ctrl-C does: to every process of the group."""
        os.killpg(self.pid, signal.SIGINT)

    def wait(self, patience_s: float = PATIENCE_S) -> int:
        """Waits for its end and returns the exit status."""
        try:
            status = self._process.wait(patience_s)
        except subprocess.TimeoutExpired:
            raise AssertionError(
                f"{self.name} runs on after {patience_s:g} s:\n{self.output}"
            ) from None
        self._reader.join(PATIENCE_S)
        return status

    def wait_line(self, pattern: str, patience_s: float = PATIENCE_S) -> re.Match[str]:
        """Waits for a line, after those that an earlier call found, and returns the match."""
        deadline = time.monotonic() + patience_s
        expression = re.compile(pattern)
        with self._new:
            while True:
                while self._seen < len(self._lines):
                    self._seen += 1
                    if match := expression.search(self._lines[self._seen - 1]):
                        return match
                left = deadline - time.monotonic()
                ended = not self._reader.is_alive()
                if left <= 0 or ended:
                    how = "ended" if ended else "ran on"
                    output = "\n".join(self._lines)
                    raise AssertionError(f"{self.name} {how} without {pattern!r}:\n{output}")
                self._new.wait(min(left, 0.1))

    def stop(self) -> None:
        """Ends it and whatever it has started that is still in its group."""
        if self.running:
            self._process.terminate()
            try:
                self._process.wait(5.0)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()
        with contextlib.suppress(ProcessLookupError):
            os.killpg(self.pid, signal.SIGKILL)
        self._reader.join(PATIENCE_S)

    def _read(self) -> None:
        assert self._process.stdout is not None
        for line in self._process.stdout:
            with self._new:
                self._lines.append(line.rstrip("\n"))
                self._new.notify_all()
