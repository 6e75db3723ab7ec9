"""rc10ctl watch on a terminal: nothing wraps, nothing scrolls, however small it is."""

from __future__ import annotations

import contextlib
import fcntl
import os
import pty
import re
import struct
import subprocess
import termios
import threading
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon, eventually
from hostlib.daemon import ARM, BIN

if TYPE_CHECKING:
    from collections.abc import Iterator

MOTORS = 30
CLEARED = "\x1b[2J"
HOME = "\x1b[H"
COLOUR = re.compile(r"\x1b\[[0-9;]*m")


class Terminal:
    """rc10ctl watch on a terminal of its own, and the pictures that it has drawn there."""

    def __init__(self, daemon: Daemon, rows: int, columns: int, *words: str) -> None:
        self._keyboard, screen = pty.openpty()
        self._screen = screen
        self.resize(rows, columns)
        self.process = subprocess.Popen(
            [BIN / "rc10ctl", "watch", *words],
            stdin=screen,
            stdout=screen,
            env={**os.environ, **daemon.env, "LC_ALL": "C.UTF-8", "TERM": "xterm"},
        )
        self._drawn = b""
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()

    def __enter__(self) -> Terminal:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()
        os.close(self._screen)
        self._reader.join(20)
        os.close(self._keyboard)

    def resize(self, rows: int, columns: int) -> None:
        fcntl.ioctl(self._screen, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def text(self) -> str:
        return self._drawn.decode(errors="ignore")

    def picture(self, after: int = 0) -> list[str]:
        """The lines of the first whole picture after so many, without what has no width."""

        def whole() -> list[str]:
            return self.text().split(HOME)[1:-1][after:]

        drawn = eventually(whole, "a picture")[0]
        assert drawn.count("\x1b[K") == drawn.count("\n")
        plain = COLOUR.sub("", drawn.replace("\x1b[K", "").replace(CLEARED, ""))
        return plain.removesuffix("\x1b[J").splitlines()

    def _read(self) -> None:
        with contextlib.suppress(OSError):  # a terminal without a reader
            while part := os.read(self._keyboard, 4096):
                self._drawn += part


@pytest.fixture
def many() -> Iterator[Daemon]:
    motors = "".join(
        f"      - {{name: motor_{i}, model: RS00, id: {i}, command_divider: 20,"
        f" feedback_timeout_ms: 1000}}\n"
        for i in range(1, MOTORS + 1)
    )
    with Daemon(ARM + motors) as daemon:
        daemon.wait_ready()
        yield daemon


def names(picture: list[str]) -> list[str]:
    return re.findall(r"^(motor_\d+) ", "\n".join(picture), re.MULTILINE)


def test_on_a_small_terminal_what_does_not_fit_is_left_out_and_told(many: Daemon) -> None:
    with Terminal(many, 24, 80, "--spark", "motor_1.velocity", "--hz", "20") as terminal:
        picture = terminal.picture(after=3)
    assert len(picture) == 23
    assert max(map(len, picture)) == 79
    shown = names(picture)
    told = f"{MOTORS - len(shown)} of {MOTORS} motors are not shown: the terminal has too few rows"
    assert picture[-2] == told
    assert re.match(r"motor_1\.velocity_rpm  [▁-█]{4}  ", picture[-1])


def test_on_a_large_terminal_it_looks_as_in_a_file(many: Daemon) -> None:
    plain = many.must("watch", "--once").splitlines()
    with Terminal(many, 60, 200, "--once") as terminal:
        assert terminal.process.wait(20) == 0
        eventually(lambda: terminal.text().endswith("\x1b[J"), "all it drew")
        drawn = terminal.text().replace("\x1b[K", "").replace("\r", "")
    lines = COLOUR.sub("", drawn.split(HOME)[1].removesuffix("\x1b[J")).splitlines()
    assert len(lines) == len(plain)
    assert names(lines) == names(plain) == [f"motor_{i}" for i in range(1, MOTORS + 1)]


def test_a_terminal_that_is_resized_is_drawn_anew_at_once(many: Daemon) -> None:
    # The next picture would come in ten seconds.
    with Terminal(many, 24, 80, "--hz", "0.1") as terminal:
        eventually(lambda: "are not shown" in terminal.text(), "the first picture")
        terminal.resize(60, 200)
        eventually(lambda: terminal.text().count(CLEARED) == 2, "the screen is cleared")
        eventually(lambda: f"motor_{MOTORS}" in terminal.text(), "every motor is shown")
        assert terminal.text().count(HOME) == 2
