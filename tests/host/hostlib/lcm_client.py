"""A client in a process of its own: enables the wheel, and turns it until it is killed."""

from __future__ import annotations

import sys

import rc10

with rc10.connect("host", client="turner") as robot:
    robot.wait_for_state()
    robot.enable("wheel")
    for _ in robot.rate(100):
        robot.command(wheel=rc10.velocity_rpm(float(sys.argv[1])))
