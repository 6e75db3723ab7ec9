"""Vectors from the manuals of C620 V1.01, C610 and GM6020 v1.2, and the limits of their fields."""

from __future__ import annotations

import math

import can
import pytest

from rc10.fakes import FakeMotor, MotorSpec

RAD_S_PER_RPM = math.tau / 60.0


def motor(text: str) -> FakeMotor:
    return FakeMotor(MotorSpec.parse(text))


def frame(arbitration_id: int, data: str, **flags: bool) -> can.Message:
    return can.Message(
        arbitration_id=arbitration_id,
        is_extended_id=flags.pop("is_extended_id", False),
        data=bytes.fromhex(data),
        **flags,
    )


@pytest.mark.parametrize(
    ("arbitration_id", "data", "expected"),
    [
        (
            0x200,
            "20 00 F0 00 00 00 40 00",
            {"M3508:1": 10.0, "M3508:2": -5.0, "M3508:3": 0.0, "M3508:4": 20.0},
        ),
        (0x1FF, "09 C4 D8 F0 00 00 00 00", {"M2006:5": 2.5, "M2006:6": -10.0, "M2006:7": 0.0}),
        (
            0x1FF,
            "30 D4 9E 58 00 00 00 00",
            {"GM6020:1:voltage": 12.0, "GM6020:2:voltage": -24.0, "GM6020:4:voltage": 0.0},
        ),
        (
            0x2FE,
            "15 55 00 00 C0 00 00 00",
            {"GM6020:5": 0.9999, "GM6020:6": 0.0, "GM6020:7": -3.0},
        ),
        # Not vectors of the document: the two groups that it has none for, by the same rules.
        (0x2FF, "30 D4 00 00 9E 58 00 00", {"GM6020:5:voltage": 12.0, "GM6020:7:voltage": -24.0}),
        (0x1FE, "00 00 20 00 00 00 40 00", {"GM6020:2": 1.5, "GM6020:4": 3.0}),
    ],
)
def test_commands_are_those_of_the_manuals(
    arbitration_id: int, data: str, expected: dict[str, float]
) -> None:
    for text, command in expected.items():
        fake = motor(text)
        assert fake.decode_command(frame(arbitration_id, data))
        assert fake.command == pytest.approx(command, abs=5e-5)
        assert fake.commands == 1


def test_the_last_two_bytes_of_the_short_groups_are_nobodys() -> None:
    for arbitration_id, kind in ((0x2FF, ":voltage"), (0x2FE, "")):
        for motor_id in (5, 6, 7):
            fake = motor(f"GM6020:{motor_id}{kind}")
            fake.decode_command(frame(arbitration_id, "00 00 00 00 00 00 40 00"))
            assert fake.command == 0.0


@pytest.mark.parametrize(
    ("text", "rotor_count", "rotor_rpm", "current_a", "temperature_c", "arbitration_id", "data"),
    [
        ("M3508:3", 4096, -3000, 1.9995, 45.2, 0x203, "10 00 F4 48 06 66 2D 00"),
        ("M2006:6", 8191, 4800, -1.5, 61.0, 0x206, "1F FF 12 C0 FA 24 00 00"),
        ("GM6020:7", 2048, 120, 0.75, 37.9, 0x20B, "08 00 00 78 10 00 26 00"),
    ],
)
def test_feedback_is_that_of_the_manuals(
    text: str,
    rotor_count: int,
    rotor_rpm: float,
    current_a: float,
    temperature_c: float,
    arbitration_id: int,
    data: str,
) -> None:
    fake = motor(text)
    fake.rotor_turns = rotor_count / 8192
    fake.speed_rad_s = rotor_rpm * RAD_S_PER_RPM / fake.spec.model.gear_ratio
    fake.current_a = current_a
    fake.temperature_c = temperature_c
    message = fake.feedback()
    assert message.arbitration_id == arbitration_id
    assert not message.is_extended_id
    assert message.dlc == 8
    assert message.data == bytes.fromhex(data)


def test_output_values_are_behind_the_gear() -> None:
    fake = motor("M3508:3")
    fake.speed_rad_s = -16.3597
    assert fake.velocity_rpm == pytest.approx(-156.2239, abs=1e-3)
    fake = motor("GM6020:7")
    fake.rotor_turns = 0.25
    assert fake.angle_deg == 90.0


@pytest.mark.parametrize(
    ("text", "raw", "command"),
    [
        ("M3508:1", "7F FF", 20.0),
        ("M3508:1", "80 00", -20.0),
        ("M2006:1", "27 11", 10.0),
        ("M2006:1", "80 00", -10.0),
        ("GM6020:1", "7F FF", 3.0),
        # The older limit of 30000 gives no more than the supply does.
        ("GM6020:1:voltage", "75 30", 24.0),
        ("GM6020:1:voltage", "8A D0", -24.0),
    ],
)
def test_commands_saturate_at_the_drives_limit(text: str, raw: str, command: float) -> None:
    fake = motor(text)
    assert fake.decode_command(frame(fake.address.command_id, raw + "00 00 00 00 00 00"))
    assert fake.command == pytest.approx(command)


@pytest.mark.parametrize(
    ("rotor_rpm", "current_a", "temperature_c", "data"),
    [
        (40000.0, 90.0, 300.0, "7F FF 7F FF FF"),
        (-40000.0, -90.0, -10.0, "80 00 80 00 00"),
    ],
)
def test_feedback_fields_saturate(
    rotor_rpm: float, current_a: float, temperature_c: float, data: str
) -> None:
    fake = motor("M3508:1")
    fake.speed_rad_s = rotor_rpm * RAD_S_PER_RPM / fake.spec.model.gear_ratio
    fake.current_a = current_a
    fake.temperature_c = temperature_c
    assert fake.feedback().data[2:7] == bytes.fromhex(data)


@pytest.mark.parametrize(
    "other",
    [
        frame(0x1FF, "20 00 00 00 00 00 00 00"),
        frame(0x201, "20 00 00 00 00 00 00 00"),
        frame(0x200, "20 00 00 00 00 00 00 00", is_extended_id=True),
        frame(0x200, "20 00 00 00 00 00 00 00", is_error_frame=True),
        can.Message(arbitration_id=0x200, is_extended_id=False, is_remote_frame=True, dlc=8),
        frame(0x200, "20 00 00 00 00 00 00"),
        frame(0x200, ""),
        # Quick id setting: not simulated.
        frame(0x700, "00 00 00 00 00 00 00 00"),
    ],
)
def test_other_frames_are_not_for_this_motor(other: can.Message) -> None:
    fake = motor("M3508:1")
    assert not fake.decode_command(other)
    assert (fake.command, fake.commands) == (0.0, 0)


def test_the_output_encoder_of_a_gm6020_starts_where_the_shaft_is() -> None:
    fake = FakeMotor(MotorSpec.parse("GM6020:5"), initial_angle_deg=270.0)
    assert fake.feedback().data[:2] == bytes([6144 >> 8, 6144 & 255])
    assert FakeMotor(MotorSpec.parse("GM6020:5"), initial_angle_deg=-90.0).feedback().data[
        :2
    ] == bytes([6144 >> 8, 6144 & 255])


def test_the_rotor_encoder_of_a_geared_motor_shows_only_part_of_the_angle() -> None:
    gear = 36.0
    a = FakeMotor(MotorSpec.parse("M2006:1"), initial_angle_deg=3.0)
    b = FakeMotor(MotorSpec.parse("M2006:1"), initial_angle_deg=3.0 + 5 * 360.0 / gear)
    assert a.feedback().data == b.feedback().data


def test_the_feedback_frame_is_reused() -> None:
    fake = motor("M3508:1")
    assert fake.feedback() is fake.feedback()
