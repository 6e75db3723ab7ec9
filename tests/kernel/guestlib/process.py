"""Processes with a captured output, and waiting with a limit."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import threading
import time
from typing import TYPE_CHECKING, Self, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from pathlib import Path
    from types import TracebackType

T = TypeVar("T")


def wait_for(
    predicate: Callable[[], T | None], timeout_s: float, what: str = "", poll_s: float = 0.001
) -> T:
    """Return the predicate's first true value; raise TimeoutError when it stays false.

    Each look takes real time: give a long wait a longer poll_s.
    """
    deadline = time.monotonic() + timeout_s
    while not (value := predicate()):
        if time.monotonic() >= deadline:
            raise TimeoutError(f"{what or 'the condition'} did not come true in {timeout_s} s")
        time.sleep(poll_s)
    return value


def run(*command: str | Path) -> str:
    """Run a short command and return its output; a failure shows what it printed."""
    done = subprocess.run(
        [str(word) for word in command],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        words = " ".join(str(word) for word in command)
        raise RuntimeError(f"'{words}' returned {done.returncode}:\n{done.stdout}")
    return done.stdout


class Proc:
    """A background process whose output, errors included, is kept line by line.

    >>> with Proc("rc10d", "--config", path) as daemon:
    ...     daemon.wait_line("ready")
    """

    def __init__(
        self,
        *command: str | Path,
        env: Mapping[str, str] | None = None,
        cwd: Path | None = None,
    ) -> None:
        self._command = [str(word) for word in command]
        self._env = {**os.environ, **(env or {})}
        self._cwd = cwd
        self._process: subprocess.Popen[str] | None = None
        self._reader: threading.Thread | None = None
        self._lines: list[str] = []
        self._next = 0
        self._ended = False
        self._news = threading.Condition()

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.stop()
        if error is not None:
            # pytest shows this for a failed test only.
            print(f"--- {' '.join(self._command)}\n{self.output()}")

    def start(self) -> None:
        self._process = subprocess.Popen(
            self._command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            env=self._env,
            cwd=self._cwd,
        )
        # Always reading: a process never blocks on a test that does not look at its output.
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def stop(self, sig: int = signal.SIGTERM, timeout_s: float = 5.0) -> int:
        """Ask the process to end, kill it if it does not, and return its status."""
        if self.alive():
            self.signal(sig)
        try:
            return self.wait(timeout_s)
        except subprocess.TimeoutExpired:
            self.signal(signal.SIGKILL)
            return self.wait(timeout_s)

    def signal(self, sig: int) -> None:
        self._started().send_signal(sig)

    def wait(self, timeout_s: float) -> int:
        """Return the exit status; all output has been read by then."""
        status = self._started().wait(timeout_s)
        if self._reader is not None:
            # A child that kept the output open must not hold the test up.
            self._reader.join(1.0)
        return status

    def alive(self) -> bool:
        return self._process is not None and self._process.poll() is None

    @property
    def pid(self) -> int:
        return self._started().pid

    def output(self) -> str:
        with self._news:
            return "".join(self._lines)

    def wait_line(self, pattern: str, timeout_s: float = 5.0) -> re.Match[str]:
        """Return the match of the next line that has the pattern.

        "Next" counts from the line the last call returned, so a test reads events in order.
        """
        return self.wait_lines(pattern, timeout_s=timeout_s)[0]

    def wait_lines(self, *patterns: str, timeout_s: float) -> list[re.Match[str]]:
        """Return the matches of the next line for each pattern, in whatever order they come.

        Threads that write of one event do not wait for each other.
        """
        found: dict[str, re.Match[str]] = {}
        deadline = time.monotonic() + timeout_s
        with self._news:
            while True:
                while self._next < len(self._lines):
                    line = self._lines[self._next]
                    self._next += 1
                    for pattern in patterns:
                        if pattern not in found and (match := re.search(pattern, line)):
                            found[pattern] = match
                    if len(found) == len(set(patterns)):
                        return [found[pattern] for pattern in patterns]
                if self._ended or not self._news.wait(deadline - time.monotonic()):
                    break
            why = "ended without" if self._ended else f"wrote in {timeout_s} s no"
            text = "".join(self._lines)
        missing = next(pattern for pattern in patterns if pattern not in found)
        raise TimeoutError(f"{self._command[0]} {why} line '{missing}':\n{text}")

    def _read(self) -> None:
        stream = self._started().stdout
        assert stream is not None
        for line in stream:
            with self._news:
                self._lines.append(line)
                self._news.notify_all()
        with self._news:
            self._ended = True
            self._news.notify_all()

    def _started(self) -> subprocess.Popen[str]:
        if self._process is None:
            raise RuntimeError(f"{self._command[0]} was never started")
        return self._process
