"""The way to the daemon: LCM, pumped by hand."""

from __future__ import annotations

import math
import os
import re
import select
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING, Callable, Protocol

import lcm

from rc10.errors import LinkError
from rc10.own_datagrams import OwnDatagrams, descriptors

if TYPE_CHECKING:
    from collections.abc import Iterator
    from contextlib import AbstractContextManager

MULTICAST_GROUP = "239.255.76.67"
ROUTE_COMMAND = f"sudo ip route add {MULTICAST_GROUP}/32 dev lo src 127.0.0.1"

# A pump ends although more is waiting: a flooded channel must not hold the caller's loop.
_MAX_PER_PUMP = 4096

# A signal that comes just before a sleep, or to LCM's thread, does not end it; Ctrl-C has to.
_LONGEST_SLEEP_S = 0.2
# LCM's thread has handed over by then what came while the program was stopped.
_HANDOVER_S = 0.01
_STATE = ".v1.state"


class Link(Protocol):
    """Transport of a client. Not thread-safe."""

    def publish(self, channel: str, data: bytes) -> None:
        """Sends a message, without waiting."""

    def subscribe(self, channel: str, handler: Callable[[bytes], None], capacity: int) -> None:
        """Has pump() call `handler`; at most about `capacity` messages wait for it."""

    def pump(self, timeout_s: float) -> int:
        """Waits at most `timeout_s` for a message, then handles all that wait.

        Returns:
            How many were handled.
        """

    def between(self, before: str, after: str) -> AbstractContextManager[set[str]]:
        """Collects the middles of the channels of this form that come while it is pumped."""

    def fileno(self) -> int:
        """A descriptor that is readable while a message waits."""

    def now(self) -> float:
        """Monotonic time in seconds."""

    def empty_s(self) -> float:
        """When no message waited last: what is handled now came after that."""

    def close(self) -> None:
        """Frees the transport."""


class LcmLink:
    """A Link over LCM.

    Args:
        url: an LCM provider; None for $LCM_DEFAULT_URL or LCM's default.

    Raises:
        LinkError: LCM could not start; the message says what to do.
    """

    def __init__(self, url: str | None = None) -> None:
        before = descriptors()
        try:
            self._lcm: lcm.LCM | None = lcm.LCM(url)
            self._lcm.fileno()  # opens what receives
        except (RuntimeError, OSError) as error:
            raise LinkError(_start_failure(url)) from error
        self._own = OwnDatagrams(_effective(url), descriptors() - before)
        self._empty_s = self._looked_s = -math.inf

    @property
    def lcm(self) -> lcm.LCM:
        """The LCM object itself, for messages of the caller's own."""
        if self._lcm is None:
            raise LinkError("the link is closed")
        return self._lcm

    def publish(self, channel: str, data: bytes) -> None:
        """Sends a message, without waiting."""
        self.lcm.publish(channel, data)

    def subscribe(self, channel: str, handler: Callable[[bytes], None], capacity: int) -> None:
        """Has pump() call `handler`; at most about `capacity` messages wait for it."""
        if channel.endswith(_STATE):
            self._own.watch(channel[: -len(_STATE)])
        # LCM takes a regular expression, and the dots of a channel name would match anything.
        subscription = self.lcm.subscribe(re.escape(channel), lambda _, data: handler(data))
        subscription.set_queue_capacity(capacity)

    def pump(self, timeout_s: float) -> int:
        """Waits at most `timeout_s` for a message, then handles all that wait."""
        handled = 0
        self._own.look()
        ready = self._message_waits() or self._wait(max(0.0, timeout_s))
        while ready and handled < _MAX_PER_PUMP:
            self._own.look()  # first, so that nothing of others comes after it
            self.lcm.handle()
            handled += 1
            ready = self._message_waits()
        return handled

    @contextmanager
    def between(self, before: str, after: str) -> Iterator[set[str]]:
        """Collects the middles of the channels of this form that come while it is pumped."""
        heard: set[str] = set()
        subscription = self.lcm.subscribe(
            f"{re.escape(before)}.+{re.escape(after)}",
            lambda channel, _: heard.add(channel[len(before) : -len(after)]),
        )
        try:
            yield heard
        finally:
            if self._lcm is not None:
                self._lcm.unsubscribe(subscription)

    def fileno(self) -> int:
        """A descriptor that is readable while a message waits."""
        return self.lcm.fileno()

    def now(self) -> float:
        """Monotonic time in seconds."""
        return time.monotonic()

    def empty_s(self) -> float:
        """When no message waited last; -inf before the first pump()."""
        return self._empty_s

    def close(self) -> None:
        """Frees the sockets and ends LCM's receiving thread."""
        self._own.close()
        self._lcm = None

    def _message_waits(self) -> bool:
        """Whether a message waits already."""
        now_s = self.now()  # before looking: what comes meanwhile is younger
        # After a stop of the program (Ctrl-Z) LCM's thread needs a moment to hand over what came.
        stood = now_s - self._looked_s > 2 * _LONGEST_SLEEP_S
        ready = self._readable(_HANDOVER_S if stood else 0.0)
        self._looked_s = self.now()
        if not ready:
            self._empty_s = now_s
        return ready

    def _wait(self, timeout_s: float) -> bool:
        """Waits until a message comes."""
        end_s = self.now() + timeout_s
        while True:
            began_s = self.now()
            ready = self._sleep(min(timeout_s, _LONGEST_SLEEP_S))
            now_s = self.now()
            # Not after a stop of the program in its sleep (Ctrl-Z): it may have come at any time.
            if now_s - began_s < 2 * _LONGEST_SLEEP_S:
                self._empty_s = now_s
            timeout_s = end_s - now_s
            if ready or timeout_s <= 0.0:
                return ready

    def _sleep(self, timeout_s: float) -> bool:
        return self._readable(timeout_s)

    def _readable(self, timeout_s: float) -> bool:
        # Not LCM's own handle_timeout: a signal makes that fail with an IOError, and a Ctrl-C
        # would not arrive as KeyboardInterrupt. It also counts in whole milliseconds.
        return bool(select.select([self.fileno()], [], [], timeout_s)[0])


def _effective(url: str | None) -> str:
    return url or os.environ.get("LCM_DEFAULT_URL") or ""


def _start_failure(url: str | None) -> str:
    effective = _effective(url)
    if effective and not effective.startswith("udpm://"):
        return f"LCM could not start with '{effective}'"
    return (
        f"LCM could not start{f' with {effective!r}' if effective else ''}. Usually there is no "
        f"route for its multicast. Run: {ROUTE_COMMAND} (and only if that is not enough: "
        "sudo ip link set lo multicast on)"
    )
