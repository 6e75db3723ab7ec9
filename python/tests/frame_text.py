"""Frames as candump writes them, for the tests of drives that are asked on standard ids."""

from __future__ import annotations

from typing import Protocol

import can


class Answering(Protocol):
    """A fake drive that speaks when spoken to."""

    def decode_command(self, message: can.Message) -> bool: ...
    def frames(self) -> list[can.Message]: ...


def frame(text: str) -> can.Message:
    can_id, data = text.split("#")
    return can.Message(
        arbitration_id=int(can_id, 16), is_extended_id=False, data=bytes.fromhex(data)
    )


def text_of(message: can.Message) -> str:
    return f"{message.arbitration_id:03X}#{bytes(message.data).hex().upper()}"


def say(drive: Answering, text: str) -> list[str]:
    """Returns what it answers."""
    drive.decode_command(frame(text))
    return [text_of(message) for message in drive.frames()]
