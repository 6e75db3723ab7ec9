"""Vectors from the MyActuator Motion Protocol V4.2, and what a drive does."""

from __future__ import annotations

import pytest

from frame_text import say, text_of
from rc10.fakes.families import family_spec
from rc10.fakes.myactuator import MYACTUATOR_MODELS, FakeMyActuator, MyActuatorSpec

X8_25 = next(model for model in MYACTUATOR_MODELS if model.name == "RMD-X8-25")


@pytest.fixture
def drive() -> FakeMyActuator:
    return MyActuatorSpec(X8_25, 1).make()


def test_reports_the_published_reading(drive: FakeMyActuator) -> None:
    drive.servo.temperature_c = 50.0
    drive.servo.speed_deg_s = -500.0
    drive.servo.angle_deg = -45.0
    drive.servo.torque_nm = -1.0 * X8_25.nm_per_a
    assert say(drive, "141#A10000009CFF0000") == ["241#A1329CFF0CFED3FF"]
    assert say(drive, "141#9C00000000000000") == ["241#9C329CFF0CFED3FF"]


def test_reports_the_published_status(drive: FakeMyActuator) -> None:
    drive.servo.temperature_c = 50.0
    drive.fail(0x0004)
    say(drive, "141#7700000000000000")
    assert say(drive, "141#9A00000000000000") == ["241#9A320001E0010400"]  # at 48.0 V


def test_reports_the_angle_in_hundredths_of_a_degree(drive: FakeMyActuator) -> None:
    drive.servo.angle_deg = 360.0
    assert say(drive, "141#9200000000000000") == ["241#92000000A08C0000"]


def test_turns_at_the_published_speed(drive: FakeMyActuator) -> None:
    say(drive, "141#A2000000F0D8FFFF")
    drive.step(1.0)
    assert drive.servo.speed_deg_s == pytest.approx(-100.0, abs=1.0)


def test_goes_to_the_published_angle(drive: FakeMyActuator) -> None:
    say(drive, "141#A400F401A08C0000")
    drive.step(3.0)
    assert drive.servo.angle_deg == pytest.approx(360.0, abs=1.0)


def test_gives_the_published_current(drive: FakeMyActuator) -> None:
    say(drive, "141#A10000009CFF0000")
    drive.step(0.01)
    assert drive.current_a == pytest.approx(-1.0)
    assert drive.servo.speed_deg_s < 0


def test_understands_the_published_motion_command(drive: FakeMyActuator) -> None:
    (reply,) = say(drive, "401#E66682E052333B55")
    assert reply.startswith("501#01")
    rad, rad_s, stiffness, damping, nm = drive.servo._motion
    assert rad == pytest.approx(10.0, abs=0.001)
    assert rad_s == pytest.approx(1.022, abs=0.001)
    assert stiffness == pytest.approx(10.012, abs=0.001)
    assert damping == pytest.approx(1.0, abs=0.001)
    assert nm == pytest.approx(10.004, abs=0.001)


def test_a_function_is_answered_with_a_copy_and_an_id_counts_at_once(drive: FakeMyActuator) -> None:
    assert say(drive, "141#2004000001000000") == ["241#2004000001000000"]
    assert say(drive, "141#2005000007000000") == ["247#2005000007000000"]
    assert say(drive, "141#8000000000000000") == []
    assert say(drive, "147#8000000000000000") == ["247#8000000000000000"]


def test_shutdown_leaves_no_torque(drive: FakeMyActuator) -> None:
    say(drive, "141#A200000010270000")
    drive.step(0.5)
    assert say(drive, "141#8000000000000000") == ["241#8000000000000000"]
    drive.step(0.01)
    assert drive.servo.torque_nm == 0.0


def test_silence_stops_it_and_the_first_frame_after_that_only_comes_back(
    drive: FakeMyActuator,
) -> None:
    say(drive, "141#B3000000E8030000")
    assert drive.silence_limit_s == pytest.approx(1.0)
    say(drive, "141#A200000010270000")
    drive.step(1.1)
    assert [text_of(message)[:6] for message in drive.frames()] == ["241#F1"]
    drive.step(0.9)
    assert not list(drive.frames())
    drive.step(0.2)
    assert [text_of(message)[:6] for message in drive.frames()] == ["241#F1"], "once a second"
    drive.step(0.01)
    assert drive.servo.torque_nm == 0.0
    assert say(drive, "141#A200000010270000") == ["241#A200000010270000"]
    drive.step(0.01)
    assert drive.servo.torque_nm == 0.0
    assert say(drive, "141#A200000010270000") != ["241#A200000010270000"]
    drive.step(0.01)
    assert drive.servo.torque_nm > 0.0


def test_some_errors_stay_until_a_restart(drive: FakeMyActuator) -> None:
    drive.fail(0x0002 | 0x0004)
    drive.fail(0)
    assert drive.errors == 0x0002
    say(drive, "141#A200000010270000")
    drive.step(0.1)
    assert drive.servo.torque_nm == 0.0
    assert say(drive, "141#7600000000000000") == []
    assert drive.errors == 0


def test_a_restart_shows_in_its_run_time(drive: FakeMyActuator) -> None:
    drive.step(2.5)
    assert say(drive, "141#B100000000000000") == ["241#B1000000C4090000"]
    drive.restart()
    drive.step(0.5)
    assert say(drive, "141#B100000000000000") == ["241#B1000000F4010000"]


def test_a_request_to_all_is_answered(drive: FakeMyActuator) -> None:
    assert say(drive, "280#8000000000000000") == ["241#8000000000000000"]


@pytest.mark.parametrize("text", ["142#9A00000000000000", "141#9A", "402#0000000000000000"])
def test_frames_of_others_do_nothing(drive: FakeMyActuator, text: str) -> None:
    assert say(drive, text) == []
    assert drive.commands == 0


def test_is_asked_for_by_name() -> None:
    fake = family_spec("RMD-X8-25:32")
    assert fake is not None
    assert fake.name == "RMD-X8-25:32"
    with pytest.raises(ValueError, match="ids 1 to 32"):
        family_spec("RMD-X8-25:33")


def test_accelerations_are_read_and_kept(drive: FakeMyActuator) -> None:
    assert say(drive, "141#4201000000000000") == ["241#42010000E8030000"]
    assert say(drive, "141#4301000010270000") == ["241#4301000010270000"]
    assert say(drive, "141#4201000000000000") == ["241#4201000010270000"]
    assert say(drive, "141#4200000000000000") == ["241#42000000E8030000"]
