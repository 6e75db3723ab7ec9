"""The judgement of a step, against responses whose numbers are known in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from rc10.step.analysis import StepMetrics, analyse

TIME_S = np.arange(-0.5, 5.0, 0.001)


def first_order(tau_s: float) -> NDArray[np.float64]:
    return np.where(TIME_S < 0, 0.0, 1.0 - np.exp(-np.maximum(TIME_S, 0) / tau_s))


def second_order(damping: float, omega_rad_s: float) -> NDArray[np.float64]:
    """The unit step of an underdamped system."""
    t = np.maximum(TIME_S, 0)
    root = math.sqrt(1 - damping**2)
    decay = np.exp(-damping * omega_rad_s * t) / root
    phase = omega_rad_s * root * t + math.acos(damping)
    return np.where(TIME_S < 0, 0.0, 1.0 - decay * np.sin(phase))


def test_a_first_order_lag_has_its_known_figures() -> None:
    tau_s = 0.1
    found = analyse(TIME_S, first_order(tau_s), 0, 1)
    assert found.rise_time_s == pytest.approx(tau_s * math.log(9), rel=1e-3)
    assert found.settling_time_s == pytest.approx(tau_s * math.log(50), rel=1e-3)
    assert found.overshoot_percent == 0
    assert found.steady_error == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("damping", [0.2, 0.5, 0.7])
def test_second_order_overshoots_by_the_formula(damping: float) -> None:
    omega_rad_s = 20.0
    root = math.sqrt(1 - damping**2)
    found = analyse(TIME_S, second_order(damping, omega_rad_s), 0, 1)
    overshoot = 100 * math.exp(-math.pi * damping / root)
    assert found.overshoot_percent == pytest.approx(overshoot, rel=1e-3)
    assert found.peak_time_s == pytest.approx(math.pi / (omega_rad_s * root), abs=0.002)
    # The envelope bounds the settling time.
    envelope_s = -math.log(0.02 * root) / (damping * omega_rad_s)
    assert 0.5 * envelope_s < found.settling_time_s <= envelope_s


def test_the_rise_time_is_that_of_the_usual_approximation() -> None:
    # (2.16 zeta + 0.60) / omega for 0.3 < zeta < 0.8 (R. Dorf, Modern Control Systems).
    found = analyse(TIME_S, second_order(0.5, 10.0), 0, 1)
    assert found.rise_time_s == pytest.approx((2.16 * 0.5 + 0.6) / 10.0, rel=0.03)


@pytest.mark.parametrize(("start", "target"), [(0.0, 100.0), (100.0, 0.0), (-30.0, -90.0)])
def test_size_offset_and_direction_make_no_difference(start: float, target: float) -> None:
    unit = analyse(TIME_S, second_order(0.3, 15.0), 0, 1)
    found = analyse(TIME_S, start + (target - start) * second_order(0.3, 15.0), start, target)
    for name in ("rise_time_s", "overshoot_percent", "settling_time_s", "peak_time_s"):
        assert getattr(found, name) == pytest.approx(getattr(unit, name)), name
    assert found.peak == pytest.approx(start + (target - start) * unit.peak)


def test_a_response_that_stays_below() -> None:
    found = analyse(TIME_S, 0.8 * first_order(0.1), 0, 100 / 100)
    assert math.isnan(found.rise_time_s)
    assert math.isnan(found.settling_time_s)
    assert found.steady_error == pytest.approx(0.2, abs=1e-6)


def test_passing_the_target_when_time_is_over_is_not_settling() -> None:
    ramp = np.clip(TIME_S / TIME_S[-1], 0, None)
    found = analyse(TIME_S, ramp, 0, 1)
    assert math.isnan(found.settling_time_s)
    assert found.rise_time_s == pytest.approx(0.8 * TIME_S[-1])


def test_a_wider_tolerance_settles_earlier() -> None:
    response = first_order(0.1)
    found = analyse(TIME_S, response, 0, 1, tolerance=0.05)
    assert found.settling_time_s == pytest.approx(0.1 * math.log(20), rel=1e-3)


def test_few_samples_are_interpolated() -> None:
    found = analyse([0.0, 1.0, 2.0, 30.0, 40.0], [0.0, 0.5, 1.0, 1.0, 1.0], 0, 1)
    assert found.rise_time_s == pytest.approx(1.6)
    assert found.settling_time_s == pytest.approx(1.96)


def test_missing_values_are_left_out() -> None:
    response = first_order(0.1)
    response[1000:1100] = np.nan
    assert analyse(TIME_S, response, 0, 1).rise_time_s == pytest.approx(0.2197, rel=1e-3)


@pytest.mark.parametrize(
    ("start", "target", "tolerance", "message"),
    [
        (1.0, 1.0, 0.02, "from 1 to 1 is no step"),
        (math.nan, 1.0, 0.02, "is no step"),
        (0.0, 1.0, 2.0, "tolerance = 2"),
    ],
)
def test_what_is_no_step_is_refused(
    start: float, target: float, tolerance: float, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        analyse(TIME_S, first_order(0.1), start, target, tolerance)
    with pytest.raises(ValueError, match="fewer than three"):
        analyse([0.0, 1.0], [0.0, 1.0], 0, 1)
    with pytest.raises(ValueError, match="2 times for 3 values"):
        analyse([0.0, 1.0], [0.0, 1.0, 1.0], 0, 1)


def test_the_error_is_the_target_less_the_steady_value() -> None:
    assert isinstance(found := analyse(TIME_S, 1.1 * first_order(0.05), 0, 1), StepMetrics)
    assert found.steady_error == pytest.approx(-0.1, abs=1e-6)
