"""Recordings by robot.record()."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

import rc10
from fake_daemon import FakeDaemon, setpoints
from rc10.lcm_types import robot_state_t, setpoint_t
from rc10.recording import Recording
from rc10.signals import SIGNALS
from virtual_link import VirtualLink


class SpinningDaemon(FakeDaemon):
    """Its wheel turns as it is told; the velocity counts the states."""

    def state(self) -> robot_state_t:
        message = super().state()
        wheel = message.motors[0]
        wheel.velocity_rpm = float(self.tick)
        if self.commands:
            wheel.mode, wheel.target = setpoints(self.commands[-1])["wheel"]
        return message


@pytest.fixture
def daemon(link: VirtualLink) -> SpinningDaemon:
    daemon = SpinningDaemon("demo", link)
    daemon.publish_states()
    return daemon


@pytest.fixture
def recording(robot: rc10.Robot, daemon: SpinningDaemon) -> Recording:
    """Half a second; in the second half of it the wheel has a target."""
    with robot.recorder() as recorder:
        for t_s in robot.rate(10):
            if t_s > 0.45:
                break
            if t_s > 0.25:
                robot.command(wheel=rc10.velocity_rpm(60))
    assert daemon.tick > 90
    return recorder.recording()


@pytest.mark.usefixtures("daemon")
def test_every_state_is_recorded_with_the_daemons_time(robot: rc10.Robot) -> None:
    recording = robot.record(1.0)
    assert 199 <= len(recording) <= 202
    assert recording.time_s[0] == 0
    np.testing.assert_allclose(np.diff(recording.time_s), 0.005, atol=2e-6)
    assert set(np.diff(recording.tick)) == {1}
    assert recording["wheel.velocity_rpm"] is recording.motor("wheel").velocity_rpm
    np.testing.assert_array_equal(recording["wheel.velocity_rpm"], recording.tick)
    assert np.isnan(recording["wheel.voltage_v"]).all()
    assert list(recording.motors) == ["wheel", "yaw", "left-arm"]


@pytest.mark.usefixtures("daemon")
def test_some_motors_only(robot: rc10.Robot) -> None:
    recording = robot.record(0.1, ["left-arm"])
    assert recording.names() == [f"left-arm.{name}" for name in SIGNALS]
    with pytest.raises(rc10.UnknownMotor, match="'wheel' was not recorded; there are: left-arm"):
        recording["wheel.velocity_rpm"]
    with pytest.raises(rc10.UnknownMotor, match="no motor 'wheels'"):
        robot.record(0.1, ["wheels"])


def test_states_that_wait_together_are_all_recorded(
    robot: rc10.Robot, daemon: SpinningDaemon, link: VirtualLink
) -> None:
    robot.wait_for_state()
    with robot.recorder() as recorder:
        link.pass_time(0.2)
        robot.spin()
    assert recorder.count == 40
    # And none after the block.
    robot.wait_for_state()
    assert recorder.count == 40
    assert daemon.tick > 40


def test_silence_is_no_recording(robot: rc10.Robot, link: VirtualLink) -> None:
    del link
    with pytest.raises(rc10.NotReceived, match="nothing was recorded"), robot.recorder() as none:
        none.recording()


def test_nothing_to_record_says_what_to_check(link: VirtualLink) -> None:
    with (
        rc10.Robot("demo", link, client="tester") as robot,
        pytest.raises(rc10.Timeout, match=r"no state of robot 'demo' within 1 s.*is rc10d running"),
    ):
        robot.record(1.0)


def test_a_table_that_others_can_read(recording: Recording, tmp_path: Path) -> None:
    recording.to_csv(tmp_path / "all.csv")
    with (tmp_path / "all.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == len(recording)
    assert float(rows[3]["time_s"]) == pytest.approx(recording.time_s[3])
    assert float(rows[3]["wheel.velocity_rpm"]) == recording["wheel.velocity_rpm"][3]
    assert rows[3]["wheel.voltage_v"] == ""

    recording.to_csv(tmp_path / "two.csv", ["yaw.angle_deg", "wheel.target"])
    back = np.genfromtxt(tmp_path / "two.csv", delimiter=",", names=True, deletechars="")
    assert back.dtype.names == ("time_s", "yaw.angle_deg", "wheel.target")
    assert back["wheel.target"][-1] == 60


def test_a_figure_has_axes_for_each_unit(recording: Recording, tmp_path: Path) -> None:
    figure = recording.plot("wheel.target", "wheel.velocity_rpm", "yaw.current_a", title="a step")
    speed, current = figure.axes
    assert speed.get_ylabel() == "velocity (rpm)"
    assert current.get_ylabel() == "current (A)"
    assert current.get_xlabel() == "time (s)"
    # There was no target at first: no line at zero.
    target = np.asarray(speed.lines[0].get_ydata())
    assert math.isnan(target[0])
    assert target[-1] == 60

    recording.save_png(tmp_path / "step.png")
    assert (tmp_path / "step.png").read_bytes().startswith(b"\x89PNG")


def test_what_is_followed_is_shown_without_being_asked_for(recording: Recording) -> None:
    (axes,) = recording.plot().axes
    assert [line.get_label() for line in axes.lines] == ["wheel.target", "wheel.velocity_rpm"]
    assert setpoint_t.MODE_VELOCITY in recording["wheel.mode"]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("wheel", "write motor.signal, as wheel.velocity_rpm"),
        ("wheel.speed", "a motor has no signal 'speed'; it has: status, "),
    ],
)
def test_a_wrong_signal_is_named(recording: Recording, name: str, message: str) -> None:
    with pytest.raises(rc10.UnknownSignal, match=message):
        recording[name]
