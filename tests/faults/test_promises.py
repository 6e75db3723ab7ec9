"""Torque that nobody asked for: rest, foreign frames, groups, e-stops, fields, the turn."""
# run-guest: --timeout 1200

from __future__ import annotations

import contextlib
import socket
import struct
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from faultrig import (
    FRONT,
    TICK_NS,
    Stranger,
    Witness,
    break_drive,
    client,
    ctl,
    daemon,
    drive,
    drives,
    nothing,
    proven,
    robot_under_test,
    robot_with,
    witness,
)
from faulty_drives import Fault
from guestlib import can_frame, can_socket, run, wait_for
from module_rig import let_pass
from rig import MS, currents, next_diagnostics, wait_status

import rc10
from rc10.lcm_types import request_t

if TYPE_CHECKING:
    from collections.abc import Callable


LEFT, RIGHT, ARM = 1, 2, 3
TOTAL_ANGLE = 4  # of command_t
ACTIVE, READY = rc10.MotorStatus.ACTIVE, rc10.MotorStatus.READY
OFFLINE, FAULT = rc10.MotorStatus.OFFLINE, rc10.MotorStatus.FAULT
NOT_AT_REST, FOREIGN, STALLED = 8, 9, 3
SETPOINT_SKIPPED = 103  # of EventCode
ARM_KEYS = "on_timeout: brake, on_estop: brake}"


def skipped(robot: rc10.Robot) -> int:
    """Setpoints that rc10d did not follow."""
    return int(dict(next_diagnostics(robot).refusals).get("setpoint skipped", 0))


def has(robot: rc10.Robot, name: str, status: rc10.MotorStatus) -> Callable[[], bool]:
    return lambda: robot.wait_for_state(1.0).motors[name].status is status


# ---- Rest, and foreign frames


def test_a_drive_that_does_not_rest(tmp_path: Path) -> None:
    groups = "groups:\n  - {name: drive, motors: [left, right]}\n"
    with robot_with(tmp_path, more=groups) as (_, robot, log):
        robot.enable()
        # It turns slower than it wants to: against a wall, with all that it has.
        break_drive(LEFT, Fault.STALLED)
        drive(robot, log, 0.4, left=rc10.velocity_rpm(200))
        break_drive(LEFT, Fault.DEAF, 1)
        start_ns = time.time_ns()
        drive(robot, log, 0.4, right=rc10.velocity_rpm(30), other=rc10.velocity_rpm(30))
        wait_for(has(robot, "left", FAULT), 2.0)
        assert robot.motor("left").fault == NOT_AT_REST
        assert robot.motor("right").status is READY
        assert robot.motor("other").status is ACTIVE
        log.check()
        proven(
            "a drive goes on with its last command",
            "FAULT 8; its group rests, the others go on",
            start_ns,
            log.last_torque_ns("right"),
            200,
        )


def test_a_drive_that_does_not_rest_may_stop_the_robot(tmp_path: Path) -> None:
    with robot_with(tmp_path, more="on_unrest: estop\n") as (_, robot, log):
        robot.enable()
        break_drive(LEFT, Fault.STALLED)
        drive(robot, log, 0.3, left=rc10.velocity_rpm(200))
        break_drive(LEFT, Fault.DEAF, 1)
        start_ns = time.time_ns()
        drive(robot, log, 0.4, other=rc10.velocity_rpm(30))
        state = robot.wait_for_state(1.0)
        assert state.estopped
        assert state.stop_cause is rc10.StopCause.FAULT
        log.check()
        proven(
            "the same with `on_unrest: estop`",
            "FAULT 8; e-stop",
            start_ns,
            log.last_torque_ns("other"),
            200,
        )


def test_somebody_else_commands_a_drive(tmp_path: Path) -> None:
    with robot_with(tmp_path) as (_, robot, log), can_socket(FRONT) as stranger:

        def say(times: int, current: int, spacing_s: float) -> None:
            for _ in range(times):
                stranger.send(can_frame(0x200, struct.pack(">4h", current, 0, 0, 0)))
                time.sleep(spacing_s)

        robot.enable()
        say(2, 100, 0.02)
        time.sleep(0.2)
        say(5, 100, 0.06)
        assert robot.wait_for_state(1.0).motors["left"].status is ACTIVE
        nothing("foreign commands, never three within 100 ms", "told; the motors go on")
        say(40, 0, 0.002)
        assert robot.wait_for_state(1.0).motors["left"].status is ACTIVE
        nothing("foreign rest frames, as of rc10-stop", "told; the motors go on")
        run("cangen", FRONT, "-I", "200", "-R", "-L", "8", "-n", "40", "-g", "2")
        run("cangen", FRONT, "-I", "205", "-L", "8", "-n", "40", "-g", "2")
        assert robot.wait_for_state(1.0).motors["left"].status is ACTIVE
        nothing("a tool that asks; frames of other ids", "the motors go on")
        start_ns = time.time_ns()
        for t_s in robot.rate(100):
            if t_s >= 0.2:
                break
            robot.command(left=rc10.velocity_rpm(60), other=rc10.velocity_rpm(30), validity_ms=40)
        foreign_ns = time.time_ns()
        say(3, 100, 0.001)
        log.driven(start_ns, foreign_ns + 5 * MS, "left", "other")
        drive(robot, log, 0.3, other=rc10.velocity_rpm(30))
        state = robot.wait_for_state(1.0)
        for name in ("left", "right", "arm"):
            assert state.motors[name].status is FAULT, name
            assert state.motors[name].fault == FOREIGN
        assert state.motors["other"].status is ACTIVE
        ours = log.frames(FRONT, foreign_ns + 20 * MS)
        assert len(ours) > 250
        assert not any(any(currents(f)) for f in ours)
        torque = [f.t_ns for f in log.frames(FRONT) if currents(f)[0] not in (0, 100)]
        proven(
            "three foreign commands within 100 ms",
            "FAULT 9 of the motors of that id; rest goes on being sent; the other bus goes on",
            foreign_ns,
            max(torque),
            6,
        )


# ---- Groups


def test_groups_are_all_or_none(tmp_path: Path) -> None:
    groups = "groups:\n  - {name: drive, motors: [left, right, other, arm], together: true}\n"
    optional = {"{name: arm, ": "{name: arm, optional: true, "}
    with robot_with(tmp_path, optional, groups) as (_, robot, log):
        with pytest.raises(rc10.RequestFailed):
            robot.enable(["left", "other"])
        assert all(m.status is READY for m in robot.wait_for_state(1.0).motors.values())
        nothing("some of a group are enabled, `together: true`", "refused; none is enabled")

        break_drive(RIGHT, Fault.SILENT)
        wait_for(has(robot, "right", OFFLINE), 2.0)
        with pytest.raises(rc10.RequestFailed):
            robot.enable()
        assert robot.wait_for_state(1.0).motors["left"].status is READY
        nothing("a group is enabled while a member is silent", "refused; none is enabled")

        break_drive(RIGHT, Fault.NONE)
        wait_for(has(robot, "right", READY), 2.0)
        robot.enable()
        moving = dict.fromkeys(("left", "right", "other"), rc10.velocity_rpm(40))
        drive(robot, log, 0.3, **moving)
        break_drive(ARM, Fault.SILENT)
        drive(robot, log, 0.2, **moving)
        assert robot.motor("arm").status is OFFLINE
        assert robot.motor("left").status is ACTIVE
        nothing("an `optional` member of a group is lost", "the others go on")

        asked_ns = _during(robot, log, moving, lambda: ctl("disable", "right"))
        assert {robot.motor(name).status for name in moving} == {READY}
        proven(
            "a member of a group is disabled",
            "all rest in that tick",
            asked_ns,
            max(log.last_torque_ns(name) for name in moving),
            40,
        )
        last = [log.last_torque_ns(name) for name in moving]
        assert max(last) - min(last) <= TICK_NS

        break_drive(ARM, Fault.NONE)
        time.sleep(0.3)
        robot.enable()
        lost_ns = _during(robot, log, moving, lambda: break_drive(RIGHT, Fault.SILENT))
        assert {robot.motor(name).status for name in ("left", "other")} == {READY}
        proven(
            "a member of a group falls silent, on another bus than the others",
            "all rest in the tick in which it is OFFLINE",
            lost_ns,
            max(log.last_torque_ns(name) for name in ("left", "other")),
            24,
        )
        log.check()


def _during(
    robot: rc10.Robot,
    log: Witness,
    targets: dict[str, rc10.Setpoint],
    happens: Callable[[], object],
) -> int:
    """Commands on and on while it happens, and for a while after; since when, in ns."""
    start_ns = time.time_ns()
    asked_ns = 0
    for t_s in robot.rate(100):
        if t_s >= 0.5:
            break
        if t_s >= 0.3 and asked_ns == 0:
            asked_ns = time.time_ns()
            happens()
        robot.command(targets, validity_ms=40)
    log.driven(start_ns, time.time_ns(), *targets)
    return asked_ns


# ---- E-stops


def test_an_estop_ends_as_it_should(tmp_path: Path) -> None:
    keys = {
        ARM_KEYS: "on_timeout: brake, on_estop: brake, brake_max_s: 0.5}",
        "{name: left, model: M3508, ": "{name: left, run_down_s: 2, model: M3508, ",
        "{name: right, model: M3508, id: 2, ": "{name: right, model: M3508, id: 2, "
        "on_estop: ramp, ramp_s: 0.3, ",
    }
    with robot_with(tmp_path, keys) as (_, robot, log):
        robot.enable()
        turning = {
            "left": rc10.velocity_rpm(60),
            "right": rc10.velocity_rpm(100),
            "arm": rc10.velocity_rpm(60),
        }
        start_ns = time.time_ns()
        drive(robot, log, 0.5, **turning)
        stopped_ns = time.time_ns()
        robot.estop()
        log.driven(start_ns, stopped_ns + 520 * MS, "right")
        time.sleep(0.3)
        assert robot.wait_for_state(1.0).motors["arm"].acting is rc10.Acting.BRAKE
        time.sleep(0.7)
        state = robot.wait_for_state(1.0)
        assert abs(state.motors["right"].velocity_rpm) < 3
        proven(
            "e-stop with `on_estop: ramp`, `ramp_s: 0.3`",
            "to rest along the ramp, then no torque: at most 0.2 s after it",
            stopped_ns,
            log.last_torque_ns("right"),
            505,
        )
        assert state.motors["arm"].acting is rc10.Acting.DAMP
        nothing("e-stop with `on_estop: brake`, `brake_max_s: 0.5`", "damps after that time")

        everyone = ["left", "right", "arm", "other"]
        with contextlib.suppress(rc10.RequestFailed):
            robot.clear(everyone)
        assert robot.wait_for_state(1.0).estopped
        nothing("`clear` that names every motor", "the e-stop stays")

        _cleared(robot)
        robot.enable()
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
        break_drive(LEFT, Fault.SILENT)
        robot.estop()
        time.sleep(0.2)
        with pytest.raises(rc10.RequestFailed):
            robot.clear()
        assert robot.wait_for_state(1.0).estopped
        time.sleep(2.5)
        robot.clear()
        assert not robot.wait_for_state(1.0).estopped
        nothing(
            "`clear` while a motor that was lost in motion may turn",
            "refused until `run_down_s` is over",
        )
        nothing("the same when `run_down_s` is over, and it is still lost", "the e-stop ends")
        break_drive(LEFT, Fault.NONE)
        wait_for(has(robot, "left", READY), 2.0)
        # Nobody sleeps between the two: they come in one tick. The loser waits in no queue.
        robot.estop()
        wait_for(
            lambda: all(abs(m.velocity_rpm) < 3 for m in robot.wait_for_state(1.0).motors.values()),
            20.0,
        )
        for order in (("clear", "estop"), ("estop", "clear")):
            for what in order:
                _clear_by_lcm() if what == "clear" else _estop_by_datagram()
            time.sleep(0.3)
            assert robot.wait_for_state(1.0).estopped, order
        # The same request alone is heard, and ends it: no message was lost.
        _clear_by_lcm()
        wait_for(lambda: not robot.wait_for_state(1.0).estopped, 1.0)
        nothing("e-stop and `clear` in one tick, in either order", "the e-stop wins")
        log.check()


def acts(robot: rc10.Robot, name: str, what: rc10.Acting) -> Callable[[], bool]:
    return lambda: robot.wait_for_state(1.0).motors[name].acting is what


def test_an_estop_takes_the_place_of_what_acts_already(tmp_path: Path) -> None:
    keys = {
        ARM_KEYS: "on_timeout: brake, on_disable: hold, hold_max_s: 60, on_estop: damp}",
        "{name: left, model: M3508, ": "{name: left, on_estop: brake, brake_max_s: 0.3, "
        "model: M3508, ",
    }
    group = "groups:\n  - {name: drive, motors: [left, right], on_member_offline: stop_group}\n"
    with robot_with(tmp_path, keys, group) as (_, robot, log):
        robot.enable()
        break_drive(ARM, Fault.PUSHED, 20)
        start_ns = time.time_ns()
        drive(robot, log, 0.3, arm=rc10.velocity_rpm(20))
        robot.disable("arm")
        wait_for(acts(robot, "arm", rc10.Acting.HOLD), 2.0)
        stopped_ns = time.time_ns()
        robot.estop()
        wait_for(acts(robot, "arm", rc10.Acting.DAMP), 2.0)
        log.driven(start_ns, time.time_ns(), "arm", validity_ms=60_000)
        assert time.time_ns() - stopped_ns < 1000 * MS, "hold_max_s is a minute"
        nothing(
            "e-stop after a `disable` with `on_disable: hold`, `on_estop: damp`",
            "damps, and holds no more",
        )
        break_drive(ARM, Fault.PUSHED, 0)
        _cleared(robot)
        robot.enable()
        start_ns = time.time_ns()
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
        break_drive(RIGHT, Fault.SILENT)
        wait_for(acts(robot, "left", rc10.Acting.BRAKE), 2.0)
        let_pass(robot, 1.0)
        state = robot.wait_for_state(1.0)
        assert state.motors["left"].acting is rc10.Acting.BRAKE
        assert not state.estopped
        log.driven(start_ns, time.time_ns(), "left")
        nothing("a group stops, `on_estop: brake`, longer than `brake_max_s`", "brakes on")
        log.check()


def _cleared(robot: rc10.Robot) -> None:
    """As soon as all stand still."""

    def done() -> bool:
        with contextlib.suppress(rc10.RequestFailed):
            robot.clear()
        return not robot.wait_for_state(1.0).estopped

    wait_for(done, 20.0, poll_s=0.2)


def _clear_by_lcm() -> None:
    message = request_t()
    message.client, message.operation = "clearer", "clear"
    message.session, message.seq = time.monotonic_ns(), 1
    Stranger().bytes(message.encode(), "faults.v1.request")


def _estop_by_datagram() -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as sender:
        sender.sendto(b"e-stop", "/run/rc10d/faults.estop")


# ---- Fields, and the first targets after enabling


def test_every_field_is_bounded(tmp_path: Path) -> None:
    left, right = (f"id: {number}, zero: power_on, current_limit_a: 10" for number in (1, 2))
    keys = {
        left + "}": left + ", angle_min_deg: -90, angle_max_deg: 90}",
        right + "}": right + ", soft_start_ms: 200}",
    }
    limited_a = 10.0
    with robot_with(tmp_path, keys) as (_, robot, log):
        start_ns = time.time_ns()
        for t_s in robot.rate(100):
            if t_s >= 0.2:
                break
            # As a program in another language would: command() refuses it.
            robot._publish_command({"right": rc10.velocity_rpm(250)}, validity_ms=40)
        enabled_ns = time.time_ns()
        ctl("enable")
        drive(robot, log, 0.3, right=rc10.velocity_rpm(250))
        log.driven(start_ns, enabled_ns, "right")
        first = [f for f in log.frames(FRONT) if currents(f)[1]][:10]
        assert all(abs(currents(f)[1]) < 8192 * 0.25 for f in first), first
        nothing("enabled into a running stream", "comes into force over `soft_start_ms`")

        def pushed(words: str, target: rc10.Setpoint) -> None:
            begun_ns = drive(robot, log, 1.5, left=target)
            angles_deg = robot.wait_for_state(1.0).motors["left"].total_angle_deg
            assert angles_deg < 90 + 6, angles_deg
            late = log.frames(FRONT, begun_ns - 200 * MS)
            assert all(currents(f)[0] <= 820 for f in late), "it pushes on"
            nothing(words, "stops at the limit; nothing pushes on")

        pushed("a velocity beyond a soft limit", rc10.velocity_rpm(100))
        pushed("a current beyond a soft limit", rc10.current_a(3))
        pushed("torque_ff_nm beyond a soft limit", rc10.velocity_rpm(0, torque_ff_nm=2.0))
        pushed(
            "velocity_ff_rpm beyond a soft limit",
            rc10.total_angle_deg(89, velocity_ff_rpm=100.0),
        )
        drive(robot, log, 0.3, right=rc10.velocity_rpm(30, torque_ff_nm=1e30))
        assert max(abs(currents(f)[1]) for f in log.frames(FRONT)) <= 8192 * limited_a / 10
        nothing("torque_ff_nm of 1e30", "within `current_limit_a`")
        log.check()


# ---- Places that no motor reaches, the end of a program, and no reason to stop


def test_places_beyond_all_reach_are_refused() -> None:
    with robot_under_test() as (_, robot, log):
        robot.disable()
        wait_for(has(robot, "left", READY), 2.0)
        before_deg = robot.wait_for_state(1.0).motors["left"].total_angle_deg
        for place in ("1e17", "1e300"):
            assert ctl("zero", "left", place).returncode != 0
        after_deg = robot.wait_for_state(1.0).motors["left"].total_angle_deg
        assert after_deg == pytest.approx(before_deg, abs=1)
        nothing("`zero` at 1e17 deg", "refused")
        robot.enable()
        before = skipped(robot)
        robot.events()
        stranger = Stranger()
        for value in (1e17, -1e300):
            for _ in range(10):
                stranger.command("left", TOTAL_ANGLE, value)
                time.sleep(0.01)
        wait_for(lambda: skipped(robot) == before + 20, 5.0, "all are counted")
        told = [event for event in robot.events() if event.code == SETPOINT_SKIPPED]
        assert told
        assert {event.source for event in told} == {"left"}
        assert log.last_torque_ns("left") == 0
        log.check()
        nothing("an angle target of 1e17 deg", "skipped, counted, told")


def test_the_end_of_a_program_is_a_timeout() -> None:
    with robot_under_test() as (_, robot, log):
        break_drive(ARM, Fault.PUSHED, 20)

        def holds() -> bool:
            state = robot.wait_for_state(1.0).motors["arm"]
            return state.acting is rc10.Acting.BRAKE and abs(state.velocity_rpm) < 10

        with client("program") as program:
            drive(program, log, 0.3, arm=rc10.velocity_rpm(30))
        wait_for(holds, 1.0)
        nothing("a program ends in good order", "`on_timeout` holds the load")
        assert ctl("set", "arm", "velocity", "30", "--for", "300ms").returncode == 0
        wait_for(holds, 1.0)
        time.sleep(0.3)
        assert all(currents(f)[2] for f in log.frames(FRONT)[-200:]), "it is never let go"
        log.check()
        nothing("`rc10ctl set ... --for` ends", "`on_timeout` holds the load")


def test_what_only_turns_a_motor_is_no_reason_to_stop() -> None:
    with robot_under_test() as (_, robot, log):
        # Almost what is torque at rest: 1 A (5 % of what an M3508 reports) for 100 ms.
        robot.disable()
        wait_for(has(robot, "left", READY), 2.0)
        break_drive(LEFT, Fault.LEAKY, 90)
        wait_for(lambda: robot.wait_for_state(1.0).motors["left"].current_a > 0.85, 2.0)
        let_pass(robot, 0.5)
        for _ in range(3):
            break_drive(LEFT, Fault.LEAKY, 150)
            let_pass(robot, 0.06)
            break_drive(LEFT, Fault.NONE)
            let_pass(robot, 0.2)
        assert robot.wait_for_state(1.0).motors["left"].status is READY
        nothing("a current at rest below `rest_current_a`, or shorter than `rest_ms`", "no stop")
        # As a control: it is one that is seen.
        break_drive(LEFT, Fault.LEAKY, 150)
        wait_for(has(robot, "left", FAULT), 2.0)
        assert robot.motor("left").fault == NOT_AT_REST
        break_drive(LEFT, Fault.NONE)
        wait_for(lambda: robot.wait_for_state(1.0).motors["left"].current_a < 0.1, 2.0)
        robot.clear(["left"])
        wait_for(has(robot, "left", READY), 2.0)
        robot.enable()
        # Enabled without a target, then disabled: 1.5 N m at the output, to and fro.
        for status in (ACTIVE, READY):
            for torque in (150, -150, 150, 0):
                break_drive(LEFT, Fault.PUSHED, torque)
                time.sleep(0.4)
            assert abs(robot.wait_for_state(1.0).motors["left"].total_angle_deg) > 30, "it turned"
            assert robot.wait_for_state(1.0).motors["left"].status is status
            robot.disable()
            time.sleep(0.5)
        assert not robot.wait_for_state(1.0).estopped
        log.check()
        nothing("a hand turns a motor that rests, enabled or not", "no stop")


def test_a_short_block_is_no_stall(tmp_path: Path) -> None:
    watched = {"id: 2, zero: power_on": "id: 2, stall_ms: 500, zero: power_on"}
    with robot_with(tmp_path, watched) as (_, robot, log):
        robot.enable()
        moving = rc10.velocity_rpm(100)
        drive(robot, log, 0.3, right=moving)
        for _ in range(2):
            break_drive(RIGHT, Fault.STALLED)
            drive(robot, log, 0.35, right=moving)
            break_drive(RIGHT, Fault.NONE)
            drive(robot, log, 0.3, right=moving)
        assert robot.wait_for_state(1.0).motors["right"].status is ACTIVE
        nothing("blocked for 0.7 of `stall_ms`", "the motor goes on")
        break_drive(RIGHT, Fault.STALLED)
        drive(robot, log, 1.5, right=moving)
        assert robot.motor("right").fault == STALLED
        log.check()


def test_a_first_angle_has_a_bound(tmp_path: Path) -> None:
    bound = {"on_timeout: brake": "max_first_step_deg: 30, on_timeout: brake"}
    with robot_with(tmp_path, bound) as (_, robot, log):
        robot.enable()
        drive(robot, log, 0.3, arm=rc10.total_angle_deg(32))
        assert log.last_torque_ns("arm") == 0
        nothing("a first angle target just farther than `max_first_step_deg`", "skipped, told")
        drive(robot, log, 1.0, arm=rc10.total_angle_deg(28))
        state = robot.wait_for_state(1.0).motors["arm"]
        assert state.total_angle_deg == pytest.approx(28, abs=4)
        log.check()
        nothing("a first angle target just within `max_first_step_deg`", "followed")


# ---- The turn at power-up

ABSOLUTE = """
robot: faults
realtime: preferred
buses:
  - name: front
    interface: vcan0
    motors:
      - {name: left, model: GM6020, id: 5, command: current, angle_min_deg: -90, angle_max_deg: 200}
  - name: rear
    interface: vcan1
    motors:
      - {name: other, model: M3508, id: 1, zero: power_on}
"""
YAW = 5


def test_a_power_cycle_keeps_the_angle_at_each_place_of_the_travel(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(ABSOLUTE)
    # The witness judges the frames of M3508 alone: the other bus must miss no tick.
    with drives("GM6020:5"), witness() as log, daemon(path), client() as robot:
        wait_status(robot, READY)
        for place in (-90, -45, 0, 90, 179, 181, 190, 200, 215, -110):
            break_drive(YAW, Fault.PARKED, place)
            wait_for(has(robot, "left", OFFLINE), 2.0)
            wait_for(has(robot, "left", READY), 2.0)
            motor = robot.wait_for_state(1.0).motors["left"]
            assert motor.zeroed, place
            assert abs(motor.total_angle_deg - place) < 1, (place, motor.total_angle_deg)
            robot.enable(["left"])
            for t_s in robot.rate(100):
                if t_s >= 0.2:
                    break
                robot.command(left=rc10.total_angle_deg(min(max(place, -89), 199)), validity_ms=40)
            moved = robot.wait_for_state(1.0).motors["left"].total_angle_deg - place
            assert abs(moved) < 30, (place, moved)
            robot.disable(["left"])
            time.sleep(0.5)
            nothing(f"power cycle at {place} of -90 to 200 deg", "on its turn; no way round")
        break_drive(YAW, Fault.PARKED, 235)
        wait_for(has(robot, "left", OFFLINE), 2.0)
        wait_for(has(robot, "left", READY), 2.0)
        assert not robot.wait_for_state(1.0).motors["left"].zeroed
        with pytest.raises(rc10.RequestFailed):
            robot.enable(["left"])
        nothing("power cycle in the middle of the gap of that travel", "not enabled")
        log.check()
