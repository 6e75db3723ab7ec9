"""Whether a motor can obey, and whether it does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rc10.state import MotorState, MotorStatus, RobotState, RobotStatus

if TYPE_CHECKING:
    from rc10.events import Event
    from rc10.setpoints import Setpoint

# Events about setpoints that do not act: docs/lcm.md.
_SETPOINT_SKIPPED, _NOT_OWNER, _MESSAGE_REFUSED = 103, 104, 202


@dataclass
class Order:
    """A setpoint that a client sends to a motor again and again."""

    motor: str
    setpoint: Setpoint
    client: str
    refusal: str = ""
    """Text of the last event that it was skipped or refused."""
    obeyed: bool = False
    """A state has shown that the motor follows it."""

    def on_event(self, event: Event) -> None:
        """Keeps what rc10d says about a setpoint that it skipped or refused."""
        of_us = f"'{self.client}'" in event.text
        of_motor = event.source == self.motor
        if (
            (of_motor and event.code == _SETPOINT_SKIPPED)
            or (of_motor and of_us and event.code == _NOT_OWNER)
            or (of_us and event.code == _MESSAGE_REFUSED)
        ):
            self.refusal = event.text

    def not_obeyed(self, motor: MotorState) -> str:
        """Reason why the motor does not follow it, in words; empty if it does."""
        ours = motor.owner == self.client
        if ours and motor.mode is self.setpoint.mode and motor.target == self.setpoint.value:
            self.obeyed = True
            return ""
        said = f": {self.refusal}" if self.refusal else ""
        if ours:
            return (
                f"{self.motor} follows another target of '{self.client}': does a second program "
                f"run under this client name?{said}"
            )
        if taken := of_another(motor, self.client):
            return taken + said
        if said:
            return f"{self.motor} did not take the target{said}"
        what = "lost" if self.obeyed else "did not take"
        return f"{self.motor} {what} the target: see `rc10ctl stats` for what was refused"


def obstacle(state: RobotState, motor: MotorState) -> str:
    """Reason why a motor would not act on a target, and what to do; empty if it would."""
    if state.status is RobotStatus.ESTOP:
        return "the robot is in ESTOP: clear it, then enable the motors"
    if state.status is RobotStatus.STOPPING:
        return "rc10d is stopping"
    name = motor.name
    if motor.status is not MotorStatus.ACTIVE:
        return {
            MotorStatus.OFFLINE: f"{name} is OFFLINE: no feedback from the drive; "
            "check power, wiring and id",
            MotorStatus.READY: f"{name} is READY: enable it first",
            MotorStatus.ENABLING: f"{name} is ENABLING: wait until it is ACTIVE",
            MotorStatus.FAULT: f"{name} is in FAULT ({motor.fault_text}): clear it, then enable it",
        }[motor.status]
    return ""


def hindered(state: RobotState, motor: MotorState) -> str:
    """Reason why a motor would not go to an angle, and what to do; empty if it would."""
    return obstacle(state, motor) or without_reference(motor)


def of_another(motor: MotorState, client: str) -> str:
    """Holder of a motor that is somebody else, and the remedy; empty: none."""
    if motor.owner in ("", client):
        return ""
    return (
        f"{motor.name} is held by the client '{motor.owner}': end that one, or take a higher "
        "priority"
    )


def without_reference(motor: MotorState) -> str:
    """Reason why a motor would not go to an angle though it obeys; empty if it would."""
    if not motor.zeroed:
        return (
            f"{motor.name} has no reference for angles: home it, or zero it while it is disabled, "
            "or write zero: power_on in the configuration"
        )
    return ""
