"""The robot of config/vcan_mixed.yaml: fake drives on vcan0, the real rc10d, a client."""

from __future__ import annotations

import contextlib
import os
import struct
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from guestlib import Frame, Proc, run

import rc10

if TYPE_CHECKING:
    from collections.abc import Iterator

REPO = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ["RC10_BUILD"])
BIN = BUILD / "bin"
CONFIG = REPO / "config" / "vcan_mixed.yaml"
ROBOT = "vcan_mixed"
MOTORS = ("left", "right", "feeder", "yaw", "pitch")

# left, right and feeder are slots 1 to 3 of 0x200; yaw and pitch slots 1 and 2 of 0x2FE.
C6XX_COMMAND = 0x200
GM6020_COMMAND = 0x2FE
COMMAND_IDS = (C6XX_COMMAND, GM6020_COMMAND)

MS = 1_000_000


@contextlib.contextmanager
def fakes() -> Iterator[Proc]:
    """Python-can fake drives, written from the protocol alone."""
    command = [sys.executable, "-m", "rc10.fakes", "--interface", "socketcan", "--channel", "vcan0"]
    for motor in ("M3508:1", "M3508:2", "M2006:3", "GM6020:5", "GM6020:6"):
        command += ["--motor", motor]
    with Proc(*command) as process:
        process.wait_line("^ready", 30.0)
        yield process


@contextlib.contextmanager
def daemon(config: Path = CONFIG) -> Iterator[Proc]:
    """The real rc10d, as a user starts it."""
    with Proc(BIN / "rc10d", "-c", config) as process:
        process.wait_line("robot '.*' runs", 10.0)
        yield process


def receiving(reader: str) -> Path:
    """The configuration with this reader of the CAN sockets: `tick` or `thread`."""
    config = Path(f"/tmp/receive_{reader}.yaml")
    config.write_text(f"{CONFIG.read_text()}\nreceive: {reader}\n")
    return config


@contextlib.contextmanager
def client(
    name: str = "test", priority: int = 0, *, robot_name: str = ROBOT
) -> Iterator[rc10.Robot]:
    """A client on LCM that has seen the robot's state."""
    with rc10.connect(robot_name, client=name, priority=priority) as robot:
        robot.wait_for_state(10.0)
        yield robot


def wait_status(
    robot: rc10.Robot, status: rc10.MotorStatus, *names: str, timeout_s: float = 5.0
) -> None:
    """Waits until these motors, or without names all, have the status."""
    deadline = time.monotonic() + timeout_s
    while True:
        state = robot.wait_for_state(timeout_s)
        if all(state.motors[name].status is status for name in names or state.motors):
            return
        if time.monotonic() > deadline:
            raise TimeoutError(f"not {status}: {state.motors}")


def gateway_pid() -> int:
    """The process id of the one rc10-lcm that runs."""
    return int(run("pgrep", "-x", "rc10-lcm").split()[0])


def next_diagnostics(robot: rc10.Robot) -> rc10.Diagnostics:
    """Waits for diagnostics that are newer than the call."""
    since_us = time.monotonic_ns() // 1000
    for _ in robot.rate(20):
        with contextlib.suppress(rc10.NotReceived):
            if robot.diagnostics.mono_us > since_us:
                return robot.diagnostics
    raise AssertionError("rate() ended")


@contextlib.contextmanager
def enabled_robot(config: Path = CONFIG) -> Iterator[tuple[Proc, rc10.Robot]]:
    """Fakes, daemon and a client, with every motor ACTIVE."""
    with fakes(), daemon(config) as process, client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        yield process, robot


def drive(robot: rc10.Robot, seconds: float, **targets: rc10.Setpoint) -> list[rc10.RobotState]:
    """Commands at 100 Hz, as a control program does, and returns every state seen."""
    states: list[rc10.RobotState] = []
    for t_s in robot.rate(100):
        if t_s >= seconds:
            break
        robot.command(targets)
        if robot.state is not None and (not states or states[-1].tick != robot.state.tick):
            states.append(robot.state)
    return states


def currents(frame: Frame) -> tuple[int, int, int, int]:
    """The four slots of a command frame, raw."""
    return struct.unpack(">4h", frame.data)


def commands(frames: list[Frame], number: int) -> list[Frame]:
    """Frames of one command id."""
    return [frame for frame in frames if frame.id == number and not frame.ext and not frame.error]
