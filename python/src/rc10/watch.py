"""Ends a loop that sends targets to one motor, when that motor was stopped."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from rc10.catch_up import PAUSE_S, CatchUp
from rc10.errors import MotorStopped, Timeout
from rc10.inbox import EVENTS_KEPT
from rc10.moves import SILENCE_S, SILENT, leaves_active
from rc10.orders import hindered, obstacle, of_another
from rc10.state import StopCause

if TYPE_CHECKING:
    from rc10.client import Robot
    from rc10.events import Event
    from rc10.state import MotorState

# Turns in a row that a busy computer may hold up.
_SLOW_TURNS = 5
_SLOW = (
    "the turns of this loop take too long: a busy computer, "
    "or a loop whose Watch needs a longer pause_s"
)


class Watch:
    """Judges, before each target that a loop repeats, whether its motor may have it.

        watch = rc10.Watch(robot, "wheel")
        for t_s in robot.rate(100):
            if watch.may_send():
                robot.command(wheel=rc10.velocity_rpm(120))

    To be made once the robot's state shows the motor ACTIVE. It ends with the first that stops the
    motor, in a state or an event: enabled anew by somebody, the motor is not driven on.

    Args:
        robot: whose events it hears; events() goes on to return them.
        motor: its name.
        on_angle: a lost reference of the motor ends it too.
        pause_s: time between two turns of the loop that shows a pause; at least two turns long.

    Attributes:
        events: those since the may_send() before the last.
    """

    def __init__(
        self, robot: Robot, motor: str, *, on_angle: bool = False, pause_s: float = PAUSE_S
    ) -> None:
        self.events: list[Event] = []
        self._heard: deque[Event] = deque(maxlen=EVENTS_KEPT)
        self._robot = robot
        self._motor = motor
        self._hindered = hindered if on_angle else obstacle
        self._shown_us = robot.state.mono_us
        self._catch_up = CatchUp(robot.state.taken_at_s, pause_s)
        self._slow_turns = 0
        self._sent_s = 0.0
        self._obeyed = False
        self._over = ""
        self._heard.extend(robot.listen_to_events(self))
        self._judge_events()

    def on_event(self, event: Event) -> None:
        """Called with each event, while the program receives."""
        self._heard.append(event)

    def may_send(self) -> bool:
        """In each turn, after receiving. False: after a pause, until a state of after it has come.

        Raises:
            MotorStopped: the motor does not obey any more, another client has it, or it was enabled
                anew while this program stood still; from now on for good.
            Timeout: no state has come for a second, or each turn of the loop takes longer than
                `pause_s`.
        """
        now_s = self._robot.link.now()
        state = self._robot.state
        caught_up = self._catch_up.done(now_s, state)
        self._slow_turns = self._slow_turns + 1 if self._catch_up.resumed_s == now_s else 0
        if self._slow_turns > _SLOW_TURNS:
            raise Timeout(_SLOW)
        self._judge_events()
        motor = state.motor(self._motor)
        self._over = (
            self._over
            or self._hindered(state, motor)
            or of_another(motor, self._robot.client)
            or (self._enabled_anew(motor) if caught_up else "")
        )
        if self._over:
            raise MotorStopped(self._over)
        if now_s - max(state.taken_at_s, self._catch_up.resumed_s) > SILENCE_S:
            raise Timeout(SILENT)
        if caught_up:
            self._sent_s = now_s
        self._obeyed = self._obeyed or motor.owner == self._robot.client
        return caught_up

    def _judge_events(self) -> None:
        self.events = list(self._heard)
        self._heard.clear()
        for event in self.events:
            ends = leaves_active(event) and event.source == self._motor
            if ends and event.mono_us > self._shown_us:
                self._over = self._over or f"{event.source}: {event.text}"

    def _enabled_anew(self, motor: MotorState) -> str:
        """Events of a pause may be lost: the motor shows what became of the target before it."""
        paused = self._obeyed and self._sent_s < self._catch_up.resumed_s
        lapsed = motor.owner == "" and motor.stop_cause is StopCause.TIMEOUT
        if not paused or lapsed or motor.owner == self._robot.client:
            return ""
        return f"{motor.name} was enabled anew while this program stood still"
