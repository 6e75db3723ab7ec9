"""Recordings by robot.record()."""

from __future__ import annotations

import csv
import json
import math
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

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
    daemon.active = {"wheel"}
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


def test_a_data_frame_has_words_for_numbers_and_units_of_choice(recording: Recording) -> None:
    frame = recording.to_pandas(["wheel.velocity_rpm", "wheel.mode", "wheel.target"], units="rad")
    assert list(frame.columns) == ["wheel.velocity_rad_s", "wheel.mode", "wheel.target"]
    assert frame.index.name == "time_s"
    np.testing.assert_allclose(
        frame["wheel.velocity_rad_s"], recording["wheel.velocity_rpm"] * 2 * math.pi / 60
    )
    assert frame["wheel.mode"].iloc[0] == "COAST"
    assert frame["wheel.mode"].iloc[-1] == "VELOCITY"
    assert frame["wheel.target"].iloc[-1] == pytest.approx(2 * math.pi)
    whole = recording.to_pandas()
    assert len(whole.columns) == len(recording.names())
    assert set(whole["wheel.status"]) == {"ACTIVE"}
    with pytest.raises(ValueError, match="units='turns': use deg or rad"):
        recording.to_pandas(units="turns")  # type: ignore[arg-type]


def test_an_mcap_file_has_a_topic_for_each_motor_and_the_words(
    recording: Recording, tmp_path: Path
) -> None:
    recording.to_mcap(tmp_path / "all.mcap")
    with (tmp_path / "all.mcap").open("rb") as file:
        reader = make_reader(file)
        messages = list(reader.iter_messages())
        legends = {record.name: record.metadata for record in reader.iter_metadata()}
    assert {channel.topic for _, channel, _ in messages} == {
        f"/demo/motor/{name}" for name in recording.motors
    }
    assert len(messages) == len(recording) * len(recording.motors)
    wheel = [json.loads(m.data) for _, channel, m in messages if channel.topic.endswith("/wheel")]
    np.testing.assert_allclose(
        [message["velocity_rpm"] for message in wheel], recording["wheel.velocity_rpm"]
    )
    assert wheel[0]["voltage_v"] is None
    assert legends["legend: status"]["3"] == "ACTIVE"
    first_ns = min(message.log_time for _, _, message in messages)
    assert first_ns == recording.start_utime * 1000
