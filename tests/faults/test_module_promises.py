"""Modules that act for nobody, and the heartbeat of an e-stop: each beside a case that is none."""
# run-guest: --timeout 900

from __future__ import annotations

import contextlib
import struct
import time
from typing import TYPE_CHECKING, NamedTuple

from faultrig import nothing, proven
from faulty_drives import Fault, FaultyDrives, FaultyMotor
from guestlib import Candump, Pin, can_frame, can_socket, wait_for
from module_rig import let_pass, robot_of, until
from rig import C6XX_COMMAND, MS, wait_status
from stage import Stage, motor

import rc10
from rc10.fakes import MotorSpec
from rc10.fakes.serial_devices import FakeDr16
from rc10.fakes.serial_port import FakePort

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from guestlib import Frame

ACTIVE, READY = rc10.MotorStatus.ACTIVE, rc10.MotorStatus.READY
OFFLINE, FAULT = rc10.MotorStatus.OFFLINE, rc10.MotorStatus.FAULT
GM6020_CURRENT = 0x2FE
VALIDITY_MS = 40


def last_torque_ns(frames: list[Frame], after_ns: int = 0) -> int:
    """When the last frame left that was more than rest; 0: none did."""
    return max((f.t_ns for f in frames if f.t_ns >= after_ns and any(f.data)), default=0)


# ---- Gimbal

GIMBAL = """
buses:
  - name: head
    interface: vcan1
    motors:
      - {name: yaw, model: GM6020, id: 5}
      - {name: pitch, model: GM6020, id: 6}
modules:
  - {name: gimbal, type: gimbal, yaw: yaw, pitch: pitch}
"""
SILENCE_MAX_MS = 10_000  # its default


def test_a_gimbal_whose_client_is_silent(tmp_path: Path) -> None:
    # The weight of the barrel: holding it takes a voltage in each tick.
    yaw, pitch = motor("GM6020:5"), motor("GM6020:6", load_nm=0.2)
    with (
        Stage({"vcan1": [yaw, pitch]}),
        robot_of(tmp_path, "head", GIMBAL) as (_, robot),
        Candump("vcan1", ids=(GM6020_CURRENT,)) as bus,
    ):
        gimbal = robot.module("gimbal")
        robot.enable()

        def look(seconds: float) -> int:
            for t_s in robot.rate(100):
                if t_s >= seconds:
                    break
                gimbal.send(yaw_deg=20.0, pitch_deg=5.0, validity_ms=VALIDITY_MS)
            return time.time_ns()

        silent_ns = look(2.0)
        at_deg = pitch.angle_deg
        let_pass(robot, 9.0)
        assert abs(pitch.angle_deg - at_deg) < 0.5
        back_ns = time.time_ns()
        held = [f for f in bus.frames() if silent_ns < f.t_ns < back_ns]
        assert len(held) > 8900
        assert all(any(f.data) for f in held), "it let go"
        silent_ns = look(0.5)
        assert abs(pitch.angle_deg - at_deg) < 0.5
        nothing("the client of a `gimbal` is silent for 9 s", "holds its direction; obeys it again")

        let_pass(robot, SILENCE_MAX_MS / 1000 + 1.0)
        assert robot.motor("pitch").status is ACTIVE
        proven(
            "the client of a `gimbal` falls silent, `silence_max_s: 10`",
            "holds its direction for that time, then `on_timeout`",
            silent_ns,
            last_torque_ns(bus.frames()),
            SILENCE_MAX_MS + VALIDITY_MS + 60,
        )
        assert last_torque_ns(bus.frames()) > silent_ns + (SILENCE_MAX_MS - 100) * MS


# ---- Remote

REMOTE = """
buses:
  - name: wheels
    interface: vcan0
    motors:
      - {name: left, model: M3508, id: 1}
      - {name: right, model: M3508, id: 2}
modules:
  - name: remote
    type: remote
    port: FOLDER/remote
    protocol: dbus
    arm_channel: left_switch
    disable_s: 10
    sticks:
      - {channel: right_y, to: belt.velocity_rpm, scale: 60}
  - {name: belt, type: feeder, motor: left, velocity_limit_rpm: 60}
"""
LOST_MS = 100  # its default
# Its inputs are in force for 20 ms, and the feeder's target of the motor for another 20.
REST_MS = LOST_MS + 20 + 20 + 1


class Rig(NamedTuple):
    """A robot of two wheels and its driver."""

    robot: rc10.Robot
    remote: FakeDr16
    left: FaultyMotor
    right: FaultyMotor
    sent_ns: list[int]


@contextlib.contextmanager
def remote_robot(folder: Path) -> Iterator[Rig]:
    port = FakePort(folder / "remote")
    sent_ns: list[int] = []

    def send(frame: bytes) -> None:
        sent_ns.append(time.time_ns())
        port.send(frame)

    remote = FakeDr16(send)
    left, right = (FaultyMotor(MotorSpec.parse(f"M3508:{number}")) for number in (1, 2))
    stage = Stage({"vcan0": FaultyDrives([left, right])})
    stage.things.append(remote)
    with port, stage, robot_of(folder, "driven", REMOTE) as (_, robot):
        switch_down(robot, remote)
        yield Rig(robot, remote, left, right, sent_ns)


def switch_down(robot: rc10.Robot, remote: FakeDr16) -> None:
    remote.on = True
    remote.left_switch = -1
    heard = robot.module("remote")
    until(
        robot,
        lambda: (
            bool(heard.state.outputs)
            and (heard.state["connected"], heard.state["left_switch"]) == (1.0, -1.0)
        ),
        "a remote with the switch down",
    )
    let_pass(robot, 0.05)  # two frames


def test_a_remote_that_is_lost_in_motion(tmp_path: Path) -> None:
    with remote_robot(tmp_path) as rig, Candump("vcan0", ids=(C6XX_COMMAND,)) as bus:
        rig.remote.left_switch = 1
        wait_status(rig.robot, ACTIVE)
        rig.remote.right_y = 1.0
        until(rig.robot, lambda: rig.left.velocity_rpm > 50, "a belt that runs")
        # Five frames of the receiver are lost, again and again.
        begun_ns = time.time_ns()
        for _ in range(5):
            rig.remote.on = False
            let_pass(rig.robot, 0.07)
            rig.remote.on = True
            let_pass(rig.robot, 0.2)
            assert rig.left.velocity_rpm > 50
        run = [f for f in bus.frames() if f.t_ns > begun_ns]
        assert all(any(f.data) for f in run)
        nothing("a remote's frames are missing for 80 ms, `lost_ms: 100`", "the motors go on")
        rig.remote.on = False
        let_pass(rig.robot, 0.5)
        proven(
            "a remote falls silent, `lost_ms: 100`",
            "commands nothing",
            rig.sent_ns[-1],
            last_torque_ns(bus.frames()),
            REST_MS,
        )


def somebody_else_commands() -> None:
    """A fault of both motors, which `clear` ends."""
    with can_socket("vcan0") as stranger:
        for _ in range(3):
            stranger.send(can_frame(C6XX_COMMAND, struct.pack(">4h", 100, 100, 0, 0)))
            time.sleep(0.001)


def test_a_remote_clears_and_enables_while_it_is_heard(tmp_path: Path) -> None:
    with remote_robot(tmp_path) as rig:
        somebody_else_commands()
        _wait(rig, left=FAULT, right=FAULT)
        up_ns = time.time_ns()
        rig.remote.left_switch = 1
        _wait(rig, left=ACTIVE, right=ACTIVE)
        proven(
            "the arm switch of a remote goes up, motors are in FAULT",
            "cleared and enabled",
            up_ns,
            time.time_ns(),
            500,
        )


def test_a_remote_that_is_unheard_neither_clears_nor_enables(tmp_path: Path) -> None:
    with remote_robot(tmp_path) as rig, Candump("vcan0", ids=(C6XX_COMMAND,)) as bus:
        for drive in (rig.left, rig.right):
            drive.order(Fault.SILENT, 0)
        _wait(rig, left=OFFLINE, right=OFFLINE)
        rig.remote.left_switch = 1
        let_pass(rig.robot, 0.3)
        rig.remote.on = False
        let_pass(rig.robot, 0.2)
        # Within 3 s after the switch went up: heard, it would clear and enable.
        for drive in (rig.left, rig.right):
            drive.order(Fault.NONE, 0)
        _wait(rig, left=READY, right=READY)
        let_pass(rig.robot, 0.5)
        _wait(rig, left=READY, right=READY)
        somebody_else_commands()
        _wait(rig, left=FAULT, right=FAULT)
        since_ns = time.time_ns()
        let_pass(rig.robot, 2.5)
        _wait(rig, left=FAULT, right=FAULT)
        assert last_torque_ns(bus.frames(), since_ns) == 0
        nothing(
            "motors come back, or are in FAULT, within 3 s after the arm switch went up, "
            "and the remote is unheard",
            "neither cleared nor enabled",
        )


def _wait(rig: Rig, **wanted: rc10.MotorStatus) -> None:
    def done() -> bool:
        motors = rig.robot.wait_for_state(1.0).motors
        return all(motors[name].status is status for name, status in wanted.items())

    wait_for(done, 3.0, str(wanted))


# ---- The heartbeat of an e-stop

BEAT = """
heartbeat_gpio: {chip: CHIP, line: 0, period_ms: 40STOPS}
buses:
  - name: wheels
    interface: vcan0
    motors:
      - {name: left, model: M3508, id: 1}
modules:
  - {name: belt, type: feeder, motor: left, velocity_limit_rpm: 60}
"""
HALF_MS = 20
AFTER_MS = 200


def edges(robot: rc10.Robot, pin: Pin, seconds: float) -> list[int]:
    """When the line changed, in ns of the wall clock, looked at in each millisecond."""
    robot.spin(0.0)
    seen: list[int] = []
    level = pin.high()
    end_ns = time.time_ns() + round(seconds * 1e9)
    while time.time_ns() < end_ns:
        time.sleep(0.001)
        if pin.high() != level:
            level = not level
            seen.append(time.time_ns())
    return seen


@contextlib.contextmanager
def beating(folder: Path, pin: Pin, stops: str) -> Iterator[rc10.Robot]:
    text = BEAT.replace("CHIP", str(pin.chip)).replace("STOPS", stops)
    with Stage({"vcan0": [motor("M3508:1")]}), robot_of(folder, "beat", text) as (_, robot):
        robot.enable()
        yield robot


def beats_on(robot: rc10.Robot, pin: Pin, seconds: float) -> bool:
    return len(edges(robot, pin, seconds)) >= seconds * 1000 / HALF_MS - 2


def test_the_heartbeat_of_an_estop(tmp_path: Path) -> None:
    with Pin("beat") as pin, beating(tmp_path, pin, ", stops_on_estop_after_ms: 200") as robot:
        assert beats_on(robot, pin, 0.5)
        for _ in range(3):
            robot.estop()
            assert beats_on(robot, pin, 0.1)
            robot.clear()
            assert beats_on(robot, pin, 0.5)
        nothing(
            "e-stop, cleared before `stops_on_estop_after_ms` is over", "the heartbeat toggles on"
        )
        stopped_ns = time.time_ns()
        robot.estop()
        last_ns = edges(robot, pin, 1.0)[-1]
        assert last_ns > stopped_ns + (AFTER_MS - HALF_MS - 5) * MS
        proven(
            "e-stop with `stops_on_estop_after_ms: 200`",
            "the heartbeat stands still, and the relay drops out",
            stopped_ns,
            last_ns,
            AFTER_MS + HALF_MS + 5,
        )
        robot.clear()
        assert beats_on(robot, pin, 0.5)


def test_the_heartbeat_of_an_estop_without_the_key(tmp_path: Path) -> None:
    with Pin("beat") as pin, beating(tmp_path, pin, "") as robot:
        robot.estop()
        assert beats_on(robot, pin, 1.0)
    nothing("e-stop without that key", "the heartbeat toggles on")
