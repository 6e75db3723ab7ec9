"""A robot program for mypy: right, but for the lines that say so; those must be found."""

from __future__ import annotations

import rc10
from rc10.lcm_types import command_t


def main(robot_name: str) -> float:
    with rc10.connect(robot_name, client="typed-program") as robot:
        robot.wait_for_state()
        robot.enable("wheel")
        robot.command(wheel=rc10.velocity_rpm(60))
        robot.command(wheel=60)  # type: ignore[arg-type]
        speed: str = robot.motor("wheel").velocity_rpm  # type: ignore[assignment]
        message = command_t()
        message.client = speed
        message.utime = "now"  # type: ignore[assignment]
        return robot.motor("wheel").velocity_rpm
