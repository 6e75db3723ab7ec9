"""The same setpoints and readings in rad and rad/s, for code that thinks in SI units.

    from rc10 import radians

    robot.command(wheel=radians.velocity_rad_s(12.5))
    speed_rad_s = radians.rad_s(robot.motor("wheel").velocity_rpm)

The conversions take numbers and NumPy arrays. Everything is at the output shaft,
counter-clockwise positive.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, TypeVar

from rc10 import setpoints

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rc10.setpoints import Setpoint

# A number, or an array of them.
Number = TypeVar("Number", float, "NDArray[Any]")

_RAD_PER_DEG = math.pi / 180.0
_RAD_S_PER_RPM = 2.0 * math.pi / 60.0


def rad(angle_deg: Number) -> Number:
    """Degrees to radians."""
    return angle_deg * _RAD_PER_DEG


def deg(angle_rad: Number) -> Number:
    """Radians to degrees."""
    return angle_rad / _RAD_PER_DEG


def rad_s(velocity_rpm: Number) -> Number:
    """Revolutions per minute to rad/s."""
    return velocity_rpm * _RAD_S_PER_RPM


def rpm(velocity_rad_s: Number) -> Number:
    """Rad/s to revolutions per minute."""
    return velocity_rad_s / _RAD_S_PER_RPM


def velocity_rad_s(value: float, *, torque_ff_nm: float = 0.0) -> Setpoint:
    """A velocity in rad/s; rc10.velocity_rpm() in other units."""
    return setpoints.velocity_rpm(rpm(value), torque_ff_nm=torque_ff_nm)


def angle_rad(
    value: float, *, velocity_ff_rad_s: float = 0.0, torque_ff_nm: float = 0.0
) -> Setpoint:
    """An angle in radians, reached the shortest way round; rc10.angle_deg() in other units."""
    return setpoints.angle_deg(
        deg(value), velocity_ff_rpm=rpm(velocity_ff_rad_s), torque_ff_nm=torque_ff_nm
    )


def total_angle_rad(
    value: float, *, velocity_ff_rad_s: float = 0.0, torque_ff_nm: float = 0.0
) -> Setpoint:
    """A multi-turn angle in radians; rc10.total_angle_deg() in other units."""
    return setpoints.total_angle_deg(
        deg(value), velocity_ff_rpm=rpm(velocity_ff_rad_s), torque_ff_nm=torque_ff_nm
    )


def impedance_rad(
    value: float,
    *,
    stiffness_nm_per_rad: float,
    damping_nms_per_rad: float,
    velocity_ff_rad_s: float = 0.0,
    torque_ff_nm: float = 0.0,
) -> Setpoint:
    """An angle in radians, held by a spring and a damper; rc10.impedance_deg() in other units."""
    return setpoints.impedance_deg(
        deg(value),
        stiffness_nm_per_rad=stiffness_nm_per_rad,
        damping_nms_per_rad=damping_nms_per_rad,
        velocity_ff_rpm=rpm(velocity_ff_rad_s),
        torque_ff_nm=torque_ff_nm,
    )
