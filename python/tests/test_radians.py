"""Radians are degrees, and rad/s are rpm, of the same thing."""

from __future__ import annotations

import math

import numpy as np
import pytest

import rc10
from rc10 import radians


def test_setpoints_are_those_in_degrees_and_rpm() -> None:
    assert radians.velocity_rad_s(2 * math.pi).value == pytest.approx(60)
    assert radians.velocity_rad_s(1, torque_ff_nm=0.5).torque_ff_nm == 0.5
    turn = radians.total_angle_rad(-2 * math.pi, velocity_ff_rad_s=math.pi)
    assert turn.mode is rc10.Mode.TOTAL_ANGLE
    assert turn.value == pytest.approx(-360)
    assert turn.velocity_ff_rpm == pytest.approx(30)
    assert radians.angle_rad(math.pi / 2).mode is rc10.Mode.ANGLE
    spring = radians.impedance_rad(math.pi, stiffness_nm_per_rad=2, damping_nms_per_rad=0.1)
    assert spring == rc10.impedance_deg(180, stiffness_nm_per_rad=2, damping_nms_per_rad=0.1)


def test_readings_and_arrays_there_and_back() -> None:
    assert radians.rad(180.0) == pytest.approx(math.pi)
    assert radians.rad_s(60.0) == pytest.approx(2 * math.pi)
    values = np.array([-90.0, 0.0, 720.0])
    np.testing.assert_allclose(radians.deg(radians.rad(values)), values)
    np.testing.assert_allclose(radians.rpm(radians.rad_s(values)), values)
