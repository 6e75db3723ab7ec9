"""Messages of any LCM type on any channel: publish and subscribe."""

from __future__ import annotations

import struct
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Callable, Generic, TypeVar

if TYPE_CHECKING:
    from rc10.link import Link

T = TypeVar("T")

_QUEUE = 100


class Publisher(Generic[T]):
    """Sends messages of one LCM type on one channel.

    Args:
        link: Robot.link, or an LcmLink of your own.
        channel: any name that LCM allows, 63 characters at most.
        kind: the class that lcm-gen made.
    """

    def __init__(self, link: Link, channel: str, kind: type[T]) -> None:
        if not 0 < len(channel.encode()) <= 63:
            raise ValueError(f"{channel!r} is no channel: LCM allows 1 to 63 characters")
        self.channel = channel
        self._link = link
        self._kind = kind

    def publish(self, message: T) -> None:
        """Sends a message without waiting for anybody.

        Raises:
            TypeError: it is of another type; nothing was sent.
        """
        if not isinstance(message, self._kind):
            raise TypeError(f"{self.channel} carries {self._kind.__name__}, not {message!r}")
        encoded: Any = message
        self._link.publish(self.channel, encoded.encode())


@dataclass(frozen=True)
class Received(Generic[T]):
    """A message and when it was received.

    It may have waited before: where that matters, put the time of the measurement into it.
    """

    message: T
    received_s: float
    """On this program's clock."""
    _now: Callable[[], float] = field(repr=False, compare=False)

    @property
    def age_s(self) -> float:
        """Seconds since it was received."""
        return self._now() - self.received_s


class Subscriber(Generic[T]):
    """Receives messages of one LCM type on one channel, until the link is closed.

    Like everything in this package it belongs to one thread: messages are received while spin(),
    rate() or a request of the Robot waits, or in pump() of a link of your own.

    Args:
        link: Robot.link, or an LcmLink of your own.
        channel: the name, taken literally.
        kind: the class that lcm-gen made.
        callback: called with every message.
    """

    def __init__(
        self,
        link: Link,
        channel: str,
        kind: type[T],
        callback: Callable[[T], None] | None = None,
    ) -> None:
        self.channel = channel
        self.count = 0
        """Messages received."""
        self.foreign = 0
        """Messages of another type, or of other definitions of it, on this channel."""
        self._link = link
        self._kind: Any = kind
        self._callback = callback
        self._latest: Received[T] | None = None
        link.subscribe(channel, self._on_message, _QUEUE)

    @property
    def latest(self) -> Received[T] | None:
        """The newest message with its age, None before the first."""
        return self._latest

    def _on_message(self, data: bytes) -> None:
        try:
            message: T = self._kind.decode(data)
        except (ValueError, struct.error):
            self.foreign += 1
            return
        self.count += 1
        self._latest = Received(message, self._link.now(), self._link.now)
        if self._callback is not None:
            self._callback(message)
