"""Vectors and rules from the manuals DM-J4310-2EC V1.2 and DM-J3507-2EC V1.1."""

from __future__ import annotations

import math
import struct

import can
import pytest

from rc10.fakes.cli import _parser, build_drives
from rc10.fakes.damiao import (
    COMMUNICATION_LOST,
    DISABLED,
    ENABLED,
    DamiaoSpec,
    FakeDamiao,
    Register,
    from_code,
    to_code,
)

ENABLE = "FF FF FF FF FF FF FF FC"
DISABLE = "FF FF FF FF FF FF FF FD"
CLEAR = "FF FF FF FF FF FF FF FB"


def drive(text: str = "DM4310:1", **options: float) -> FakeDamiao:
    return FakeDamiao(DamiaoSpec.parse(text), **options)  # type: ignore[arg-type]


def frame(arbitration_id: int, data: str, **flags: bool) -> can.Message:
    return can.Message(
        arbitration_id=arbitration_id,
        is_extended_id=flags.pop("is_extended_id", False),
        data=bytes.fromhex(data),
        **flags,
    )


def tell(fake: FakeDamiao, arbitration_id: int, data: str) -> list[str]:
    """Sends a frame and returns the answers."""
    assert fake.decode_command(frame(arbitration_id, data))
    return [
        f"{answer.arbitration_id:03X}#{bytes(answer.data).hex().upper()}"
        for answer in fake.frames()
    ]


def set_mode(fake: FakeDamiao, mode: int) -> None:
    tell(fake, 0x7FF, f"{fake.spec.can_id:02X} 00 55 0A {mode:02X} 00 00 00")


def enable(fake: FakeDamiao, mode: int = 1) -> None:
    set_mode(fake, mode)
    tell(fake, fake.spec.can_id, ENABLE)
    assert fake.status == ENABLED


def test_a_mit_command_is_decoded_as_in_the_manual() -> None:
    fake = drive()
    enable(fake)
    tell(fake, 0x001, "8A 3C 77 70 A3 19 9A 65")
    assert fake.target.position_rad == pytest.approx(0.99966, abs=1e-5)
    assert fake.target.velocity_rad_s == pytest.approx(-2.0, abs=1e-5)
    assert fake.target.kp == pytest.approx(19.9023, abs=1e-4)
    assert fake.target.kd == pytest.approx(0.49939, abs=1e-5)
    assert fake.target.torque_nm == pytest.approx(2.99634, abs=1e-5)


def test_a_command_of_zeros_is_almost_no_torque() -> None:
    fake = drive()
    enable(fake)
    tell(fake, 0x001, "7F FF 7F F0 00 00 07 FF")
    assert fake.target.velocity_rad_s == pytest.approx(-0.00733, abs=1e-5)
    assert fake.target.torque_nm == pytest.approx(-0.00244, abs=1e-5)
    fake.step(0.5)
    assert fake.speed_rad_s == 0.0


def test_commands_of_other_modes_are_decoded() -> None:
    fake = drive()
    enable(fake, 2)
    tell(fake, 0x101, "00 00 C0 3F 00 00 40 40")
    assert (fake.target.position_rad, fake.target.velocity_rad_s) == (1.5, 3.0)
    set_mode(fake, 3)
    tell(fake, 0x201, "DB 0F C9 C0")
    assert fake.target.velocity_rad_s == pytest.approx(-math.tau)
    tell(fake, 0x201, "DB 0F C9 40 00 00 00 00")
    assert fake.target.velocity_rad_s == pytest.approx(math.tau)
    set_mode(fake, 4)
    tell(fake, 0x301, "00 00 40 3F F4 01 C4 09")
    assert fake.target.position_rad == 0.75
    assert fake.target.velocity_rad_s == pytest.approx(5.0)
    assert fake.target.current_pu == pytest.approx(0.25)


def test_feedback_is_that_of_the_manual() -> None:
    fake = drive()
    enable(fake)
    fake.angle_rad, fake.speed_rad_s = -3.14164 + 1e-5, 3.99267 + 1e-5
    fake.current_a = (-1.25275 + 1e-5) / 0.945
    fake.temperature_c = 31.0
    data = bytearray(fake.feedback())
    data[6] = 36
    assert data == bytes.fromhex("11 5F D4 91 06 FF 24 1F")
    lost = drive("DM4310:2")
    lost.fail(COMMUNICATION_LOST)
    assert lost.feedback()[0] == 0xD2


def test_registers_are_read_and_written_as_in_the_manual() -> None:
    fake = drive()
    assert tell(fake, 0x7FF, "01 00 33 15 00 00 00 00") == ["011#0100331500004841"]
    assert tell(fake, 0x7FF, "01 00 55 0A 02 00 00 00") == ["011#0100550A02000000"]
    assert tell(fake, 0x7FF, "01 00 55 09 D0 07 00 00") == ["011#01005509D0070000"]
    assert fake.registers[Register.CTRL_MODE] == 2
    assert fake.registers[Register.TIMEOUT] == 2000
    assert not fake.decode_command(frame(0x7FF, "02 00 33 15 00 00 00 00"))


def test_a_write_that_is_not_allowed_is_not_answered() -> None:
    fake = drive()
    assert tell(fake, 0x7FF, "01 00 55 0A 07 00 00 00") == []
    assert tell(fake, 0x7FF, "01 00 55 14 00 00 80 3F") == []
    assert fake.registers[Register.CTRL_MODE] == 1


def test_it_speaks_only_when_asked_and_once_for_each_frame() -> None:
    fake = drive()
    fake.step(0.1)
    assert list(fake.frames()) == []
    assert len(tell(fake, 0x001, DISABLE)) == 1
    # Whatever ends in its id is meant for it.
    assert len(tell(fake, 0x601, "00")) == 1
    assert not fake.decode_command(frame(0x002, DISABLE))
    assert not fake.decode_command(frame(0x001, DISABLE, is_extended_id=True))


def test_targets_of_another_mode_are_ignored() -> None:
    fake = drive()
    enable(fake, 1)
    tell(fake, 0x201, "00 00 C0 40")
    fake.step(0.5)
    assert fake.speed_rad_s == 0.0


def test_a_target_from_before_enabling_acts_then() -> None:
    # Which is why a host must not send one.
    fake = drive()
    set_mode(fake, 3)
    tell(fake, 0x201, "00 00 C0 40")
    fake.step(0.2)
    assert fake.speed_rad_s == 0.0
    tell(fake, 0x001, ENABLE)
    fake.step(0.5)
    assert fake.speed_rad_s == pytest.approx(6.0, abs=0.1)
    tell(fake, 0x001, DISABLE)
    fake.step(2.0)
    assert fake.speed_rad_s == 0.0


def test_the_watchdog_counts_while_enabled_and_registers_do_not_feed_it() -> None:
    fake = drive()
    tell(fake, 0x7FF, "01 00 55 09 D0 07 00 00")
    fake.step(1.0)
    assert fake.status == DISABLED
    enable(fake, 3)
    for _ in range(9):
        tell(fake, 0x201, "00 00 C0 40")
        fake.step(0.09)
    assert fake.status == ENABLED
    fake.step(0.02)
    assert fake.status == COMMUNICATION_LOST
    assert fake.current_a == 0.0
    enable_again = tell(fake, 0x001, ENABLE)
    assert enable_again[0].startswith("011#D1"), "latched"
    assert tell(fake, 0x001, DISABLE)[0].startswith("011#D1")
    assert tell(fake, 0x001, CLEAR)[0].startswith("011#01")
    assert tell(fake, 0x001, ENABLE)[0].startswith("011#11")


def test_every_mode_reaches_its_target() -> None:
    fake = drive("DM8009:3", initial_angle_deg=30.0)
    enable(fake, 2)
    tell(fake, 0x103, struct.pack("<ff", 10.0, 8.0).hex())
    fake.step(4.0)
    assert fake.angle_rad == pytest.approx(10.0, abs=0.01)
    set_mode(fake, 4)
    tell(fake, 0x303, struct.pack("<fHH", -2.0, 500, 5000).hex())
    fake.step(5.0)
    assert fake.angle_rad == pytest.approx(-2.0, abs=0.01)
    set_mode(fake, 3)
    tell(fake, 0x203, struct.pack("<f", 5.0).hex())
    fake.step(2.0)
    assert fake.speed_rad_s == pytest.approx(5.0, abs=0.05)


def test_the_position_field_wraps_and_the_register_does_not() -> None:
    fake = drive()
    fake.angle_rad = 20.0
    data = fake.feedback()
    assert from_code(data[1] << 8 | data[2], 12.5, 16) == pytest.approx(-5.0, abs=1e-3)
    (answer,) = tell(fake, 0x7FF, "01 00 33 51 00 00 00 00")
    assert struct.unpack("<f", bytes.fromhex(answer[-8:])) == (20.0,)


def test_a_restart_forgets_turns_modes_and_watchdog() -> None:
    fake = drive()
    enable(fake, 3)
    fake.angle_rad = 20.0
    fake.restart()
    assert fake.status == DISABLED
    assert fake.angle_rad == pytest.approx(20.0 - 3 * math.tau)
    assert fake.registers[Register.CTRL_MODE] == 1
    assert fake.registers[Register.TIMEOUT] == 0


def test_registers_are_kept_over_a_restart_once_they_are_saved() -> None:
    fake = drive("DM4310:3:19")
    for address in (0, 2, 3, 4, 5, 6, 29):
        (answer,) = tell(fake, 0x7FF, f"03 00 55 {address:02X} 00 00 20 41")
        assert answer == f"013#03 00 55 {address:02X} 00 00 20 41".replace(" ", "")
    tell(fake, 0x7FF, "03 00 55 09 D0 07 00 00")
    tell(fake, 0x7FF, "03 00 55 08 05 00 00 00")
    enable(fake, 3)
    assert tell(fake, 0x7FF, "03 00 AA 01 00 00 00 00") == [], "enabled"
    tell(fake, 0x003, "FF FF FF FF FF FF FF FD")
    assert tell(fake, 0x7FF, "03 00 AA 01 00 00 00 00") == ["013#0300AA0100000000"]
    fake.restart()
    assert fake.registers[Register.TIMEOUT] == 2000
    assert fake.registers[Register.OV] == 10.0
    assert not fake.decode_command(frame(0x7FF, "03 00 33 1D 00 00 00 00"))
    assert tell(fake, 0x7FF, "05 00 33 1D 00 00 00 00") == ["013#0500331D00002041"]


@pytest.mark.parametrize(("limit", "bits"), [(12.5, 16), (30.0, 12), (10.0, 12)])
def test_codes_come_back_within_a_step(limit: float, bits: int) -> None:
    step = 2 * limit / ((1 << bits) - 1)
    for share in range(-100, 101):
        value = limit * share / 100
        assert abs(from_code(to_code(value, limit, bits), limit, bits) - value) <= step * 1.001


def test_above_1_mbit_it_speaks_fd_and_else_it_does_not_hear_fd() -> None:
    fast, classic = drive("DM4310:1:17:fd"), drive("DM4310:1:17")
    question = frame(0x001, DISABLE, is_fd=True, bitrate_switch=True)
    assert fast.decode_command(question)
    (answer,) = fast.frames()
    assert answer.is_fd
    assert answer.bitrate_switch
    assert not classic.decode_command(question)
    assert list(classic.frames()) == []


@pytest.mark.parametrize(
    "text",
    [
        "DM9999:1",
        "DM4310",
        "DM4310:0",
        "DM4310:16",
        "DM4310:x",
        "DM4310:1:257",
        "DM4310:1:2047",
        "DM4310:1:fd",
    ],
)
def test_drives_that_there_cannot_be_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=text.split(":")[0]):
        DamiaoSpec.parse(text)


def test_the_command_line_takes_them_beside_others() -> None:
    options = _parser().parse_args(
        ["--motor", "M3508:1", "--motor", "DM4310:2:0", "--motor", "DM4340:3:0"]
    )
    drives = build_drives(options)
    assert [motor.name for motor in drives.motors] == ["M3508:1", "DM4310:2", "DM4340:3"]
    drives.receive(frame(0x002, DISABLE))
    drives.step(0.001)
    assert [message.arbitration_id for message in drives.feedback()] == [0x201, 0x000]


def test_two_drives_that_cannot_be_told_apart_are_refused() -> None:
    options = _parser().parse_args(["--motor", "DM4310:2", "--motor", "DM4340:2"])
    with pytest.raises(ValueError, match="DM4310:2 and DM4340:2"):
        build_drives(options)


def test_its_state_and_its_nameplate_can_be_asked_for() -> None:
    fake = drive()
    (state,) = tell(fake, 0x7FF, "01 00 CC 00")
    assert state.startswith("011#01")
    (gear,) = tell(fake, 0x7FF, "01 00 33 14 00 00 00 00")
    assert gear == "011#0100331400002041"
    for register in (1, *range(11, 21)):
        (told,) = tell(fake, 0x7FF, f"01 00 33 {register:02X} 00 00 00 00")
        assert told[:12] == f"011#010033{register:02X}"
        assert tell(fake, 0x7FF, f"01 00 55 {register:02X} 00 00 80 3F") == []
