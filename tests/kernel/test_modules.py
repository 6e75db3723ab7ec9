"""Modules on a robot that moves: chassis, gimbal, remote, joint and feeder, over real SocketCAN.

The drives, the floor, the remote and the inertial sensor are this process's (stage.py); what they
see is the witness, and the frames that candump recorded.
"""
# run-guest: --timeout 600

from __future__ import annotations

import itertools
import math
import time
from typing import TYPE_CHECKING

import pytest
from ground import Ground, mecanum_wheel, steered_wheel
from guestlib import Candump, reset_buses
from module_rig import let_pass, robot_of, until, wheel
from rig import C6XX_COMMAND, MS, currents, wait_status
from stage import Recorder, Stage, motor

import rc10
from rc10.fakes.serial_devices import FakeDr16, FakeHipnuc
from rc10.fakes.serial_port import FakePort

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from ground import Pose
    from guestlib import Frame, Proc


@pytest.fixture(autouse=True, scope="module")
def fresh_buses() -> Iterator[None]:
    """Robots stay for several tests, and so do their buses."""
    yield
    reset_buses("vcan0", "vcan1")


# Size of both chassis.
CHASSIS_SIZE = """\
    wheel_radius_m: 0.076
    track_m: 0.5
    wheelbase_m: 0.4
    max_speed_m_s: 2
    max_turn_deg_s: 180
    max_acceleration_m_s2: 4
    max_turn_acceleration_deg_s2: 720
"""

MECANUM = (
    """
buses:
  - name: wheels
    interface: vcan0
    motors:
      - {name: front_left, model: M3508, id: 1}
      - {name: front_right, model: M3508, id: 2, direction: -1}
      - {name: rear_left, model: M3508, id: 3}
      - {name: rear_right, model: M3508, id: 4, direction: -1}
  - name: head
    interface: vcan1
    motors:
      - {name: yaw, model: GM6020, id: 5}
      - {name: pitch, model: GM6020, id: 6}
modules:
  - name: remote
    type: remote
    priority: 100
    port: FOLDER/remote
    protocol: dbus
    arm_channel: left_switch
    sticks:
      - {channel: right_y, to: base.vx_m_s, scale: 2}
      - {channel: left_x, to: base.wz_deg_s, scale: -180}
  - {name: imu, type: imu, port: FOLDER/imu, protocol: hipnuc}
  - name: base
    type: mecanum_chassis
    wheels: {front_left: front_left, front_right: front_right, rear_left: rear_left,
             rear_right: rear_right}
"""
    + CHASSIS_SIZE
    + """\
  - {name: gimbal, type: gimbal, yaw: yaw, pitch: pitch, imu_yaw: imu.yaw_deg,
     imu_yaw_rate: imu.yaw_rate_deg_s, imu_pitch: imu.pitch_deg}
"""
)

# docs/modules.md: a remote that is lost for lost_ms gives nothing any more; what it gave is in
# force for 20 ms, and what the chassis told the wheels for another 20. Then the next tick.
LOST_MS = 100
REST_MS = LOST_MS + 20 + 20 + 1

# The planner's loop.
PLANNER_MS = 10


class Hero:
    """A mecanum robot with a gimbal: what it is told, and what is true."""

    def __init__(self, folder: Path) -> None:
        # Unequal wheels, as they are.
        wheels = [wheel(1, 0.10), wheel(2, 0.30), wheel(3, 0.20), wheel(4, 0.15)]
        self.yaw, self.pitch = motor("GM6020:5"), motor("GM6020:6")
        self.stage = Stage({"vcan0": wheels, "vcan1": [self.yaw, self.pitch]})
        places = ((0.2, 0.25, 1), (0.2, -0.25, -1), (-0.2, 0.25, 1), (-0.2, -0.25, -1))
        self.ground = Ground(
            mecanum_wheel(drive, x_m, y_m, radius_m=0.076, sign=sign)
            for drive, (x_m, y_m, sign) in zip(wheels, places, strict=True)
        )
        self.remote_port = FakePort(folder / "remote")
        self.imu_port = FakePort(folder / "imu")
        self.remote_sent_ns: list[int] = []
        self.remote = FakeDr16(self._send_remote)
        self.imu = FakeHipnuc(self.imu_port.send)
        self.stage.things += [self.ground, self, self.imu, self.remote]
        self.daemon: Proc
        self.robot: rc10.Robot

    @property
    def world_yaw_deg(self) -> float:
        """Where the gimbal truly looks."""
        return self.ground.heading_deg + self.yaw.angle_deg

    def step(self, _dt_s: float) -> None:
        """The sensor is on the gimbal."""
        self.imu.yaw_deg = (self.world_yaw_deg + 180.0) % 360.0 - 180.0
        self.imu.rates_deg_s = (0.0, 0.0, self.ground.turn_deg_s + self.yaw.velocity_rpm * 6.0)
        self.imu.pitch_deg = self.pitch.angle_deg

    def _send_remote(self, frame: bytes) -> None:
        self.remote_sent_ns.append(time.time_ns())
        self.remote_port.send(frame)


@pytest.fixture(scope="class")
def hero(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Hero]:
    folder = tmp_path_factory.mktemp("hero")
    made = Hero(folder)
    with (
        made.remote_port,
        made.imu_port,
        made.stage,
        robot_of(folder, "hero", MECANUM) as (made.daemon, made.robot),
    ):
        yield made


def drive_a_square(robot: rc10.Robot, pose: Callable[[], Pose]) -> list[tuple[Pose, Pose]]:
    """1 m/s for a second in each direction; where it stood after each, by odometry and in truth."""
    base = robot.module("base")
    corners = []
    for t_s in robot.rate(50):  # the soft start
        if t_s > 0.3:
            break
        base.send(vx_m_s=0.0, vy_m_s=0.0)
    for x, y in ((1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)):
        for t_s in robot.rate(50):
            if t_s > 1.49:
                break
            going = 1.0 if t_s < 0.99 else 0.0
            base.send(vx_m_s=x * going, vy_m_s=y * going)
        seen = base.state
        odometry = type(pose())(seen["x_m"], seen["y_m"], seen["heading_deg"])
        corners.append((odometry, pose()))
    return corners


# At 720 deg/s2 the chassis turns by 7 deg/s faster from one frame of the sensor to the next. So
# much is not taken off, and with the gimbal's gain of 10 per second it is 0.7 deg.
GIMBAL_DEG = 1.0

# Twists say how fast, not how far: what the velocity loops leave over at each start and stop adds
# up, and nothing brings it back. It may end half a percent of its way (4 m) beside its start.
RETURN_MM = 20.0
RETURN_DEG = 0.5
# Wheels that are still being steered round roll as far as they point the right way: at each of
# three corners the robot drives some 10 mm on into the old direction.
SWERVE_RETURN_MM = 40.0
# Odometry on a floor where nothing slips: wheels are read with 2.5 um and once a tick, their
# directions with 0.04 deg. The state is up to 20 ms old, while the loops still settle.
ODOMETRY_MM = 2.0
ODOMETRY_DEG = 0.1


def beside_mm(pose: Pose, x_m: float, y_m: float) -> float:
    return math.hypot(pose.x_m - x_m, pose.y_m - y_m) * 1e3


def turned_deg(pose: Pose, other: Pose | None = None) -> float:
    return abs(math.remainder(pose.heading_deg - (other.heading_deg if other else 0.0), 360.0))


def assert_square(corners: list[tuple[Pose, Pose]], bound_mm: float) -> None:
    """A square of 1 m, in truth and by odometry, back where it began."""
    wanted = ((1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.0, 0.0))
    for (odometry, true), (x_m, y_m) in zip(corners, wanted, strict=True):
        assert beside_mm(true, x_m, y_m) < bound_mm
        assert turned_deg(true) < RETURN_DEG
        assert beside_mm(odometry, true.x_m, true.y_m) < ODOMETRY_MM
        assert turned_deg(odometry, true) < ODOMETRY_DEG


def pushes(frame: Frame) -> bool:
    """Whether it gives a wheel current."""
    return any(currents(frame))


def look_at(hero: Hero, yaw_deg: float) -> None:
    """Turns the gimbal until it looks there, in the world."""
    gimbal = hero.robot.module("gimbal")
    until(
        hero.robot,
        lambda: abs(math.remainder(hero.world_yaw_deg - yaw_deg, 360.0)) < 0.2,
        f"looking at {yaw_deg:g} deg",
        each=lambda: gimbal.send(yaw_deg=yaw_deg, pitch_deg=0.0),
    )


class TestAMecanumRobot:
    def test_drives_a_square_and_is_where_its_odometry_says(self, hero: Hero) -> None:
        hero.robot.enable()
        assert_square(drive_a_square(hero.robot, lambda: hero.ground.pose), RETURN_MM)
        assert hero.ground.path_m > 3.9

    def test_holds_the_gimbal_to_the_world_while_the_chassis_turns_under_it(
        self, hero: Hero
    ) -> None:
        base, gimbal = hero.robot.module("base"), hero.robot.module("gimbal")
        hero.robot.enable()
        # Until a motion has shown the lag of the gyro, the chassis' turning is low-passed.
        for at_deg in (60.0, 30.0, 60.0, 30.0):
            look_at(hero, at_deg)
        assert gimbal.state["imu_lag_ms"] < 5.0
        before_deg = hero.ground.heading_deg
        with Recorder(hero.stage, yaw_deg=lambda: hero.world_yaw_deg) as seen:
            for t_s in hero.robot.rate(50):
                if t_s > 2.0:
                    break
                base.send(wz_deg_s=120.0 if t_s < 1.5 else 0.0)
        assert hero.ground.heading_deg - before_deg == pytest.approx(180.0, abs=5.0)
        worst_deg = max(abs(math.remainder(yaw - 30.0, 360.0)) for yaw in seen["yaw_deg"])
        assert worst_deg < GIMBAL_DEG
        assert gimbal.state["stabilised"] == 1.0

    def test_goes_on_looking_there_when_its_sensor_is_unplugged_in_the_middle_of_a_frame(
        self, hero: Hero
    ) -> None:
        gimbal, imu = hero.robot.module("gimbal"), hero.robot.module("imu")
        hero.robot.enable()
        look_deg = hero.world_yaw_deg
        hero.imu.on = False
        cut = hero.imu.frame()[:40]
        with Recorder(hero.stage, yaw_deg=lambda: hero.world_yaw_deg) as seen:
            hero.imu_port.send(cut)
            hero.imu_port.unplug()
            until(hero.robot, lambda: gimbal.state["stabilised"] == 0.0, "held to the chassis")
            assert math.isnan(imu.state["yaw_deg"])
            hero.imu_port.plug()
            hero.daemon.wait_line("imu.*is open")
            # The first bytes are no beginning of a frame.
            hero.imu_port.send(hero.imu.frame()[40:])
            hero.imu.on = True
            until(hero.robot, lambda: gimbal.state["stabilised"] == 1.0, "held to the world again")
        assert max(abs(yaw - look_deg) for yaw in seen["yaw_deg"]) < 0.5
        hero.robot.disable()

    def test_obeys_its_remote_instead_of_the_planner_from_the_next_tick(self, hero: Hero) -> None:
        base = hero.robot.module("base")
        hero.robot.enable()
        until(hero.robot, lambda: base.state.outputs != {}, "a state of the chassis")
        hero.remote.right_y = -0.5
        with Candump("vcan0", ids=(C6XX_COMMAND,)) as bus:
            for t_s in hero.robot.rate(100):
                if t_s > 1.8:
                    break
                base.send(vx_m_s=0.5)
                if t_s == pytest.approx(0.6):
                    # The stick alone is nothing: the switch is down.
                    assert base.state.owner == "planner"
                    sent = len(hero.remote_sent_ns)
                    hero.remote.left_switch = 1
                if t_s == pytest.approx(1.5):
                    assert base.state.owner == "remote"
                    hero.remote.on = False
            bus.stop()
            assert base.state.owner == "planner"
        hero.robot.disable()
        # One wheel's current, 819 for each A. Rolling evenly it changes by some hundredths of an A
        # in a tick; a chassis that slows down by 4 m/s2 takes 0.1 A off in each.
        told = [(frame.t_ns, currents(frame)[0]) for frame in bus.frames()]
        changes = [(t_ns, raw - old) for (_, old), (t_ns, raw) in itertools.pairwise(told)]
        # The switch counts as two frames in a row have it.
        taken_ns, last_ns = hero.remote_sent_ns[sent + 1], hero.remote_sent_ns[-1]
        even = [by for t_ns, by in changes if taken_ns - 30 * MS < t_ns < taken_ns]
        assert all(abs(by) < 20 for by in even)
        next_ns, by = next(change for change in changes if change[0] > taken_ns)
        assert next_ns < taken_ns + 1 * MS
        assert by < -60
        # The planner, who never ceased to ask, is heard again when the remote's word has lapsed.
        risen_ns = next(t_ns for t_ns, by in changes if t_ns > last_ns and by > 60)
        assert LOST_MS < (risen_ns - last_ns) / MS <= LOST_MS + 20 + PLANNER_MS + 1

    def test_rests_in_time_when_its_remote_is_lost_and_recovers_by_the_arm_switch(
        self, hero: Hero
    ) -> None:
        use_the_arm_switch(hero)
        hero.remote.right_y = 0.5
        with Candump("vcan0", ids=(C6XX_COMMAND,)) as bus:
            wait_driving(hero)
            hero.remote.on = False
            wait_status(hero.robot, rc10.MotorStatus.READY)
            lost_ns = hero.remote_sent_ns[-1]
            last_ns = max(frame.t_ns for frame in bus.frames() if pushes(frame))
            assert LOST_MS * MS < last_ns - lost_ns <= REST_MS * MS
            # Back, with the switch up and a stick away from its middle: nothing.
            hero.remote.on = True
            back_ns = time.time_ns()
            let_pass(hero.robot, 0.3)
            assert not any(pushes(frame) for frame in bus.frames() if frame.t_ns > back_ns)
            use_the_arm_switch(hero)
            wait_driving(hero)

    def test_recovers_from_a_power_cut_of_its_drives_by_the_arm_switch_alone(
        self, hero: Hero
    ) -> None:
        hero.remote.right_y = 0.5
        use_the_arm_switch(hero)
        wait_driving(hero)
        hero.stage.powered = False
        wait_status(hero.robot, rc10.MotorStatus.OFFLINE)
        # After a shorter loss the wheels of a chassis come back by themselves.
        let_pass(hero.robot, 3.5)
        hero.stage.powered = True
        with Candump("vcan0", ids=(C6XX_COMMAND,)) as bus:
            wait_status(hero.robot, rc10.MotorStatus.READY)
            let_pass(hero.robot, 2.0)
            bus.stop()
            assert not any(pushes(frame) for frame in bus.frames())
        use_the_arm_switch(hero)
        wait_driving(hero)

    def test_survives_its_remote_being_unplugged_in_the_middle_of_a_frame(self, hero: Hero) -> None:
        hero.remote.right_y = 0.5
        use_the_arm_switch(hero)
        wait_driving(hero)
        with Candump("vcan0", ids=(C6XX_COMMAND,)) as bus:
            hero.remote.on = False
            lost_ns = hero.remote_sent_ns[-1]
            hero.remote_port.send(hero.remote.frame()[:9])
            hero.remote_port.unplug()
            hero.daemon.wait_line("remote.*is gone")
            # Longer than it takes to rest, and less than disable_s.
            let_pass(hero.robot, 0.2)
            hero.remote_port.plug()
            hero.daemon.wait_line("remote.*is open")
            # The first bytes are the rest of a frame.
            hero.remote_port.send(hero.remote.frame()[9:])
            hero.remote.on = True
            sent = len(hero.remote_sent_ns)
            again = bus.wait_frame(lambda f: f.t_ns > lost_ns + REST_MS * MS and pushes(f))
            # Lost for less than disable_s: the motors are still enabled. Not before a whole frame.
            assert again.t_ns > hero.remote_sent_ns[sent]
        hero.remote.left_switch = -1
        wait_status(hero.robot, rc10.MotorStatus.READY)


def wait_driving(hero: Hero) -> None:
    """Until it has gone 10 cm from now on."""
    from_m = hero.ground.path_m
    until(hero.robot, lambda: hero.ground.path_m - from_m > 0.1, "driving")


def use_the_arm_switch(hero: Hero) -> None:
    """Down and up, as the driver does, until the drives are ACTIVE."""
    hero.remote.on = True
    remote = hero.robot.module("remote")
    hero.remote.left_switch = -1
    until(
        hero.robot,
        lambda: (remote.state["connected"], remote.state["left_switch"]) == (1.0, -1.0),
        "a remote with the switch down",
    )
    hero.remote.left_switch = 1
    wait_status(hero.robot, rc10.MotorStatus.ACTIVE)


SWERVE = (
    """
buses:
  - name: driving
    interface: vcan0
    motors:
      - {name: front_left, model: M3508, id: 1}
      - {name: front_right, model: M3508, id: 2}
      - {name: rear_left, model: M3508, id: 3}
      - {name: rear_right, model: M3508, id: 4}
  - name: steering
    interface: vcan1
    motors:
      - {name: steer_front_left, model: GM6020, id: 1}
      - {name: steer_front_right, model: GM6020, id: 2}
      - {name: steer_rear_left, model: GM6020, id: 3}
      - {name: steer_rear_right, model: GM6020, id: 4}
modules:
  - name: base
    type: swerve_chassis
    drive: {front_left: front_left, front_right: front_right, rear_left: rear_left,
            rear_right: rear_right}
    steer: {front_left: steer_front_left, front_right: steer_front_right,
            rear_left: steer_rear_left, rear_right: steer_rear_right}
"""
    + CHASSIS_SIZE
)


class TestASwerveRobot:
    def test_drives_a_square_and_is_where_its_odometry_says(self, tmp_path: Path) -> None:
        drives = [wheel(1, 0.10), wheel(2, 0.30), wheel(3, 0.20), wheel(4, 0.15)]
        steers = [motor(f"GM6020:{number}") for number in (1, 2, 3, 4)]
        stage = Stage({"vcan0": drives, "vcan1": steers})
        places = ((0.2, 0.25), (0.2, -0.25), (-0.2, 0.25), (-0.2, -0.25))
        ground = Ground(
            steered_wheel(drive, steer, x_m, y_m, radius_m=0.076)
            for drive, steer, (x_m, y_m) in zip(drives, steers, places, strict=True)
        )
        stage.things.append(ground)
        with stage, robot_of(tmp_path, "swerve", SWERVE) as (_, robot):
            robot.enable()
            assert_square(drive_a_square(robot, lambda: ground.pose), SWERVE_RETURN_MM)
        assert ground.path_m > 3.9
