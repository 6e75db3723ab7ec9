"""Turns received bytes into messages, and remembers what it could not read."""

from __future__ import annotations

import logging
import struct
from typing import Any, Callable, TypeVar

_log = logging.getLogger("rc10")
_T = TypeVar("_T")


class Decoder:
    """Decodes without raising: what others publish must not end the caller's program.

    Attributes:
        foreign: the channels on which messages with other definitions arrived.
    """

    def __init__(self) -> None:
        self.foreign: set[str] = set()

    def decode(
        self,
        channel: str,
        read: Callable[[bytes], Any],
        convert: Callable[[Any], _T],
        data: bytes,
    ) -> _T | None:
        """Returns what `convert` makes of what `read` reads, None if `data` is something else."""
        try:
            return convert(read(data))
        except (ValueError, struct.error):
            if channel not in self.foreign:
                self.foreign.add(channel)
                _log.warning(
                    "%s carries messages with other definitions than this package's", channel
                )
            return None
