"""Orders to motors. Each constructor names the unit of its value.

Everything is at the output shaft, counter-clockwise positive.
"""

from __future__ import annotations

import math
import numbers
from dataclasses import dataclass

from rc10.errors import InvalidSetpoint
from rc10.lcm_types.setpoint_t import setpoint_t
from rc10.words import Word

_FLOAT32_MAX = 3.4028234663852886e38
_IMPEDANCE_ONLY = ("stiffness_nm_per_rad", "damping_nms_per_rad")


class Mode(Word):
    """Meaning of a setpoint's value."""

    COAST = setpoint_t.MODE_COAST
    CURRENT = setpoint_t.MODE_CURRENT
    VELOCITY = setpoint_t.MODE_VELOCITY
    ANGLE = setpoint_t.MODE_ANGLE
    TOTAL_ANGLE = setpoint_t.MODE_TOTAL_ANGLE
    IMPEDANCE = setpoint_t.MODE_IMPEDANCE
    VOLTAGE = setpoint_t.MODE_VOLTAGE
    DUTY = setpoint_t.MODE_DUTY
    BRAKE = setpoint_t.MODE_BRAKE

    @property
    def unit(self) -> str:
        """The unit of the target, empty if the mode has none."""
        return _UNITS.get(self, "")


_UNITS = {
    Mode.CURRENT: "A",
    Mode.VELOCITY: "rpm",
    Mode.ANGLE: "deg",
    Mode.TOTAL_ANGLE: "deg",
    Mode.IMPEDANCE: "deg",
    Mode.VOLTAGE: "V",
}


_USED_BY: dict[str, tuple[Mode, ...]] = {
    "velocity_ff_rpm": (Mode.ANGLE, Mode.TOTAL_ANGLE, Mode.IMPEDANCE),
    "torque_ff_nm": (Mode.CURRENT, Mode.VELOCITY, Mode.ANGLE, Mode.TOTAL_ANGLE, Mode.IMPEDANCE),
}


@dataclass(frozen=True)
class Setpoint:
    """One order to one motor; made by the functions below.

    Raises:
        InvalidSetpoint: a value is not finite or outside the range of its mode.
        TypeError: a value is not a number.
    """

    mode: Mode
    value: float = 0.0
    velocity_ff_rpm: float = 0.0
    torque_ff_nm: float = 0.0
    stiffness_nm_per_rad: float = math.nan
    damping_nms_per_rad: float = math.nan

    def __post_init__(self) -> None:
        """Refuses here, where the caller's line is still in the traceback."""
        for name in ("value", "velocity_ff_rpm", "torque_ff_nm", *_IMPEDANCE_ONLY):
            number = getattr(self, name)
            if not isinstance(number, numbers.Real):
                raise TypeError(f"{name} must be a number, not {number!r}")
            problem = self._problem(name, float(number))
            if problem is not None:
                raise InvalidSetpoint(f"{self.mode.name} setpoint: {name} = {number} {problem}")

    def _problem(self, name: str, number: float) -> str | None:
        if name in _IMPEDANCE_ONLY and self.mode is not Mode.IMPEDANCE:
            return None if math.isnan(number) else "is for IMPEDANCE only"
        if not math.isfinite(number):
            return "is not a finite number"
        if number != 0 and self.mode not in _USED_BY.get(name, Mode):
            return "is for " + ", ".join(mode.name for mode in _USED_BY[name]) + " only"
        # All but the value travel as 32 bit floats.
        if name != "value" and abs(number) > _FLOAT32_MAX:
            return "is too large"
        if name in _IMPEDANCE_ONLY and number < 0:
            return "is negative"
        if name == "value" and self.mode is Mode.DUTY and abs(number) > 1:
            return "is not within -1 to 1"
        return None


def coast() -> Setpoint:
    """No torque."""
    return Setpoint(Mode.COAST)


def brake() -> Setpoint:
    """Resist motion."""
    return Setpoint(Mode.BRAKE)


def current_a(value: float) -> Setpoint:
    """A torque-producing current in A, positive for positive torque."""
    return Setpoint(Mode.CURRENT, value)


def velocity_rpm(value: float, *, torque_ff_nm: float = 0.0) -> Setpoint:
    """A velocity in rpm. `torque_ff_nm` is added after the loop."""
    return Setpoint(Mode.VELOCITY, value, torque_ff_nm=torque_ff_nm)


def angle_deg(value: float, *, velocity_ff_rpm: float = 0.0, torque_ff_nm: float = 0.0) -> Setpoint:
    """An angle in degrees, reached the shortest way round.

    Args:
        value: the angle in degrees; 370 is the same as 10.
        velocity_ff_rpm: velocity of the trajectory, added to the angle loop's output.
        torque_ff_nm: torque at the output shaft, added after the loops.
    """
    return Setpoint(Mode.ANGLE, value, velocity_ff_rpm, torque_ff_nm)


def total_angle_deg(
    value: float, *, velocity_ff_rpm: float = 0.0, torque_ff_nm: float = 0.0
) -> Setpoint:
    """A multi-turn angle in degrees: 720 is two turns from 0.

    Args:
        value: the angle in degrees.
        velocity_ff_rpm: velocity of the trajectory, added to the angle loop's output.
        torque_ff_nm: torque at the output shaft, added after the loops.
    """
    return Setpoint(Mode.TOTAL_ANGLE, value, velocity_ff_rpm, torque_ff_nm)


def impedance_deg(
    value: float,
    *,
    stiffness_nm_per_rad: float,
    damping_nms_per_rad: float,
    velocity_ff_rpm: float = 0.0,
    torque_ff_nm: float = 0.0,
) -> Setpoint:
    """An angle in degrees, held like a spring and a damper would.

    Args:
        value: the angle in degrees.
        stiffness_nm_per_rad: torque for each radian of deviation, not negative.
        damping_nms_per_rad: torque for each rad/s, not negative.
        velocity_ff_rpm: velocity of the trajectory.
        torque_ff_nm: torque at the output shaft, added to that of spring and damper.
    """
    return Setpoint(
        Mode.IMPEDANCE,
        value,
        velocity_ff_rpm,
        torque_ff_nm,
        stiffness_nm_per_rad,
        damping_nms_per_rad,
    )


def voltage_v(value: float) -> Setpoint:
    """A voltage in V."""
    return Setpoint(Mode.VOLTAGE, value)


def duty(value: float) -> Setpoint:
    """A duty cycle from -1 to 1."""
    return Setpoint(Mode.DUTY, value)
