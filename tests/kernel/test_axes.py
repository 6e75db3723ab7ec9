"""Modules joint and feeder on axes that move, over real SocketCAN; as test_modules.py."""
# run-guest: --timeout 600

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING

import pytest
from guestlib import reset_buses
from module_rig import robot_of, until
from stage import Recorder, Stage, motor

import rc10
from rc10.fakes.serial_devices import FakeSbus
from rc10.fakes.serial_port import FakePort

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from rc10.fakes import FakeMotor


@pytest.fixture(autouse=True, scope="module")
def fresh_buses() -> Iterator[None]:
    """Robots stay for several tests, and so does their bus."""
    yield
    reset_buses("vcan0", "vcan1")


AXES = """
buses:
  - name: axes
    interface: vcan0
    motors:
      - {name: arm, model: M3508, id: 1, angle_min_deg: 0, angle_max_deg: 120}
      - {name: lift, model: M2006, id: 2}
      - {name: wheel, model: M2006, id: 3}
modules:
  - {name: ends, type: remote, port: FOLDER/ends, protocol: sbus}
  - {name: shoulder, type: joint, motor: arm, homing: stop, max_velocity_deg_s: 180,
     max_acceleration_deg_s2: 720, max_jerk_deg_s3: 7200}
  - {name: slide, type: joint, motor: lift, homing: switch, switch: ends.ch17,
     max_velocity_deg_s: 90, max_acceleration_deg_s2: 360}
  - {name: feeder, type: feeder, motor: wheel, velocity_limit_rpm: 60, jam_ms: 100,
     reverse_ms: 100, retries: 2}
"""


class Axes:
    """An arm between two stops, a slide with a switch at its end, and a feeder."""

    # Where the arm's lower stop and the slide's switch are, by what their encoders show.
    STOP_DEG, SWITCH_DEG = 37.0, 61.0

    def __init__(self, folder: Path) -> None:
        self.arm = motor("M3508:1", initial_angle_deg=self.STOP_DEG + 15.0)
        self.arm.stops_deg = (self.STOP_DEG, self.STOP_DEG + 130.0)
        self.lift = motor("M2006:2", initial_angle_deg=self.SWITCH_DEG + 10.0)
        self.wheel = motor("M2006:3")
        self.stage = Stage({"vcan0": [self.arm, self.lift, self.wheel]})
        self.port = FakePort(folder / "ends")
        self.ends = FakeSbus(self.port.send)
        self.stage.things += [self, self.ends]
        self.robot: rc10.Robot

    @property
    def arm_deg(self) -> float:
        """The arm's true angle, from its stop."""
        return self.arm.angle_deg - self.STOP_DEG

    def step(self, _dt_s: float) -> None:
        """The switch is closed at the end, and beyond."""
        self.ends.digital[0] = self.lift.angle_deg <= self.SWITCH_DEG


@pytest.fixture(scope="class")
def axes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Axes]:
    folder = tmp_path_factory.mktemp("axes")
    made = Axes(folder)
    with (
        made.port,
        made.stage,
        robot_of(folder, "axes", AXES) as (_, made.robot),
    ):
        made.robot.enable()
        yield made


def home(robot: rc10.Robot, name: str) -> None:
    """Homes a joint, and keeps sending until it is over, as docs/modules.md says."""
    joint = robot.module(name)
    assert joint.state["homed"] == 0.0
    until(
        robot,
        lambda: joint.state["homed"] == 1.0,
        f"{name} homed",
        each=lambda: joint.send(home=1),
    )


def s_curve(way_deg: float, velocity: float, acceleration: float, jerk: float) -> list[float]:
    """The angle in every millisecond of a move, by its seven phases; deg and s."""
    ramp_s = acceleration / jerk
    hold_s = velocity / acceleration - ramp_s
    cruise_s = way_deg / velocity - (2 * ramp_s + hold_s)
    phases = [(ramp_s, jerk), (hold_s, 0.0), (ramp_s, -jerk), (cruise_s, 0.0)]
    phases += [(ramp_s, -jerk), (hold_s, 0.0), (ramp_s, jerk)]
    at = speed = rate = 0.0
    angles = []
    for seconds, change in phases:
        for _ in range(round(seconds * 1000)):
            at += (speed + (rate / 2.0 + change / 6000.0) / 1000.0) / 1000.0
            speed += (rate + change / 2000.0) / 1000.0
            rate += change / 1000.0
            angles.append(at)
    return angles


class Ball:
    """Lies in the wheel's way, and falls into its place when that has gone back a little."""

    def __init__(self, wheel: FakeMotor, ahead_deg: float) -> None:
        self._wheel = wheel
        self._at_deg = wheel.angle_deg + ahead_deg
        self._touched = False
        wheel.stops_deg = (-math.inf, self._at_deg)

    def step(self, _dt_s: float) -> None:
        """Looks where the wheel is."""
        self._touched |= self._wheel.angle_deg >= self._at_deg - 0.1
        if self._touched and self._wheel.angle_deg < self._at_deg - 10.0:
            self._wheel.stops_deg = (-math.inf, math.inf)


class TestAJointAndAFeeder:
    def test_a_joint_homes_against_its_stop(self, axes: Axes) -> None:
        home(axes.robot, "shoulder")
        assert axes.arm_deg == pytest.approx(0.0, abs=0.5)
        assert axes.robot.module("shoulder").state["angle_deg"] == pytest.approx(
            axes.arm_deg, abs=0.1
        )

    def test_a_joint_moves_on_the_s_curve_that_its_limits_make(self, axes: Axes) -> None:
        shoulder = axes.robot.module("shoulder")
        wanted = s_curve(90.0, 180.0, 720.0, 7200.0)
        assert wanted[-1] == pytest.approx(90.0, abs=0.01)
        with Recorder(axes.stage, deg=lambda: axes.arm_deg) as seen:
            until(
                axes.robot,
                lambda: shoulder.state["move"] == 2.0,
                "there",
                each=lambda: shoulder.send(angle_deg=90.0),
            )
        assert axes.arm_deg == pytest.approx(90.0, abs=1.0)
        true = seen["deg"]
        wanted += [90.0] * len(true)
        # Tolerance: two ticks of latency at 180 deg/s, and the following error of the loops.
        assert max(abs(at - should) for at, should in zip(true, wanted, strict=False)) < 1.0

    def test_a_joint_stops_at_its_soft_limit(self, axes: Axes) -> None:
        shoulder = axes.robot.module("shoulder")
        with Recorder(axes.stage, deg=lambda: axes.arm_deg) as seen:
            for t_s in axes.robot.rate(100):
                if t_s > 0.8:
                    break
                shoulder.send(angle_deg=400.0)
        assert axes.arm_deg == pytest.approx(120.0, abs=0.5)
        assert max(seen["deg"]) < 121.0
        assert any("beyond" in event.text for event in axes.robot.events())

    def test_a_joint_does_not_look_for_a_switch_that_is_not_heard(self, axes: Axes) -> None:
        slide, ends = axes.robot.module("slide"), axes.robot.module("ends")
        axes.ends.on = False
        until(axes.robot, lambda: ends.state["connected"] == 0.0, "a silent receiver")
        before_deg = axes.lift.angle_deg
        until(
            axes.robot,
            lambda: slide.state["state"] == 3.0,
            "homing failed",
            each=lambda: slide.send(home=1),
        )
        assert axes.lift.angle_deg == before_deg
        axes.ends.on = True
        until(
            axes.robot,
            lambda: ends.state["connected"] == 1.0,
            "a receiver",
            each=lambda: slide.send(home=0),
        )

    def test_a_joint_homes_at_its_switch(self, axes: Axes) -> None:
        home(axes.robot, "slide")
        true_deg = axes.lift.angle_deg - axes.SWITCH_DEG
        # 30 deg/s, a frame of the receiver every 7 ms, and the tick that takes the zero.
        assert axes.robot.module("slide").state["angle_deg"] == pytest.approx(true_deg, abs=0.4)

    def test_a_feeder_frees_itself_from_a_jam_and_fires_what_was_asked(self, axes: Axes) -> None:
        feeder = axes.robot.module("feeder")
        start_deg = axes.wheel.angle_deg
        axes.robot.events()
        axes.stage.things.append(Ball(axes.wheel, 60.0))
        with Recorder(axes.stage, deg=lambda: axes.wheel.angle_deg - start_deg) as seen:
            for t_s in axes.robot.rate(100):
                if t_s > 1.2:
                    break
                feeder.send(shots=7 if t_s < 0.05 else 10)
        # Three pockets of 45 deg, though it stood at 60 deg and went back in between.
        assert seen["deg"][-1] == pytest.approx(135.0, abs=3.0)
        stood = seen["deg"].index(60.0)
        assert min(seen["deg"][stood:]) < 50.0
        assert feeder.state["jams"] == 1.0
        told = [event.text for event in axes.robot.events() if event.source == "feeder"]
        assert [text.split(":")[0] for text in told] == ["jammed", "free again"]

    def test_a_feeder_gives_up_after_its_tries_and_goes_on_when_asked_anew(
        self, axes: Axes
    ) -> None:
        feeder = axes.robot.module("feeder")
        start_deg = axes.wheel.angle_deg
        axes.wheel.stops_deg = (-math.inf, start_deg + 20.0)
        with Recorder(axes.stage, deg=lambda: axes.wheel.angle_deg - start_deg) as seen:
            for t_s in axes.robot.rate(100):
                if t_s > 1.0:
                    break
                feeder.send(velocity_rpm=60)
        back = [deg < 12.0 <= before for before, deg in itertools.pairwise(seen["deg"])]
        assert sum(back) == 2
        assert feeder.state["state"] == 3.0
        assert set(seen["deg"][-300:]) == {20.0}
        # The obstacle is taken out; nobody asks for a moment, then somebody does.
        axes.wheel.stops_deg = (-math.inf, math.inf)
        until(axes.robot, lambda: feeder.state.owner == "", "a feeder that nobody asks")
        until(
            axes.robot,
            lambda: axes.wheel.angle_deg - start_deg > 60.0,
            "feeding again",
            each=lambda: feeder.send(velocity_rpm=60),
        )
