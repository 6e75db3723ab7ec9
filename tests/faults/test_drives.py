"""Drives that fall silent, freeze, lie, slip, reboot or overheat."""
# run-guest: --timeout 900

from __future__ import annotations

import struct
import threading
import time
from pathlib import Path

import pytest
from faultrig import (
    CONFIG,
    FRONT,
    Witness,
    break_drive,
    client,
    corrupt,
    daemon,
    drive,
    drives,
    drives_behind_gateway,
    proven,
    robot_under_test,
    witness,
)
from faulty_drives import Fault
from guestlib import can_frame, can_socket
from rig import wait_status

import rc10

LEFT, RIGHT = 1, 2
OFFLINE, FAULT = rc10.MotorStatus.OFFLINE, rc10.MotorStatus.FAULT


def drive_until(
    robot: rc10.Robot,
    log: Witness,
    name: str,
    status: rc10.MotorStatus,
    target: rc10.Setpoint,
    timeout_s: float = 3.0,
) -> None:
    """Commands `name` and, beside it, `right`, until `name` has the status."""
    start_ns = time.time_ns()
    beside = {} if name == "right" else {"right": rc10.velocity_rpm(30)}
    for t_s in robot.rate(100):
        robot.command({name: target, **beside}, validity_ms=40)
        if robot.state is not None and robot.state.motors[name].status is status:
            break
        assert t_s < timeout_s, f"never {status}: {robot.state}"
    log.driven(start_ns, time.time_ns(), name, *beside)


@pytest.mark.parametrize(
    ("kind", "argument", "words", "status", "code", "target", "within"),
    [
        (Fault.SILENT, 0, "drive falls silent", OFFLINE, 0, rc10.velocity_rpm(60), 22),
        (Fault.SHORT, 0, "feedback frames of 7 bytes", OFFLINE, 0, rc10.velocity_rpm(60), 22),
        (Fault.FROZEN, 0, "the same frame for ever", FAULT, 6, rc10.velocity_rpm(200), 230),
        (Fault.SLIP, 400, "encoder jumps by 0.4 rotor turns", FAULT, 5, rc10.velocity_rpm(30), 3),
        (Fault.HOT, 101, "winding at 101 C", FAULT, 2, rc10.velocity_rpm(60), 3),
    ],
)
def test_a_broken_drive_is_noticed_and_rests(
    kind: Fault,
    argument: int,
    words: str,
    status: rc10.MotorStatus,
    code: int,
    target: rc10.Setpoint,
    within: int,
) -> None:
    with robot_under_test() as (_, robot, log):
        start_ns = time.time_ns()
        for t_s in robot.rate(100):
            if t_s >= 0.5:
                break
            robot.command(left=rc10.velocity_rpm(30), right=rc10.velocity_rpm(30), validity_ms=40)
        log.driven(start_ns, time.time_ns(), "left", "right")
        break_drive(LEFT, kind, argument)
        broken_ns = time.time_ns()
        drive_until(robot, log, "left", status, target)
        assert robot.motor("left").fault == code
        assert robot.motor("right").status is rc10.MotorStatus.ACTIVE
        log.check()
        last_ns = log.last_torque_ns("left")
        reaction = "OFFLINE, rest" if status is OFFLINE else f"FAULT {code}, rest"
        proven(words, reaction, broken_ns, last_ns, within)
        # It stays so, whatever is asked.
        with pytest.raises(rc10.RequestFailed):
            robot.enable(["left"])


@pytest.mark.parametrize(
    ("flipped", "words", "status", "code", "within"),
    [
        ("1000000000000000", "a bit of the angle flipped on the way", FAULT, 5, 5),
        ("8000000000000000", "angles that do not exist, flipped on the way", OFFLINE, 0, 24),
        ("0000000000008000", "a bit of the temperature flipped on the way", FAULT, 2, 5),
    ],
)
def test_frames_corrupted_by_a_gateway(
    flipped: str, words: str, status: rc10.MotorStatus, code: int, within: int
) -> None:
    with drives_behind_gateway(), witness() as log, daemon(), client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        drive(robot, log, 0.5, left=rc10.velocity_rpm(30), right=rc10.velocity_rpm(30))
        start_ns = time.time_ns()
        robot.command(left=rc10.velocity_rpm(30), right=rc10.velocity_rpm(30), validity_ms=40)
        log.driven(start_ns, time.time_ns(), "left", "right")
        corrupt(0x201, flipped)
        corrupted_ns = time.time_ns()
        drive_until(robot, log, "left", status, rc10.velocity_rpm(30))
        assert robot.motor("left").fault == code
        assert robot.motor("right").status is rc10.MotorStatus.ACTIVE
        log.check()
        reaction = "OFFLINE, rest" if status is OFFLINE else f"FAULT {code}, rest"
        proven(words, reaction, corrupted_ns, log.last_torque_ns("left"), within)


def test_a_drive_that_reboots_in_motion() -> None:
    with robot_under_test() as (_, robot, log):
        start_ns = time.time_ns()
        lost = False
        for t_s in robot.rate(100):
            if t_s >= 1.0:
                break
            if t_s >= 0.3 and not lost:
                break_drive(LEFT, Fault.REBOOT, 300)
                rebooted_ns, lost = time.time_ns(), True
            robot.command(left=rc10.velocity_rpm(60), right=rc10.velocity_rpm(30), validity_ms=40)
        log.driven(start_ns, time.time_ns(), "right")
        log.driven(start_ns, rebooted_ns, "left", validity_ms=22)
        motor = robot.wait_for_state(1.0).motors["left"]
        assert motor.status is rc10.MotorStatus.READY  # and not ACTIVE
        assert not motor.zeroed
        log.check()
        proven(
            "drive reboots in motion",
            "OFFLINE, then READY without reference; never ACTIVE by itself",
            rebooted_ns,
            log.last_torque_ns("left"),
            22,
        )


def test_an_encoder_that_counts_backwards() -> None:
    with drives(), witness() as log, daemon(), client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        break_drive(LEFT, Fault.REVERSED)
        time.sleep(0.1)
        robot.enable()
        begun_ns = time.time_ns()
        drive_until(robot, log, "left", FAULT, rc10.velocity_rpm(60))
        assert robot.motor("left").fault == 7
        log.check()
        proven(
            "encoder counts backwards", "FAULT 7, rest", begun_ns, log.last_torque_ns("left"), 400
        )


def test_two_drives_with_one_id() -> None:
    with robot_under_test() as (_, robot, log):
        with can_socket(FRONT) as other:
            stop = threading.Event()

            def talk() -> None:
                while not stop.is_set():
                    other.send(can_frame(0x201, struct.pack(">HhhBB", 4096, 0, 0, 25, 0)))
                    time.sleep(0.001)

            begun_ns = time.time_ns()
            thread = threading.Thread(target=talk)
            thread.start()
            try:
                drive_until(robot, log, "left", FAULT, rc10.velocity_rpm(30))
            finally:
                stop.set()
                thread.join()
        assert robot.motor("left").fault == 5
        log.check()
        proven(
            "a second drive answers with the id",
            "FAULT 5, rest",
            begun_ns,
            max(begun_ns, log.last_torque_ns("left")),
            30,
        )


def configured(tmp_path: Path, keys: dict[str, str]) -> Path:
    """The robot with other keys for `left`."""
    more = ", ".join(f"{key}: {value}" for key, value in keys.items())
    left = "{name: left, model: M3508, id: 1, zero: power_on, "
    text = CONFIG.read_text()
    assert f"{left}current_limit_a: 10}}" in text
    path = tmp_path / "robot.yaml"
    path.write_text(text.replace(f"{left}current_limit_a: 10}}", f"{left}{more}}}"))
    return path


@pytest.mark.parametrize(
    ("keys", "kind", "target", "words", "code", "within"),
    [
        (
            {"stall_ms": "200", "current_limit_a": "2"},
            Fault.STALLED,
            rc10.velocity_rpm(200),
            "shaft blocked",
            3,
            400,
        ),
        (
            {"overspeed_rpm": "90", "velocity_limit_rpm": "80", "current_limit_a": "10"},
            Fault.NONE,
            rc10.current_a(5),
            "faster than overspeed_rpm",
            1,
            400,
        ),
        (
            {"angle_slew_deg_per_s": "180", "following_error_deg": "20", "current_limit_a": "10"},
            Fault.STALLED,
            rc10.total_angle_deg(900),
            "does not follow its angle",
            4,
            600,
        ),
    ],
)
def test_a_limit_that_is_configured(
    tmp_path: Path,
    keys: dict[str, str],
    kind: Fault,
    target: rc10.Setpoint,
    words: str,
    code: int,
    within: int,
) -> None:
    path = configured(tmp_path, keys)
    with drives(), witness() as log, daemon(path), client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        break_drive(LEFT, kind)
        begun_ns = time.time_ns()
        drive_until(robot, log, "left", FAULT, target)
        assert robot.motor("left").fault == code
        log.check()
        proven(words, f"FAULT {code}, rest", begun_ns, log.last_torque_ns("left"), within)


def test_a_gap_that_loses_the_reference() -> None:
    with robot_under_test() as (_, robot, log):
        start_ns = time.time_ns()
        for t_s in robot.rate(100):
            if t_s >= 0.3:
                break
            robot.command(left=rc10.velocity_rpm(100), validity_ms=40)
        break_drive(LEFT, Fault.REBOOT, 15)  # shorter than the feedback time-out
        for _ in range(5):
            time.sleep(0.01)
            robot.command(left=rc10.total_angle_deg(0.0), validity_ms=40)
        lost_ns = time.time_ns()
        log.driven(start_ns, lost_ns, "left")
        motor = robot.wait_for_state(1.0).motors["left"]
        assert motor.status is rc10.MotorStatus.ACTIVE
        assert not motor.zeroed
        log.check()
        proven(
            "feedback gap that may hide a turn of an M3508",
            "angle targets are refused; the motor stays ACTIVE",
            None,
            None,
            0,
        )


@pytest.mark.parametrize("on_return", ["request", "rearm_at_rest"])
def test_the_power_of_a_bus_is_lost_and_returns(tmp_path: Path, on_return: str) -> None:
    path = tmp_path / "robot.yaml"
    groups = f"groups:\n  - {{name: drive, motors: [left, right, other], on_return: {on_return}}}\n"
    path.write_text(CONFIG.read_text() + groups)
    with drives(), witness() as log, daemon(path), client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        start_ns = time.time_ns()
        lost = False
        for t_s in robot.rate(100):
            if t_s >= (20.0 if on_return == "rearm_at_rest" else 3.0) or (
                lost and t_s > 2.0 and robot.motor("other").status is rc10.MotorStatus.ACTIVE
            ):
                break
            if t_s >= 0.3 and not lost:
                for motor_id in (1, 2, 3):
                    break_drive(motor_id, Fault.REBOOT, 300)
                lost_ns, lost = time.time_ns(), True
            if not lost:
                robot.command(
                    left=rc10.velocity_rpm(10),
                    right=rc10.velocity_rpm(10),
                    other=rc10.velocity_rpm(10),
                    validity_ms=40,
                )
        log.driven(start_ns, lost_ns, "left", "right", "other", validity_ms=40)
        wanted = rc10.MotorStatus.ACTIVE if on_return == "rearm_at_rest" else rc10.MotorStatus.READY
        for name in ("left", "right", "other"):
            assert robot.motor(name).status is wanted, name
        log.check()
        last_ns = max(log.last_torque_ns(name) for name in ("left", "right", "other"))
        reaction = "the group rests; " + (
            "enabled again once all stand still"
            if on_return == "rearm_at_rest"
            else "waits for a request"
        )
        proven(
            f"power of a bus lost for 300 ms, on_return: {on_return}",
            reaction,
            lost_ns,
            last_ns,
            42,
        )
