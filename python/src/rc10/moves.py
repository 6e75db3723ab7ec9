"""Going to an angle, and knowing how it ended."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING, Callable

from rc10.orders import Order, hindered
from rc10.setpoints import Mode

if TYPE_CHECKING:
    from rc10.events import Event
    from rc10.setpoints import Setpoint
    from rc10.state import MotorState, RobotState

# For the target on its way to the motor, at the start and after it has lapsed.
_ON_ITS_WAY_S = 0.3
# Passing through the tolerance is not arriving.
_SETTLED_US = 60_000
# Silence of states after which rc10d or its gateway has ended, and what it is called.
SILENCE_S = 1.0
SILENT = "no state of the robot for a second: did rc10d or rc10-lcm end?"
_MOTOR_STATUS = 100
# "ACTIVE -> READY (disabled by 'panel')": it does not obey any more.
_LEFT_ACTIVE = re.compile(r"(ACTIVE|ENABLING) -> (?!ACTIVE)")
_TO_ENABLING = re.compile(r"\w+ -> ENABLING\b")


def leaves_active(event: Event) -> bool:
    """Whether its motor ceases to obey."""
    return event.code == _MOTOR_STATUS and _LEFT_ACTIVE.match(event.text) is not None


def is_enabled(event: Event) -> bool:
    """Whether its motor begins to be enabled: what was said before moves it no more."""
    return event.code == _MOTOR_STATUS and _TO_ENABLING.match(event.text) is not None


class MoveOutcome(Enum):
    """Outcome of a move."""

    DONE = "done"
    """It stands within the tolerance."""
    FAILED = "failed"
    """It cannot get there: the reason says why. The target is not sent any more."""
    TIMEOUT = "timeout"
    """It is not there yet. The target is still sent: give another, or coast()."""


@dataclass(frozen=True)
class MoveResult:
    """Outcome of a move; true when it is done."""

    outcome: MoveOutcome
    reason: str
    """Empty when done."""
    angle_deg: float
    """The last known, of the kind that was asked for; NaN: unknown."""

    def __bool__(self) -> bool:
        """Whether the motor is there."""
        return self.outcome is MoveOutcome.DONE


class Move:
    """One move_to(). It goes on while the program receives: in spin(), rate(), or result().

    Attributes:
        motor: its name.
        setpoint: what is sent.
        shown_us: `mono_us` of the state that it began with.
    """

    def __init__(
        self,
        motor: str,
        setpoint: Setpoint,
        tolerance_deg: float,
        timeout_s: float,
        client: str,
        now: Callable[[], float],
        spin: Callable[[float], object],
    ) -> None:
        self.motor = motor
        self.setpoint = setpoint
        self.shown_us = 0
        self._order = Order(motor, setpoint, client)
        self._tolerance_deg = tolerance_deg
        self._timeout_s = timeout_s
        self._now = now
        self._spin = spin
        self._started_s = self._heard_s = self._obeyed_s = now()
        self._within_since_us: int | None = None
        self._angle_deg = math.nan
        self._result: MoveResult | None = None
        self._dropped = False

    def done(self) -> bool:
        """Whether it has ended, well or not. Does not receive."""
        return self._result is not None

    def result(self) -> MoveResult:
        """Receives until it has ended; the move's own time-out bounds that."""
        while self._result is None:
            self._spin(0.05)
        return self._result

    # ---- for the Robot -----------------------------------------------------------------------

    @property
    def started_s(self) -> float:
        """When it began, on the clock of the link."""
        return self._started_s

    def on_event(self, event: Event) -> None:
        """Keeps what rc10d says about a setpoint that it skipped or refused; ends with its motor.

        Disabled and enabled between two states, it would be driven on: no state shows that.
        """
        self._order.on_event(event)
        if leaves_active(event) and event.source == self.motor and event.mono_us > self.shown_us:
            self.fail(f"{event.source}: {event.text}")

    def on_state(self, state: RobotState) -> None:
        """Takes in a new state."""
        self._heard_s = self._now()
        if state.taken_at_s < self._started_s:
            return
        motor = state.motors.get(self.motor)
        if self._result is not None:
            self._judge_ended(state, motor)
            return
        if motor is None:
            self.fail(f"the robot has no motor '{self.motor}'")
            return
        on_circle = self.setpoint.mode is Mode.ANGLE
        self._angle_deg = motor.angle_deg if on_circle else motor.total_angle_deg
        hindrance = hindered(state, motor)
        not_obeyed = self._order.not_obeyed(motor)
        if not not_obeyed:
            self._obeyed_s = state.taken_at_s
        if hindrance:
            self.fail(hindrance)
        elif state.taken_at_s > self._obeyed_s + _ON_ITS_WAY_S:
            self.fail(not_obeyed)
        elif math.isnan(self._angle_deg):
            self.fail(f"{self.motor}: the drive reports no angle")
        elif not_obeyed or self._distance_deg() > self._tolerance_deg:
            self._within_since_us = None
        else:
            if self._within_since_us is None:
                self._within_since_us = state.mono_us
            if state.mono_us - self._within_since_us >= _SETTLED_US:
                self._end(MoveOutcome.DONE, "")

    def _judge_ended(self, state: RobotState, motor: MotorState | None) -> None:
        """Drops a target that the motor does not obey any more: nothing brings it back to life."""
        if motor is not None and not self._order.not_obeyed(motor):
            self._obeyed_s = state.taken_at_s
        elif state.taken_at_s > self._obeyed_s + _ON_ITS_WAY_S:
            self._dropped = True

    def on_time(self) -> None:
        """Ends it when its time is over, or no state has come for a second."""
        now_s = self._now()
        if self._result is not None:
            self._dropped = self._dropped or now_s >= self._heard_s + SILENCE_S
        elif now_s >= self._started_s + self._timeout_s:
            self._end(
                MoveOutcome.TIMEOUT,
                f"{self.motor} is at {self._angle_deg:g} deg and not at {self.setpoint.value:g} "
                f"after {self._timeout_s:g} s",
            )
        elif now_s >= self._heard_s + SILENCE_S:
            self.fail(SILENT)

    def fail(self, reason: str) -> None:
        """Ends it without success, if it has not ended; its target is not sent any more."""
        self._dropped = True
        self._end(MoveOutcome.FAILED, reason)

    @property
    def dropped(self) -> bool:
        """Whether its target must not be sent any more."""
        return self._dropped

    # ---- within ------------------------------------------------------------------------------

    def _end(self, outcome: MoveOutcome, reason: str) -> None:
        if self._result is None:
            self._result = MoveResult(outcome, reason, self._angle_deg)

    def _distance_deg(self) -> float:
        distance_deg = self.setpoint.value - self._angle_deg
        if self.setpoint.mode is Mode.ANGLE:
            distance_deg = (distance_deg + 180.0) % 360.0 - 180.0
        return abs(distance_deg)
