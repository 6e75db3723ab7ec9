"""Faults and changes of state as they happen, `<robot>.v1.event`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from rc10.lcm_types.event_t import event_t
from rc10.printable import printable
from rc10.words import Word


class Severity(Word):
    """Severity of an event."""

    INFO = event_t.SEVERITY_INFO
    WARNING = event_t.SEVERITY_WARNING
    ERROR = event_t.SEVERITY_ERROR


class EventListener(Protocol):
    """Is told of events, while the program receives."""

    def on_event(self, event: Event) -> None:
        """Called with each, oldest first."""


@dataclass(frozen=True)
class Event:
    """One fault or change of state."""

    utime: int
    """Wall clock in microseconds since 1970."""
    mono_us: int
    """CLOCK_MONOTONIC of the tick in which it happened, in microseconds."""
    severity: Severity
    code: int
    source: str
    """Name of a motor or bus, or "robot", "link", "lcm"."""
    client: str
    """The client or module whose request or command it was, empty without one."""
    text: str

    def __str__(self) -> str:
        """Returns it in a line, as the log has it: `WARNING lift: no valid command any more`."""
        return printable(f"{self.severity} {self.source}: {self.text}")

    @classmethod
    def from_lcm(cls, message: event_t) -> Event:
        """Makes the typed view of a decoded message."""
        return cls(
            utime=message.utime,
            mono_us=message.mono_us,
            severity=Severity(message.severity),
            code=message.code,
            source=message.source,
            client=message.client,
            text=message.text,
        )
