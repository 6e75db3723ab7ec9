"""Keeps the newest of what a robot publishes."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from rc10.diagnostics import Diagnostics
from rc10.events import Event
from rc10.host_clock import HostClock
from rc10.lcm_types.diagnostics_t import diagnostics_t
from rc10.lcm_types.event_t import event_t
from rc10.lcm_types.robot_state_t import robot_state_t
from rc10.state import RobotState

if TYPE_CHECKING:
    from typing import Callable

    from rc10.decoder import Decoder
    from rc10.link import Link

# Half a second of states at the default 200 Hz, and then as much patience for a live one.
STATE_QUEUE = 100
_WAIT_FOR_LIVE_S = 0.5

EVENTS_KEPT = 1000
_DIAGNOSTICS_QUEUE = 10

# A state that is older than the known one by less than this has been overtaken on its way; by
# more, and the daemon's host has started again.
_OVERTAKEN_US = 1_000_000


class Inbox:
    """Receives states, diagnostics and events; nothing happens outside pump().

    Attributes:
        state: the newest state, None before the first.
        diagnostics: the newest diagnostics, None before the first.
        events: those not taken yet, oldest first.
        on_event: called with each event.
        on_state: called with each state, also those that are not the newest of a pump any more.
    """

    def __init__(self, robot: str, link: Link, decoder: Decoder) -> None:
        self.state: RobotState | None = None
        self.diagnostics: Diagnostics | None = None
        self.events: deque[Event] = deque(maxlen=EVENTS_KEPT)
        self.on_event: Callable[[Event], None] | None = None
        self._link = link
        self._decoder = decoder
        self._host_clock = HostClock()
        self.on_state: list[Callable[[RobotState], None]] = []
        self._waiting: list[bytes] = []
        self._states_seen = 0
        self._last = True
        self._channel = f"{robot}.v1."
        link.subscribe(self._channel + "state", self._on_state, STATE_QUEUE)
        link.subscribe(self._channel + "diagnostics", self._on_diagnostics, _DIAGNOSTICS_QUEUE)
        link.subscribe(self._channel + "event", self._on_event, EVENTS_KEPT)

    def pump(self, timeout_s: float) -> int:
        """Waits at most `timeout_s` for a message, takes all that wait, returns their number."""
        self._states_seen = 0
        count = self._link.pump(timeout_s)
        if self._states_seen >= STATE_QUEUE:
            # LCM's queue filled up while the caller was away, and a full queue drops
            # the newest. All that was in it is old: a live one is worth a short wait.
            self._states_seen = 0
            deadline_s = self._link.now() + _WAIT_FOR_LIVE_S
            while not self._states_seen and (left_s := deadline_s - self._link.now()) > 0:
                count += self._link.pump(left_s)
        self._take_waiting()
        return count

    def poll(self) -> int:
        """Takes all that wait, without waiting itself; returns their number."""
        self._states_seen = 0
        count = self._link.pump(0.0)
        self._take_waiting()
        return count

    def hear(self) -> None:
        """Takes the events that wait; states are left for the next pump, and nobody is called."""
        self._states_seen = 0
        self._link.pump(0.0)

    def _on_state(self, data: bytes) -> None:
        if not self.on_state:
            # Only the last one of a pump is worth decoding.
            self._waiting.clear()
        self._waiting.append(data)
        self._states_seen += 1

    def _take_waiting(self) -> None:
        waiting, self._waiting = self._waiting, []
        # A full queue has dropped the newest: all that is left of it is late.
        full = self._states_seen >= STATE_QUEUE
        for number, data in enumerate(waiting, 1):
            self._last = number == len(waiting) and not full
            self._take(data)

    def _take(self, data: bytes) -> None:
        state = self._decoder.decode(
            self._channel + "state", robot_state_t.decode, self._place_in_time, data
        )
        if state is None:
            return
        if self.state and 0 < self.state.mono_us - state.mono_us < _OVERTAKEN_US:
            return
        self.state = state
        for listener in tuple(self.on_state):
            listener(state)

    def _place_in_time(self, message: robot_state_t) -> RobotState:
        taken_at_s = self._host_clock.observe(
            message.mono_us * 1e-6, self._link.now(), last=self._last
        )
        return RobotState.from_lcm(message, taken_at_s, self._link.now)

    def _on_diagnostics(self, data: bytes) -> None:
        received = self._decoder.decode(
            self._channel + "diagnostics", diagnostics_t.decode, Diagnostics.from_lcm, data
        )
        self.diagnostics = received or self.diagnostics

    def _on_event(self, data: bytes) -> None:
        event = self._decoder.decode(self._channel + "event", event_t.decode, Event.from_lcm, data)
        if event is not None:
            self.events.append(event)
            if self.on_event is not None:
                self.on_event(event)
