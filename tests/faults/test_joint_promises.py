"""A joint acts for nobody no longer than its time, and homes to a stop and nothing else."""
# run-guest: --timeout 900

from __future__ import annotations

import contextlib
import time
from typing import TYPE_CHECKING

from faultrig import FRONT, break_drive, nothing, proven, robot_with
from faulty_drives import Fault
from module_rig import until
from rig import MS, currents

import rc10

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from faultrig import Witness

LEFT = 1
ACTIVE = rc10.MotorStatus.ACTIVE
HOMING_FAILED = 3  # a joint's state


@contextlib.contextmanager
def held_by_a_joint(tmp_path: Path) -> Iterator[tuple[rc10.Robot, Witness, int]]:
    """A load, brought to its place by a client that has just fallen silent; since when, in ns."""
    joint = (
        "modules:\n"
        "  - {name: lift, type: joint, motor: left, max_velocity_deg_s: 90,\n"
        "     max_acceleration_deg_s2: 360, on_silence: hold, silence_max_s: 1}\n"
    )
    with robot_with(tmp_path, more=joint) as (_, robot, log):
        robot.enable()
        break_drive(LEFT, Fault.PUSHED, 100)
        lift = robot.module("lift")
        start_ns = time.time_ns()
        for t_s in robot.rate(100):
            if t_s >= 0.5:
                break
            lift.send(angle_deg=30.0, validity_ms=40)
        silent_ns = time.time_ns()
        log.driven(start_ns, silent_ns, "left", validity_ms=1060)
        yield robot, log, silent_ns


def test_a_module_acts_for_nobody_no_longer_than_its_time(tmp_path: Path) -> None:
    with held_by_a_joint(tmp_path) as (robot, log, silent_ns):
        until(robot, lambda: robot.motor("left").acting is rc10.Acting.NOTHING, "let go")
        held = [f for f in log.frames(FRONT, silent_ns + 500 * MS) if currents(f)[0]]
        assert held, "it held its place against the load"
        log.check()
        proven(
            "the client of a `joint` falls silent, `on_silence: hold`, `silence_max_s: 1`",
            "holds for that time, then `on_timeout`",
            silent_ns,
            log.last_torque_ns("left"),
            1060,
        )


def test_a_joint_holds_on_while_any_client_is_heard(tmp_path: Path) -> None:
    with held_by_a_joint(tmp_path) as (robot, log, silent_ns):
        for t_s in robot.rate(100):
            if t_s >= 3.0:
                break
            robot.command({"right": rc10.velocity_rpm(20)}, validity_ms=40)
        log.driven(silent_ns, time.time_ns(), "left", "right", validity_ms=1060)
        assert robot.wait_for_state(1.0).motors["left"].status is ACTIVE
        assert currents(log.frames(FRONT)[-1])[0] != 0, "it holds its place against the load"
        log.check()
        nothing("the same, while another motor is commanded", "holds on")


def test_homing_that_finds_its_stop_stops_nothing(tmp_path: Path) -> None:
    joint = (
        "modules:\n"
        "  - {name: lift, type: joint, motor: left, homing: stop, homing_timeout_s: 20,\n"
        "     max_velocity_deg_s: 90, max_acceleration_deg_s2: 360, on_silence: hold}\n"
    )
    unknown = {"id: 1, zero: power_on, current_limit_a: 10}": "id: 1, current_limit_a: 10}"}
    with robot_with(tmp_path, unknown, joint) as (_, robot, log):
        robot.enable()
        lift = robot.module("lift")
        start_ns = time.time_ns()
        break_drive(LEFT, Fault.WALL, -40)
        for t_s in robot.rate(100):
            lift.send(home=1)
            if t_s > 1.0 and lift.state["homed"] == 1.0:
                break
            assert t_s < 20.0, lift.state
        log.driven(start_ns, time.time_ns(), "left", validity_ms=200)
        left = robot.wait_for_state(1.0).motors["left"]
        assert left.zeroed
        assert left.status is ACTIVE
        log.check()
        nothing("homing that reaches its stop twice", "homed; nothing stops")


def test_homing_takes_no_balance_for_the_stop(tmp_path: Path) -> None:
    joint = (
        "modules:\n"
        "  - {name: lift, type: joint, motor: left, homing: stop, homing_timeout_s: 4,\n"
        "     max_velocity_deg_s: 90, max_acceleration_deg_s2: 360, on_silence: hold}\n"
    )
    unknown = {"id: 1, zero: power_on, current_limit_a: 10}": "id: 1, current_limit_a: 10}"}
    with robot_with(tmp_path, unknown, joint) as (_, robot, log):
        robot.enable()
        lift = robot.module("lift")
        start_ns = time.time_ns()
        # At 5 rpm towards the stop it stands still where the load eats 0.9 of its 1 A: in mid-air.
        break_drive(LEFT, Fault.PUSHED, 27)
        stood = 0
        for t_s in robot.rate(100):
            lift.send(home=1)
            left = robot.motor("left")
            stood += abs(left.velocity_rpm) < 1 and abs(left.current_a) > 0.7
            if t_s > 1.0 and lift.state["state"] == HOMING_FAILED:
                break
            assert t_s < 10.0, lift.state
        log.driven(start_ns, time.time_ns(), "left", validity_ms=200)
        assert stood >= 15, "of 100 a second: it pushed in vain"
        assert lift.state["homed"] == 0.0
        assert not robot.wait_for_state(1.0).motors["left"].zeroed
        log.check()
        nothing("homing against a load that balances its current", "it fails; no reference")
