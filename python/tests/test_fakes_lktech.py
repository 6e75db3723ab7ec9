"""Vectors from LK-Tech's motor CAN protocol V2.35, and what a drive does."""

from __future__ import annotations

import pytest

from frame_text import say
from rc10.fakes.families import family_spec
from rc10.fakes.lktech import LKTECH_MODELS, FakeLKTech, LKTechSpec

MODELS = {model.name: model for model in LKTECH_MODELS}


def make(name: str, motor_id: int) -> FakeLKTech:
    return LKTechSpec(MODELS[name], motor_id).make()


@pytest.fixture
def drive() -> FakeLKTech:
    return make("LK-MF9025", 1)


def test_reports_the_published_reading(drive: FakeLKTech) -> None:
    drive.servo.temperature_c = 40.0
    drive.servo.torque_nm = 248 * 33 / 4096 * 0.32
    drive.servo.speed_deg_s = -360.0
    drive.servo.angle_deg = 270.0
    assert say(drive, "141#A1000000F8000000") == ["141#A128F80098FE00C0"]


@pytest.mark.parametrize(("name", "amperes"), [("LK-MF9025", -4.0283), ("LK-MG6012E-i8", -8.0566)])
def test_a_raw_current_means_another_current_for_mf_and_mg(name: str, amperes: float) -> None:
    drive = make(name, 1)
    say(drive, "141#A10000000CFE0000")
    drive.step(0.005)
    assert drive.current_a == pytest.approx(amperes, abs=1e-3)


@pytest.mark.parametrize(("motor_id", "raw"), [(1, 100), (2, -200), (3, 300), (4, -2000)])
def test_the_frame_of_four_has_a_current_for_each(motor_id: int, raw: int) -> None:
    drive = make("LK-MG6012E-i8", motor_id)
    (reply,) = say(drive, "280#640038FF2C0130F8")
    assert reply.startswith(f"{0x140 + motor_id:03X}#A1")
    drive.step(0.001)
    wanted = max(-16.0, min(16.0, raw * 66 / 4096 * 1.09))
    assert drive.servo.torque_nm == pytest.approx(wanted, abs=0.01)


def test_an_id_beyond_four_leaves_the_frame_of_four_alone() -> None:
    drive = make("LK-MF9025", 5)
    assert say(drive, "280#640038FF2C0130F8") == []


def test_goes_to_the_published_angle() -> None:
    drive = make("LK-MF9025", 2)
    say(drive, "142#A40068016073FFFF")
    drive.step(3.0)
    assert drive.servo.angle_deg == pytest.approx(-360.0, abs=1.0)


def test_speeds_are_those_of_the_rotor() -> None:
    drive = make("LK-MG5010E-i10", 1)
    say(drive, "141#A200000028230000")
    drive.step(1.0)
    assert drive.servo.speed_deg_s == pytest.approx(9.0, abs=0.2)


def test_an_angle_is_that_of_the_rotor_and_has_seven_bytes() -> None:
    drive = make("LK-MG5010E-i10", 1)
    drive.servo.angle_deg = -36.0
    assert say(drive, "141#9200000000000000") == ["141#926073FFFFFFFFFF"]


def test_off_it_answers_and_does_nothing_and_has_forgotten_its_turns(drive: FakeLKTech) -> None:
    drive.servo.angle_deg = 730.0
    assert say(drive, "141#8000000000000000") == ["141#8000000000000000"]
    assert drive.servo.angle_deg == pytest.approx(10.0)
    say(drive, "141#A1000000F4010000")
    drive.step(0.01)
    assert drive.servo.torque_nm == 0.0
    assert say(drive, "141#9A00000000000000") == ["141#9A19600900001000"]
    say(drive, "141#8800000000000000")
    assert say(drive, "141#9A00000000000000") == ["141#9A19600900000000"]


def test_an_error_stays_until_it_is_cleared_after_its_cause(drive: FakeLKTech) -> None:
    drive.fail(0x08)
    assert say(drive, "141#9B00000000000000")[0].endswith("08")
    drive.fail(0)
    assert say(drive, "141#9A00000000000000")[0].endswith("08")
    assert say(drive, "141#9B00000000000000")[0].endswith("00")


@pytest.mark.parametrize("text", ["142#9A00000000000000", "141#9A", "240#0000000000000000"])
def test_frames_of_others_do_nothing(drive: FakeLKTech, text: str) -> None:
    assert say(drive, text) == []


def test_is_asked_for_by_name() -> None:
    fake = family_spec("LK-MF9025:4")
    assert fake is not None
    assert fake.name == "LK-MF9025:4"
    with pytest.raises(ValueError, match="ids 1 to 32"):
        family_spec("LK-MF9025:0")
