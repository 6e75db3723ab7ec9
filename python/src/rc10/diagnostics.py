"""Lateness and load of the daemon, `<robot>.v1.diagnostics`."""

from __future__ import annotations

from dataclasses import dataclass, fields
from types import MappingProxyType
from typing import TYPE_CHECKING

from rc10.lcm_types.bus_state_t import bus_state_t
from rc10.words import Word

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rc10.lcm_types.diagnostics_t import diagnostics_t


class BusStatus(Word):
    """State of one bus."""

    ACTIVE = bus_state_t.STATE_ACTIVE
    WARNING = bus_state_t.STATE_WARNING
    PASSIVE = bus_state_t.STATE_PASSIVE
    BUS_OFF = bus_state_t.STATE_BUS_OFF
    DOWN = bus_state_t.STATE_DOWN
    GONE = bus_state_t.STATE_GONE
    SILENT = bus_state_t.STATE_SILENT
    STALLED = bus_state_t.STATE_STALLED


@dataclass(frozen=True)
class BusState:
    """One bus. Loads are from 0 to 1; counters count from start and never go back."""

    name: str
    interface_name: str
    status: BusStatus
    predicted_load: float
    """Unstuffed frames, from the configuration."""
    predicted_load_worst: float
    """The same with the worst bit stuffing."""
    measured_load: float
    """Unstuffed, from the frames of the last second."""
    rx_frames: int
    rx_unmatched: int
    rx_malformed: int
    rx_foreign: int
    """Frames with a command id of the robot that rc10d did not send."""
    rx_dropped: int
    tx_frames: int
    tx_confirmed: int
    tx_dropped: int
    tx_held: int
    """Not sent, since the bus was not able to carry them."""
    error_frames: int
    restarts: int
    tec: int
    """Transmit error counter, -1: unknown."""
    rec: int
    """Receive error counter, -1: unknown."""

    @classmethod
    def from_lcm(cls, message: bus_state_t) -> BusState:
        """Makes the typed view of a decoded message."""
        same = {f.name: getattr(message, f.name) for f in fields(cls) if f.name != "status"}
        return cls(status=BusStatus(message.state), **same)


@dataclass(frozen=True)
class Durations:
    """Distribution of one kind of duration, over the whole run."""

    count: int
    p50_us: float
    p99_us: float
    p999_us: float
    max_us: float


@dataclass(frozen=True)
class Diagnostics:
    """The daemon's own health, over its whole run."""

    utime: int
    """Wall clock in microseconds since 1970."""
    mono_us: int
    """CLOCK_MONOTONIC in microseconds."""
    tick: int
    tick_period_us: int
    wake_latency_p50_us: float
    """From the planned to the actual start of a tick."""
    wake_latency_p99_us: float
    wake_latency_p999_us: float
    wake_latency_max_us: float
    tick_duration_p50_us: float
    tick_duration_p99_us: float
    tick_duration_p999_us: float
    tick_duration_max_us: float
    missed_ticks: int
    page_faults: int
    events_dropped: int
    refusals: Mapping[str, int]
    """Command messages and setpoints refused, by reason."""
    counters: Mapping[str, int]
    """Everything else that is counted."""
    durations: Mapping[str, Durations]
    """Ages and latencies."""
    notices: tuple[str, ...]
    """Defects in words, each with its remedy."""
    buses: Mapping[str, BusState]

    @classmethod
    def from_lcm(cls, message: diagnostics_t) -> Diagnostics:
        """Makes the typed view of a decoded message."""
        converted = ("refusals", "counters", "durations", "notices", "buses")
        same = {f.name: getattr(message, f.name) for f in fields(cls) if f.name not in converted}
        return cls(
            refusals=MappingProxyType({c.name: c.count for c in message.refusals}),
            counters=MappingProxyType({c.name: c.count for c in message.counters}),
            durations=MappingProxyType(
                {
                    d.name: Durations(d.count, d.p50_us, d.p99_us, d.p999_us, d.max_us)
                    for d in message.durations
                }
            ),
            notices=tuple(message.notices),
            buses=MappingProxyType({b.name: BusState.from_lcm(b) for b in message.buses}),
            **same,
        )
