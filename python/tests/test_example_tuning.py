"""The search for gains, on a motor that is two equations."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pid_tuning import Floats, Gains, acceleration, score, search, slope, suggest
from rc10.step.analysis import StepMetrics, analyse

ACCELERATION_RPM_S_PER_A = 200.0
SECONDS = 0.8


def step_with(gains: Gains, dt_s: float = 0.001) -> StepMetrics:
    """A step of 60 rpm with 2 ms of delay in the loop."""
    velocity, integral, currents = 0.0, 0.0, [0.0, 0.0]
    seen = []
    for _ in range(round(SECONDS / dt_s)):
        error = 60.0 - velocity
        integral += gains.ki_a_per_rpm_s * error * dt_s
        currents.append(gains.kp_a_per_rpm * error + integral)
        velocity += ACCELERATION_RPM_S_PER_A * currents.pop(0) * dt_s
        seen.append(velocity)
    return analyse(np.arange(len(seen)) * dt_s, np.clip(seen, -1e6, 1e6), 0, 60)


def badness(gains: Gains) -> float:
    return score(step_with(gains), SECONDS)


def test_the_suggestion_is_critically_damped() -> None:
    gains = suggest(ACCELERATION_RPM_S_PER_A, 0.03)
    # s² + b kp s + b ki = (s + 1/T)²
    assert ACCELERATION_RPM_S_PER_A * gains.kp_a_per_rpm == pytest.approx(2 / 0.03)
    assert ACCELERATION_RPM_S_PER_A * gains.ki_a_per_rpm_s == pytest.approx(1 / 0.03**2)
    metrics = step_with(gains)
    # The zero of a PI loop overshoots by 13.5 % (exp(-2)) without any oscillation.
    assert metrics.overshoot_percent == pytest.approx(100 * math.exp(-2), abs=4)
    assert metrics.settling_time_s < 0.3


@pytest.mark.parametrize("acceleration", [0.0, -5.0, math.nan])
def test_a_motor_that_does_not_accelerate_is_no_start(acceleration: float) -> None:
    with pytest.raises(ValueError, match="does it turn freely"):
        suggest(acceleration, 0.03)


def test_the_slope_of_a_pulse_has_an_error_that_a_gap_or_a_lapse_makes_large() -> None:
    time_s: Floats = np.linspace(0.02, 0.11, 10, dtype=np.float64)
    assert slope(time_s, 300.0 * time_s) == pytest.approx((300.0, 0.0), abs=1e-6)
    assert slope(time_s[:4], 300.0 * time_s[:4])[1] == math.inf
    lapsed: Floats = np.minimum(time_s, 0.05, dtype=np.float64) * 300.0
    assert slope(time_s, lapsed)[1] > 20.0


def test_disturbed_pulses_are_given_again() -> None:
    pulses: list[float] = []

    def slope_of(current_a: float) -> tuple[float, float]:
        pulses.append(current_a)
        busy = len(pulses) <= 3
        return (-150.0, 90.0) if busy else (200.0 * current_a - 30.0, 2.0)

    assert acceleration(slope_of, 1.5) == pytest.approx(200.0)
    assert pulses == [1.5, 3.0] * 3


def test_pulses_that_never_differ_are_told_with_what_to_look_at() -> None:
    with pytest.raises(ValueError, match=r"does it turn freely.* is the computer busy"):
        acceleration(lambda _: (5.0, 3.0), 1.0)


def test_the_search_improves_and_keeps_to_its_tries() -> None:
    tried: list[Gains] = []

    def counted(gains: Gains) -> float:
        tried.append(gains)
        return badness(gains)

    start = Gains(0.05, 2.0)
    best, least = search(counted, start, tries=20)
    assert len(tried) <= 20
    assert least == badness(best) < 0.7 * badness(start)


def test_what_never_settles_scores_as_the_whole_time() -> None:
    metrics = step_with(Gains(0.001, 0.0))
    assert math.isnan(metrics.settling_time_s)
    assert score(metrics, SECONDS) > SECONDS


def test_gains_are_written_as_the_configuration_has_them() -> None:
    assert Gains(0.25, 3.0).yaml() == "velocity_pid: {kp_a_per_rpm: 0.25, ki_a_per_rpm_s: 3}"
