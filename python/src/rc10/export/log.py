"""Contents of a log file of lcm-logger."""

from __future__ import annotations

import math
import re
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import lcm

from rc10 import lcm_types
from rc10.errors import Rc10Error

if TYPE_CHECKING:
    import os
    from collections.abc import Iterator

# A log of lcm begins each of its events with this.
_SYNC_WORD = bytes.fromhex("eda1da01")

_TYPES: dict[bytes, Any] = {
    kind().encode()[:8]: kind
    for name, kind in vars(lcm_types).items()
    if name.endswith("_t") and isinstance(kind, type)
}

_CHANNEL = re.compile(r"(?P<robot>[\w.-]+?)\.v1\.(?P<rest>[\w.-]+)")


@dataclass(frozen=True)
class Logged:
    """One message of a log."""

    utime: int
    """When lcm-logger received it, in microseconds since 1970."""
    channel: str
    robot: str
    """The robot whose channel it is; empty: of something else."""
    name: str
    """The channel without the robot: "state", "command", "base.state"."""
    message: Any
    """Decoded: an object of rc10.lcm_types."""


class LogReader:
    """Reads a log file, and counts what it cannot decode.

    Attributes:
        foreign: messages of other types than rc10's, by channel.

    Raises:
        Rc10Error: it is no such file.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = path
        self.foreign: dict[str, int] = {}
        try:
            with open(path, "rb") as file:
                begin = file.read(len(_SYNC_WORD))
        except OSError as error:
            raise Rc10Error(f"{path}: {error.strerror}") from None
        if begin != _SYNC_WORD:
            raise Rc10Error(f"{path} is no log of lcm-logger" + ("" if begin else ": it is empty"))

    def __iter__(self) -> Iterator[Logged]:
        log = lcm.EventLog(self.path, "r")
        try:
            for event in log:
                message = self._decode(event.channel, event.data)
                if message is not None:
                    match = _CHANNEL.fullmatch(event.channel)
                    robot, name = match.group("robot", "rest") if match else ("", event.channel)
                    yield Logged(event.timestamp, event.channel, robot, name, message)
        finally:
            log.close()

    def _decode(self, channel: str, data: bytes) -> Any | None:
        kind = _TYPES.get(data[:8])
        if kind is not None:
            try:
                return kind.decode(data)
            except (ValueError, struct.error):
                pass
        self.foreign[channel] = self.foreign.get(channel, 0) + 1
        return None


def plain(message: Any) -> Any:
    """Returns a message as what JSON has; NaN and infinity, which it has not, become null."""
    if isinstance(message, float):
        return message if math.isfinite(message) else None
    if isinstance(message, (list, tuple)):
        return [plain(part) for part in message]
    if isinstance(message, bytes):
        return message.hex()
    if hasattr(message, "__slots__"):
        return {name: plain(getattr(message, name)) for name in message.__slots__}
    return message
