"""The same again: two guests that run this file record the same bus, frame by frame."""
# run-twice: bus.log

from __future__ import annotations

import os
from pathlib import Path

from guestlib import Candump
from rig import client, daemon, drive, fakes, wait_status

import rc10


def test_a_scripted_run_is_recorded() -> None:
    with Candump("vcan0") as bus:
        with fakes(), daemon(), client() as robot:
            wait_status(robot, rc10.MotorStatus.READY)
            robot.enable()
            drive(robot, 1.0, left=rc10.velocity_rpm(120), yaw=rc10.angle_deg(200))
            drive(robot, 1.0, left=rc10.velocity_rpm(-50), feeder=rc10.total_angle_deg(90))
        bus.stop()
    frames = bus.frames()
    assert len(frames) > 10_000
    start_ns = frames[0].t_ns
    lines = [f"{frame.t_ns - start_ns} {frame.id:X} {frame.data.hex()}\n" for frame in frames]
    Path(os.environ["RC10_SCRATCH"], "bus.log").write_text("".join(lines))
