"""A flat floor that turns wheel speeds into the robot's true pose.

It knows nothing of the daemon's kinematics: each wheel says in which directions, and how fast, the
floor moves along under it, and the robot moves so that all of them are met as well as they can be
(least squares; wheels that agree do not slip).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from rc10.fakes import FakeMotor


class Contact(NamedTuple):
    """Where a wheel stands, in the robot's frame, and how the robot moves there by its will."""

    x_m: float
    y_m: float
    direction_rad: float
    speed_m_s: float


class Pose(NamedTuple):
    x_m: float
    y_m: float
    heading_deg: float


class Ground:
    """A robot on the floor.

    Public attributes may be read at any time:
        x_m, y_m, heading_deg: the true pose; the heading is multi-turn.
        turn_deg_s: how fast it turns.
        path_m: how far its middle has come.

    Args:
        wheels: each says its contacts.
    """

    def __init__(self, wheels: Iterable[Callable[[], Iterable[Contact]]]) -> None:
        self.x_m = self.y_m = self.heading_deg = self.turn_deg_s = self.path_m = 0.0
        self._wheels = list(wheels)

    @property
    def pose(self) -> Pose:
        return Pose(self.x_m, self.y_m, self.heading_deg)

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        vx_m_s, vy_m_s, turn_rad_s = self._motion()
        # Halfway through the step it looks there: exact to the third power of a millisecond.
        half_rad = math.radians(self.heading_deg) + turn_rad_s * dt_s / 2.0
        self.x_m += (vx_m_s * math.cos(half_rad) - vy_m_s * math.sin(half_rad)) * dt_s
        self.y_m += (vx_m_s * math.sin(half_rad) + vy_m_s * math.cos(half_rad)) * dt_s
        self.turn_deg_s = math.degrees(turn_rad_s)
        self.heading_deg += self.turn_deg_s * dt_s
        self.path_m += math.hypot(vx_m_s, vy_m_s) * dt_s

    def _motion(self) -> tuple[float, float, float]:
        # The normal equations of  c * (vx - w y) + s * (vy + w x) = speed.
        a = [[0.0] * 3 for _ in range(3)]
        b = [0.0] * 3
        for wheel in self._wheels:
            for contact in wheel():
                c, s = math.cos(contact.direction_rad), math.sin(contact.direction_rad)
                row = (c, s, s * contact.x_m - c * contact.y_m)
                for i in range(3):
                    b[i] += row[i] * contact.speed_m_s
                    for j in range(3):
                        a[i][j] += row[i] * row[j]
        whole = _determinant(a)
        x, y, w = (_determinant(_with_column(a, i, b)) / whole for i in range(3))
        return x, y, w


def _determinant(a: list[list[float]]) -> float:
    (a0, a1, a2), (b0, b1, b2), (c0, c1, c2) = a
    return a0 * (b1 * c2 - b2 * c1) - a1 * (b0 * c2 - b2 * c0) + a2 * (b0 * c1 - b1 * c0)


def _with_column(a: list[list[float]], column: int, b: list[float]) -> list[list[float]]:
    return [[*row[:column], value, *row[column + 1 :]] for row, value in zip(a, b, strict=True)]


def mecanum_wheel(
    motor: FakeMotor, x_m: float, y_m: float, *, radius_m: float, sign: int
) -> Callable[[], list[Contact]]:
    """A wheel whose roller on the floor has an axle at 45 degrees; `sign` is how it is mounted.

    Seen from above, the rollers on top of front left and rear right point forward and left; those
    on the floor, on the other side of the hub, forward and right. A roller gives way across its
    axle, and holds along it.
    """
    axle_rad = math.radians(-45.0 if x_m * y_m > 0 else 45.0)

    def contacts() -> list[Contact]:
        rim_m_s = sign * motor.speed_rad_s * radius_m
        return [Contact(x_m, y_m, axle_rad, rim_m_s * math.cos(axle_rad))]

    return contacts


def steered_wheel(
    drive: FakeMotor, steer: FakeMotor, x_m: float, y_m: float, *, radius_m: float
) -> Callable[[], list[Contact]]:
    """A wheel that rolls where it is steered to and does not slide across."""

    def contacts() -> list[Contact]:
        along_rad = math.radians(steer.angle_deg)
        rolling = Contact(x_m, y_m, along_rad, drive.speed_rad_s * radius_m)
        return [rolling, Contact(x_m, y_m, along_rad + math.pi / 2.0, 0.0)]

    return contacts
