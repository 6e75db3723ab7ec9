"""Helpers of the tests of modules: a robot from its file, and waiting while receiving."""

from __future__ import annotations

import contextlib
import re
import time
from dataclasses import replace
from typing import TYPE_CHECKING

from rig import client, daemon, wait_status

import rc10
from rc10.fakes import M3508, FakeMotor, MotorSpec

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from guestlib import Proc

# A robot of 20 kg on four wheels of 76 mm: its share of the mass, at each wheel, and rollers.
WHEEL = replace(M3508, inertia_kg_m2=0.010 + 20.0 / 4.0 * 0.076**2)


def wheel(number: int, friction_nm: float) -> FakeMotor:
    """A M3508 that drives a quarter of the robot."""
    return FakeMotor(MotorSpec(replace(WHEEL, coulomb_nm=friction_nm), number))


@contextlib.contextmanager
def robot_of(folder: Path, name: str, text: str) -> Iterator[tuple[Proc, rc10.Robot]]:
    """rc10d with this file, and a client that is called planner, when every motor is READY."""
    config = folder / f"{name}.yaml"
    config.write_text(
        f"robot: {name}\nrealtime: preferred\nblackbox_mib: 0\nlcm: {{state_hz: 50}}\n"
        + text.replace("FOLDER", str(folder))
    )
    with daemon(config) as process, client("planner", robot_name=name) as robot:
        _, modules = text.split("modules:")
        for module in re.findall(r"- \{?name: (\w+)", modules):
            robot.module(module)  # from now on its states are received
        wait_status(robot, rc10.MotorStatus.READY)
        robot.wait_for_state()
        yield process, robot


def until(
    robot: rc10.Robot,
    wanted: Callable[[], bool],
    what: str,
    *,
    timeout_s: float = 5.0,
    each: Callable[[], object] = lambda: None,
) -> None:
    """Receives at 100 Hz, and does `each`, until it is as wanted."""
    deadline = time.monotonic() + timeout_s
    for _ in robot.rate(100):
        if wanted():
            return
        if time.monotonic() > deadline:
            raise TimeoutError(f"not {what} in {timeout_s} s")
        each()


def let_pass(robot: rc10.Robot, seconds: float) -> None:
    """Receives for so long: the subject is that nothing happens, or how long something lasts."""
    for t_s in robot.rate(100):
        if t_s >= seconds:
            return
