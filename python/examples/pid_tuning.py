"""Tunes a velocity loop: measures the motor, suggests gains, and tries what is better.

    python pid_tuning.py demo front_left --current 1 --rpm 60

1. Two short pulses of current tell how the motor accelerates; what friction takes cancels out.
2. From that follow gains for a loop that does not oscillate and is as fast as you want it.
3. Steps are run with the gains of the configuration and with gains around those, set live, and
   scored. The best stay in force until rc10d restarts.

The motor turns freely meanwhile: lift the wheels. It prints the lines for the configuration. Ended
early, it puts the gains back that the motor had.
"""

from __future__ import annotations

import argparse
import math
import signal
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Callable

import numpy as np
from numpy.typing import NDArray

import rc10
from rc10.step.plan import StepPlan
from rc10.step.run import run_step

if TYPE_CHECKING:
    from rc10.step.analysis import StepMetrics

_PULSE_S = 0.12
# The first part of a pulse: the current rises.
_RISING_S = 0.02
# States of a pulse that make a line: half of those that 100 Hz give.
_LEAST_SAMPLES = 5
# Standard error of what the two pulses differ by, as a part of it.
_SLOPE_TOLERANCE = 0.1
# Tries of the pulses that a busy computer has disturbed.
_TRIES = 5
# Percent of overshoot that are as bad as a second of settling.
_PERCENT_PER_S = 50.0

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Gains:
    """Gains of the velocity loop, under the names of the configuration."""

    kp_a_per_rpm: float
    ki_a_per_rpm_s: float

    def yaml(self) -> str:
        """Returns the line for the configuration."""
        return (
            f"velocity_pid: {{kp_a_per_rpm: {self.kp_a_per_rpm:.4g}, "
            f"ki_a_per_rpm_s: {self.ki_a_per_rpm_s:.4g}}}"
        )


def suggest(acceleration_rpm_s_per_a: float, time_constant_s: float) -> Gains:
    """Returns gains that make a critically damped loop of a motor that only has inertia.

    With acceleration b by each ampere, a PI loop has the characteristic s² + b kp s + b ki; two
    poles at -1/time_constant make that kp = 2 / (b T), ki = 1 / (b T²).

    Raises:
        ValueError: the motor did not accelerate.
    """
    if not acceleration_rpm_s_per_a > 0 or not time_constant_s > 0:
        raise ValueError(
            f"the motor accelerates by {acceleration_rpm_s_per_a:g} rpm/s for each ampere: does it "
            "turn freely, and is the current above its friction?"
        )
    b, t = acceleration_rpm_s_per_a, time_constant_s
    return Gains(2.0 / (b * t), 1.0 / (b * t * t))


def score(metrics: StepMetrics, seconds: float) -> float:
    """Returns how bad a step is, in seconds: settling, overshoot and what remains."""
    settling_s = seconds if math.isnan(metrics.settling_time_s) else metrics.settling_time_s
    remains = abs(metrics.steady_error / (metrics.target - metrics.start))
    return settling_s + metrics.overshoot_percent / _PERCENT_PER_S + seconds * remains


def search(
    badness: Callable[[Gains], float], start: Gains, tries: int, factor: float = 1.5
) -> tuple[Gains, float]:
    """Tries gains around the best so far, one at a time, by ever smaller factors.

    Args:
        badness: runs a step with these gains and scores it.
        start: where to begin.
        tries: how often badness() may be called.
        factor: of the first tries.
    """
    best, least = start, badness(start)
    left = tries - 1
    while left > 0 and factor > 1.02:
        improved = False
        for name in ("kp_a_per_rpm", "ki_a_per_rpm_s"):
            for scale in (factor, 1.0 / factor):
                if left <= 0:
                    break
                left -= 1
                tried = replace(best, **{name: getattr(best, name) * scale})
                found = badness(tried)
                if found < least:
                    best, least, improved = tried, found, True
                    break
        if not improved:
            factor = math.sqrt(factor)
    return best, least


def slope(time_s: Floats, velocity_rpm: Floats) -> tuple[float, float]:
    """Returns the slope of a line through these, rpm/s, and its standard error (infinite: none)."""
    if len(time_s) < _LEAST_SAMPLES:
        return math.nan, math.inf
    line, covariance = np.polyfit(time_s, velocity_rpm, 1, cov=True)
    return float(line[0]), math.sqrt(covariance[0, 0])


def acceleration(slope_of: Callable[[float], tuple[float, float]], current_a: float) -> float:
    """Returns by how many rpm/s the motor accelerates for each ampere.

    Args:
        slope_of: runs a pulse of so many amperes and returns the slope of its speed, and the error.
        current_a: of the smaller pulse. Both are above the friction, which is the same in both.

    Raises:
        ValueError: the speeds do not lie on lines, or do not differ, however often it is tried.
    """
    for _ in range(_TRIES):
        (low, low_error), (high, high_error) = slope_of(current_a), slope_of(2.0 * current_a)
        error = math.hypot(low_error, high_error)
        # A busy computer loses states, or a target lapses in the pulse.
        if error < _SLOPE_TOLERANCE * (high - low):
            return (high - low) / current_a
    raise ValueError(
        f"{current_a:g} A accelerate the motor by {low:.3g} rpm/s and {2 * current_a:g} A by "
        f"{high:.3g}, within {error:.2g}: does it turn freely, is the current above its friction, "
        "is the computer busy?"
    )


def _pulse(robot: rc10.Robot, motor: str, current_a: float) -> tuple[float, float]:
    """Gives a pulse to the motor, which has to be ACTIVE; returns the slope and its error."""
    plan = StepPlan(motor, rc10.Mode.CURRENT, current_a, seconds=_PULSE_S, before_s=0.05)
    recording = run_step(robot, plan).recording
    _stop(robot, motor)
    used = (recording.time_s >= _RISING_S) & (recording.time_s <= _PULSE_S)
    return slope(recording.time_s[used], recording.motor(motor).velocity_rpm[used])


def _stop(robot: rc10.Robot, motor: str) -> None:
    watch = rc10.Watch(robot, motor)
    for t_s in robot.rate(50):
        if not watch.may_send():
            continue
        robot.command({motor: rc10.velocity_rpm(0)}, validity_ms=150)
        if abs(robot.motor(motor).velocity_rpm) < 1.0 or t_s > 2.0:
            return


def gains_of(robot: rc10.Robot, motor: str) -> Gains:
    """Returns those in force.

    Raises:
        rc10.RequestRefused: its drive closes its loops.
        ValueError: the drive closes the velocity loop, or is commanded in volts.
    """
    gains = robot.gains(motor)
    try:
        kp, ki = (gains[f"velocity_pid.{key}"] for key in ("kp_a_per_rpm", "ki_a_per_rpm_s"))
    except KeyError as error:
        raise ValueError(f"{motor} has no {error}: only loops that command amperes") from None
    return Gains(kp, ki)


def set_gains(robot: rc10.Robot, motor: str, gains: Gains) -> rc10.Gains:
    """Sets them in the running rc10d and returns all that the motor has then."""
    keys = {"kp_a_per_rpm": gains.kp_a_per_rpm, "ki_a_per_rpm_s": gains.ki_a_per_rpm_s}
    return robot.set_gains(motor, {f"velocity_pid.{key}": value for key, value in keys.items()})


def tune(robot: rc10.Robot, options: argparse.Namespace) -> None:
    """Does all of it, and prints it."""
    b = acceleration(lambda current: _pulse(robot, options.motor, current), options.current)
    print(f"{options.motor} accelerates by {b:.0f} rpm/s for each ampere")
    gains = suggest(b, options.time_constant)
    print(f"suggested: {gains.yaml()}")

    plan = StepPlan(options.motor, rc10.Mode.VELOCITY, options.rpm, seconds=options.seconds)

    def badness(tried: Gains | None) -> float:
        if tried is not None:
            set_gains(robot, options.motor, tried)
        metrics = run_step(robot, plan).metrics
        found = score(metrics, options.seconds)
        print(
            f"{'as configured' if tried is None else tried.yaml()}: score {found:.3f}, "
            f"overshoot {metrics.overshoot_percent:.1f} %, settled {metrics.settling_time_s:.3f} s",
            flush=True,
        )
        return found

    before = gains_of(robot, options.motor)
    try:
        badness(None)
        best, least = search(badness, gains, options.tries)
        after = set_gains(robot, options.motor, best)
    except BaseException:
        set_gains(robot, options.motor, before)
        raise
    print(f"best, with score {least:.3f}; in force until rc10d restarts. For the configuration:")
    print(after.yaml)


def main() -> None:
    """Runs the example."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("robot", help="robot: in the daemon's configuration")
    parser.add_argument("motor", help="name of one of its motors; it turns")
    parser.add_argument("--current", type=float, default=1.0, help="of the first pulse, A (1)")
    parser.add_argument("--rpm", type=float, default=60.0, help="of the steps (60)")
    parser.add_argument("--time-constant", type=float, default=0.03, help="wanted, s (0.03)")
    parser.add_argument("--seconds", type=float, default=0.8, help="of a step (0.8)")
    parser.add_argument("--tries", type=int, default=12, help="steps to run (12)")
    options = parser.parse_args()
    with rc10.connect(options.robot, client="pid-tuning", at_end="disable") as robot:
        robot.wait_for_state()
        robot.enable(options.motor)
        _active(robot, options.motor)
        tune(robot, options)


def _active(robot: rc10.Robot, motor: str) -> None:
    while robot.wait_for_state().motor(motor).status is not rc10.MotorStatus.ACTIVE:
        pass


if __name__ == "__main__":
    # They interrupt it as Ctrl-C does, so that the gains are put back.
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.default_int_handler)
    try:
        main()
    except (rc10.Rc10Error, ValueError) as error:
        raise SystemExit(f"pid_tuning: {error}") from None
