"""The numbers that a motor's state has, by name: `wheel.velocity_rpm`."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from rc10.errors import UnknownSignal
from rc10.setpoints import Mode
from rc10.spelling import did_you_mean
from rc10.state import CommandUnit, MotorState

if TYPE_CHECKING:
    from rc10.state import RobotState

SIGNALS = tuple(part.name for part in fields(MotorState) if part.type != "str")
"""The signals of a motor: what is no text in its state."""

_UNITS = {
    "deg": "deg",
    "rpm": "rpm",
    "a": "A",
    "nm": "N·m",
    "v": "V",
    "c": "°C",
    "us": "µs",
    "hz": "Hz",
}

_COMMAND_UNITS = {CommandUnit.AMPERE: "A", CommandUnit.VOLT: "V"}


@dataclass(frozen=True)
class Signal:
    """One number of one motor."""

    motor: str
    name: str

    def __str__(self) -> str:
        return f"{self.motor}.{self.name}"

    @classmethod
    def parse(cls, text: str) -> Signal:
        """Reads `motor.signal`; the name of a motor may have dots itself.

        Raises:
            UnknownSignal: it is not of this form, or there is no such signal.
        """
        motor, _, name = text.rpartition(".")
        if not motor:
            raise UnknownSignal(f"{text!r} is no signal: write motor.signal, as wheel.velocity_rpm")
        if name not in SIGNALS:
            raise UnknownSignal(
                f"{text!r}: a motor has no signal {name!r}; it has: {', '.join(SIGNALS)}"
                f"{did_you_mean(name, SIGNALS)}"
            )
        return cls(motor, name)

    def read(self, state: RobotState) -> float:
        """Returns its value; NaN for what the drive does not report.

        Raises:
            UnknownMotor: the robot has no such motor.
        """
        return value_of(state.motor(self.motor), self.name)

    def unit(self, state: RobotState) -> str:
        """Returns its unit; that of `target` and `command_value` is the one in force."""
        motor = state.motor(self.motor)
        if self.name == "target":
            return motor.mode.unit
        if self.name == "command_value":
            if motor.command_unit is CommandUnit.NATIVE:
                return motor.mode.unit
            return _COMMAND_UNITS.get(motor.command_unit, "")
        return unit_of(self.name)


def value_of(motor: MotorState, name: str) -> float:
    """Returns the signal `name` of a motor as a number."""
    return float(getattr(motor, name))


def unit_of(name: str) -> str:
    """Returns the unit that the name of a signal ends with; empty for numbers without one."""
    return _UNITS.get(name.rpartition("_")[2], "")


def measured_by(mode: Mode) -> str | None:
    """Returns the signal that follows the target of a mode; None for those without one."""
    return {
        Mode.CURRENT: "current_a",
        Mode.VELOCITY: "velocity_rpm",
        Mode.ANGLE: "angle_deg",
        Mode.TOTAL_ANGLE: "total_angle_deg",
        Mode.IMPEDANCE: "angle_deg",
        Mode.VOLTAGE: "voltage_v",
    }.get(mode)
