"""Identity of a run of a program."""

from __future__ import annotations

import secrets
import sys
import time
from pathlib import Path
from typing import Protocol

# Size limit of a name on the daemon's side; the daemon would refuse what a longer one says.
MAX_CLIENT_BYTES = 31


def shortened(client: str) -> str:
    """Returns as much of a name as a client may have."""
    return client.encode()[:MAX_CLIENT_BYTES].decode(errors="ignore")


def client_name(client: str | None) -> str:
    """Returns `client`, or the program's name, as much of it as a client may have."""
    return client or shortened(Path(sys.argv[0]).stem) or "python"


class Signed(Protocol):
    """A message with a sender."""

    utime: int
    client: str
    session: int
    seq: int


class Identity:
    """A client's name, the random session of this run, and its growing sequence number.

    Commands and requests share the number; that it grows is all that the daemon asks of it.
    """

    def __init__(self, client: str) -> None:
        if not client:
            raise ValueError("the client needs a name")
        if len(client.encode()) > MAX_CLIENT_BYTES:
            raise ValueError(
                f"the client's name {client!r} is longer than {MAX_CLIENT_BYTES} bytes: shorten it"
            )
        self.client = client
        # From 1: zero is what a program that forgets about sessions sends.
        self.session = secrets.randbelow(2**63 - 1) + 1
        self._seq = 0

    def next_seq(self) -> int:
        """Returns a number greater than all before."""
        self._seq += 1
        return self._seq

    def sign(self, message: Signed) -> None:
        """Writes the present time, and who says it, into a message."""
        message.utime = time.time_ns() // 1000
        message.client = self.client
        message.session = self.session
        message.seq = self.next_seq()
