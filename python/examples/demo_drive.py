"""Drives the robot of config/demo.yaml: what scripts/demo.sh shows.

The wheels of a mecanum base go round in a circle, the gimbal looks around, the feeder steps:

    python demo_drive.py
"""

from __future__ import annotations

import argparse
import contextlib
import math
import signal
from collections import defaultdict

import rc10

CIRCLE_RPM = 120.0
CIRCLE_S = 8.0
LOOK_S = 6.0
FEED_RPM = 60.0
FEED_S = 1.0
# Errors count once the start is over.
START_S = 1.0

UNITS = {rc10.Mode.VELOCITY: "rpm", rc10.Mode.ANGLE: "deg"}


def targets(t_s: float) -> dict[str, rc10.Setpoint]:
    """Returns where every motor should be at `t_s`."""
    # The base moves in all directions, one after the other, without turning.
    forward = CIRCLE_RPM * math.cos(2 * math.pi * t_s / CIRCLE_S)
    left = CIRCLE_RPM * math.sin(2 * math.pi * t_s / CIRCLE_S)
    look = 2 * math.pi * t_s / LOOK_S
    yaw_deg_per_s = 60.0 * 2 * math.pi / LOOK_S * math.cos(look)
    # One ball each time, then a pause.
    feed = max(0.0, math.sin(2 * math.pi * t_s / FEED_S))
    return {
        "front_left": rc10.velocity_rpm(forward - left),
        "front_right": rc10.velocity_rpm(forward + left),
        "rear_left": rc10.velocity_rpm(forward + left),
        "rear_right": rc10.velocity_rpm(forward - left),
        "yaw": rc10.angle_deg(90.0 + 60.0 * math.sin(look), velocity_ff_rpm=yaw_deg_per_s / 6.0),
        "pitch": rc10.angle_deg(20.0 + 15.0 * math.sin(2 * look)),
        "feeder": rc10.velocity_rpm(FEED_RPM * feed),
    }


def error_of(motor: rc10.MotorState) -> float:
    """Returns target minus measured, in the unit of the mode."""
    if motor.mode is rc10.Mode.ANGLE:
        return (motor.target - motor.angle_deg + 180.0) % 360.0 - 180.0
    return motor.target - motor.velocity_rpm


def drive(robot: rc10.Robot, seconds: float, errors: dict[str, list[float]]) -> None:
    """Runs the show, and notes each motor's error at every command."""
    for t_s in robot.rate(100):
        if t_s > seconds:
            break
        robot.command(targets(t_s))
        for name, motor in robot.state.motors.items():
            if t_s > START_S and motor.mode in UNITS:
                errors[f"{name:12} %6.2f {UNITS[motor.mode]}"].append(error_of(motor))


def main() -> None:
    """Runs the example."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robot", default="demo", help="robot: in the configuration (demo)")
    parser.add_argument("--seconds", type=float, default=math.inf, help="how long (until Ctrl-C)")
    options = parser.parse_args()
    # Like Ctrl-C: leaving the `with` statement lets go of the motors.
    signal.signal(signal.SIGTERM, signal.default_int_handler)

    with rc10.connect(options.robot, client="demo-drive", at_end="disable") as robot:
        robot.wait_for_state()
        robot.enable()
        print("enabled", flush=True)
        errors: dict[str, list[float]] = defaultdict(list)
        with contextlib.suppress(KeyboardInterrupt):
            drive(robot, options.seconds, errors)
    if errors:
        print("followed their targets within (rms)")
    for line, values in errors.items():
        print("  " + line % math.sqrt(sum(value * value for value in values) / len(values)))


if __name__ == "__main__":
    try:
        main()
    except rc10.Rc10Error as error:
        raise SystemExit(f"demo_drive: {error}") from None
    except KeyboardInterrupt:
        pass
