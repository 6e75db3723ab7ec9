"""A program at a terminal of its own: what stands there, and what somebody types."""

from __future__ import annotations

import os
import pty
import select
import subprocess
import time
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

PATIENCE_S = 60.0


class Terminal:
    """Leaving the `with` statement ends the program."""

    def __init__(self, command: Sequence[str], env: Mapping[str, str] | None = None) -> None:
        self.text = ""
        self._seen = 0
        self._master, slave = pty.openpty()
        self._process = subprocess.Popen(
            command,
            stdin=slave,
            stdout=slave,
            stderr=slave,
            env={**os.environ, **(env or {})},
            start_new_session=True,
        )
        os.close(slave)

    def __enter__(self) -> Terminal:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.wait()
        os.close(self._master)

    def see(self, words: str) -> None:
        """Waits until they stand there, behind what was seen before."""
        deadline = time.monotonic() + PATIENCE_S
        while (at := self.text.find(words, self._seen)) < 0:
            assert self._read(deadline), f"without '{words}':\n{self.text}"
        self._seen = at + len(words)

    def answer(self, question: str, words: str) -> None:
        """Waits for the question, and types."""
        self.see(question)
        self.type(words)

    def type(self, words: str) -> None:
        os.write(self._master, f"{words}\n".encode())

    def end(self) -> int:
        """Reads to the end and returns the exit status."""
        deadline = time.monotonic() + PATIENCE_S
        while self._read(deadline):
            pass
        return self._process.wait(PATIENCE_S)

    def _read(self, deadline: float) -> bool:
        if not select.select([self._master], [], [], max(0.0, deadline - time.monotonic()))[0]:
            return False
        try:
            part = os.read(self._master, 65536)
        except OSError:  # nobody writes there any more
            return False
        self.text += part.decode(errors="replace").replace("\r\n", "\n")
        return bool(part)
