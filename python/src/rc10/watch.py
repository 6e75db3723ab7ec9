"""Ends a loop that sends targets to one motor, when that motor was stopped."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rc10.catch_up import CatchUp
from rc10.errors import MotorStopped, Timeout
from rc10.moves import SILENCE_S, SILENT, leaves_active
from rc10.orders import hindered, obstacle, of_another
from rc10.state import StopCause

if TYPE_CHECKING:
    from rc10.client import Robot
    from rc10.events import Event
    from rc10.state import MotorState


class Watch:
    """Judges, before each target that a loop repeats, whether its motor may have it.

        watch = rc10.Watch(robot, "wheel")
        for t_s in robot.rate(100):
            if watch.may_send():
                robot.command(wheel=rc10.velocity_rpm(120))

    To be made once the robot's state shows the motor ACTIVE. It ends with the first that stops the
    motor, in a state or an event: enabled anew by somebody, the motor is not driven on.

    Args:
        robot: whose events() it takes from then on.
        motor: its name.
        on_angle: a lost reference of the motor ends it too.

    Attributes:
        events: those that the last may_send() has taken.
    """

    def __init__(self, robot: Robot, motor: str, *, on_angle: bool = False) -> None:
        self.events: list[Event] = []
        self._robot = robot
        self._motor = motor
        self._hindered = hindered if on_angle else obstacle
        self._shown_us = robot.state.mono_us
        self._catch_up = CatchUp(robot.state.taken_at_s)
        self._sent_s = 0.0
        self._obeyed = False
        self._over = ""
        self._hear()

    def may_send(self) -> bool:
        """In each turn, after receiving. False: after a pause, until a state of after it has come.

        Raises:
            MotorStopped: the motor does not obey any more, another client has it, or it was enabled
                anew while this program stood still; from now on for good.
            Timeout: no state has come for a second.
        """
        now_s = self._robot.link.now()
        state = self._robot.state
        caught_up = self._catch_up.done(now_s, state)
        self._hear()
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

    def _hear(self) -> None:
        self.events = self._robot.events()
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
