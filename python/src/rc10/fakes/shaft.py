"""An output shaft, in the units of rc10."""

from __future__ import annotations

import math

RPM_PER_RAD_S = 60.0 / math.tau


class Shaft:
    """Speed and angle in rad, read in rpm and degrees."""

    speed_rad_s: float
    angle_rad: float

    @property
    def velocity_rpm(self) -> float:
        """Velocity of the output shaft."""
        return self.speed_rad_s * RPM_PER_RAD_S

    @property
    def angle_deg(self) -> float:
        """Multi-turn angle of the output shaft."""
        return math.degrees(self.angle_rad)
