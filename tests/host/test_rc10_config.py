"""rc10-config without systemd: its stdin is the connection of one who asks."""

from __future__ import annotations

import socket
import subprocess

from hostlib.daemon import BIN
from hostlib.program import PATIENCE_S


def asked(message: bytes | None) -> tuple[str, str]:
    """Its answer and its line for the journal."""
    ours, its = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with ours, its:
        if message is not None:
            ours.send(message)
        done = subprocess.run(
            [BIN / "rc10-config"],
            stdin=its.fileno(),
            capture_output=True,
            text=True,
            timeout=PATIENCE_S,
            check=False,
        )
        return ours.recv(100_000).decode(), done.stderr


def test_one_who_asks_nothing_keeps_no_seat_and_stands_in_the_journal() -> None:
    answer, line = asked(None)
    assert answer == "refused\nnothing was asked within 2 s"
    assert "process" in line
    assert line.endswith(": refused: nothing was asked within 2 s\n")


def test_nonsense_is_refused_and_stands_in_the_journal() -> None:
    for message in (b"install", b"remove robot -\n", b"check ../robot -\n", b"x" * 140_000):
        answer, line = asked(message)
        assert answer.startswith("refused\nthe request is not one of rc10-config")
        assert ": refused: the request is not one of rc10-config" in line
