from __future__ import annotations

import math
from typing import Any

import pytest

import rc10

NAN = math.nan
FF = {"velocity_ff_rpm": 3.0, "torque_ff_nm": 0.5}
SPRING = {"stiffness_nm_per_rad": 8.0, "damping_nms_per_rad": 0.2}


@pytest.mark.parametrize(
    ("setpoint", "mode", "expected"),
    [
        (rc10.coast(), rc10.Mode.COAST, (0, 0, 0, NAN, NAN)),
        (rc10.brake(), rc10.Mode.BRAKE, (0, 0, 0, NAN, NAN)),
        (rc10.current_a(-1.5), rc10.Mode.CURRENT, (-1.5, 0, 0, NAN, NAN)),
        (rc10.voltage_v(12), rc10.Mode.VOLTAGE, (12, 0, 0, NAN, NAN)),
        (rc10.duty(-1), rc10.Mode.DUTY, (-1, 0, 0, NAN, NAN)),
        (rc10.velocity_rpm(120), rc10.Mode.VELOCITY, (120, 0, 0, NAN, NAN)),
        (
            rc10.velocity_rpm(120, torque_ff_nm=0.5),
            rc10.Mode.VELOCITY,
            (120, 0, 0.5, NAN, NAN),
        ),
        (rc10.angle_deg(370, **FF), rc10.Mode.ANGLE, (370, 3, 0.5, NAN, NAN)),
        (rc10.total_angle_deg(-720, **FF), rc10.Mode.TOTAL_ANGLE, (-720, 3, 0.5, NAN, NAN)),
        (rc10.impedance_deg(45, **SPRING, **FF), rc10.Mode.IMPEDANCE, (45, 3, 0.5, 8.0, 0.2)),
    ],
)
def test_each_constructor_fills_its_fields(
    setpoint: rc10.Setpoint, mode: rc10.Mode, expected: tuple[float, ...]
) -> None:
    assert setpoint.mode is mode
    fields = (
        setpoint.value,
        setpoint.velocity_ff_rpm,
        setpoint.torque_ff_nm,
        setpoint.stiffness_nm_per_rad,
        setpoint.damping_nms_per_rad,
    )
    assert fields == pytest.approx(expected, nan_ok=True)


def test_every_mode_has_a_constructor() -> None:
    made = {
        rc10.coast(),
        rc10.brake(),
        rc10.current_a(0),
        rc10.voltage_v(0),
        rc10.duty(0),
        rc10.velocity_rpm(0),
        rc10.angle_deg(0),
        rc10.total_angle_deg(0),
        rc10.impedance_deg(0, **SPRING),
    }
    assert {setpoint.mode for setpoint in made} == set(rc10.Mode)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_refused(bad: float) -> None:
    with pytest.raises(rc10.InvalidSetpoint, match=r"VELOCITY setpoint: value = .* not a finite"):
        rc10.velocity_rpm(bad)
    with pytest.raises(rc10.InvalidSetpoint, match="torque_ff_nm"):
        rc10.angle_deg(0, torque_ff_nm=bad)
    with pytest.raises(rc10.InvalidSetpoint, match="stiffness_nm_per_rad"):
        rc10.impedance_deg(0, stiffness_nm_per_rad=bad, damping_nms_per_rad=0)


@pytest.mark.parametrize(
    ("make", "complaint"),
    [
        (lambda: rc10.duty(1.01), "not within -1 to 1"),
        (lambda: rc10.velocity_rpm(1, torque_ff_nm=1e39), "too large"),
        (lambda: rc10.impedance_deg(0, **{**SPRING, "damping_nms_per_rad": -1}), "negative"),
        (lambda: rc10.Setpoint(rc10.Mode.ANGLE, stiffness_nm_per_rad=1), "IMPEDANCE only"),
        (lambda: rc10.Setpoint(rc10.Mode.VELOCITY, velocity_ff_rpm=1), "ANGLE, IMPEDANCE only"),
        (lambda: rc10.Setpoint(rc10.Mode.DUTY, torque_ff_nm=1), "CURRENT, VELOCITY"),
    ],
)
def test_a_number_out_of_range_is_refused(make: Any, complaint: str) -> None:  # noqa: ANN401
    with pytest.raises(rc10.InvalidSetpoint, match=complaint):
        make()


def test_an_invalid_setpoint_is_a_value_error() -> None:
    assert issubclass(rc10.InvalidSetpoint, ValueError)


def test_text_is_no_number() -> None:
    with pytest.raises(TypeError, match="must be a number, not '120'"):
        rc10.velocity_rpm("120")  # type: ignore[arg-type]


def test_modes_know_their_units() -> None:
    assert rc10.Mode.VELOCITY.unit == "rpm"
    assert rc10.Mode.COAST.unit == ""
