"""Vectors from vedderb/bldc@b9d287b, documentation/comm_can.md, and what a VESC does by itself."""

from __future__ import annotations

import math
import struct

import can
import pytest

from rc10.fakes import cli
from rc10.fakes.drives import Drives
from rc10.fakes.fake import EXTENDED
from rc10.fakes.families import family_spec
from rc10.fakes.vesc import NOTIFY_BOOT, SET_CURRENT, SET_RPM, STATUS, STATUS_5, FakeVesc

ASK_FAULT = "00 00 80 00"
ASK_STATUS = "00 20 00 00"


def frame(arbitration_id: int, data: str, *, extended: bool = True) -> can.Message:
    return can.Message(
        arbitration_id=arbitration_id, is_extended_id=extended, data=bytes.fromhex(data)
    )


def run(vesc: FakeVesc, seconds: float, *, again: can.Message | None = None) -> list[can.Message]:
    sent = []
    for tick in range(round(seconds * 1000)):
        if again is not None and tick % 10 == 0:
            vesc.decode_command(again)
        vesc.step(0.001)
        sent += list(vesc.frames())
    return sent


@pytest.mark.parametrize(
    ("arbitration_id", "data", "packet", "value"),
    [
        (0x117, "00 00 C7 38", 1, 51.0),
        (0x001, "FF FF 9E 58", 0, -0.25),
        (0x305, "00 00 52 08", 3, 21000.0),
        (0x401, "05 64 EB A0", 4, 90.5),
        (0xA01, "FF FF 3C B0", 10, -0.5),
        (0xC01, "00 00 13 88", 12, 5.0),
        # The hazard: padded to 8 bytes, a current of 1 A is read as another one.
        (0x101, "00 00 03 E8 00 00 00 00", 1, 65536.0),
    ],
)
def test_commands_are_those_of_the_firmware(
    arbitration_id: int, data: str, packet: int, value: float
) -> None:
    vesc = FakeVesc(arbitration_id & 0xFF)
    assert vesc.decode_command(frame(arbitration_id, data))
    assert vesc.packet == packet
    assert vesc.command == pytest.approx(value)
    assert vesc.commands == 1


def test_frames_of_others_are_not_for_it() -> None:
    vesc = FakeVesc(7)
    for other in (
        frame(0x108, "00 00 03 E8"),
        frame(0x107, "00 00 03 E8", extended=False),
        frame(0x907, "00 00 00 00 00 00 00 00"),
        frame(0x107, "00 00"),
        frame(0x10107, "00 00 03 E8"),
    ):
        assert not vesc.decode_command(other)
    assert vesc.commands == 0
    assert vesc.decode_command(frame(0x1FF, "00 00 03 E8"))


def test_a_ping_is_answered_to_the_one_who_asked() -> None:
    vesc = FakeVesc(7)
    assert vesc.decode_command(frame(0x1107, "42"))
    (pong,) = vesc.frames()
    assert (pong.arbitration_id, bytes(pong.data)) == (0x1242, b"\x07\x00")


def test_status_frames_have_the_layout_of_the_document() -> None:
    vesc = FakeVesc(7, pole_pairs=21)
    vesc.angle_rad = 100 * math.tau
    assert vesc.status_5() == bytes.fromhex("00 00 31 38 00 F0 00 00")
    vesc.speed_rad_s = -12345 / 21 / 60 * math.tau
    vesc.current_a, vesc.duty = 15.7, -0.432
    assert struct.unpack(">ihh", vesc.status()) in {(-12345, -157, -432), (-12344, -157, -432)}
    vesc.angle_rad = math.radians(90.1)
    assert struct.unpack(">hhhh", vesc.status_4())[3] in {4504, 4505}


def test_a_fault_is_told_when_asked_and_goes_by_itself() -> None:
    vesc = FakeVesc(7)
    vesc.inject_fault(4)
    assert vesc.decode_command(frame(0x807, f"FD 00 32 {ASK_FAULT}"))
    (answer,) = vesc.frames()
    assert answer.arbitration_id == 0x8FD
    assert bytes(answer.data) == bytes.fromhex(f"07 01 32 {ASK_FAULT} 04")
    run(vesc, 0.3, again=frame(0x107, "00 00 13 88"))
    assert vesc.current_a == 0.0
    run(vesc, 0.3, again=frame(0x107, "00 00 13 88"))
    assert vesc.fault == 0
    assert vesc.current_a == pytest.approx(5.0)


def test_its_watchdog_lets_the_motor_go_and_it_says_so() -> None:
    vesc = FakeVesc(7)
    assert vesc.timed_out  # switched on long ago, and nobody has commanded it
    vesc.decode_command(frame(0x307, "00 00 2E E0"))
    run(vesc, 0.9)
    assert not vesc.timed_out
    assert vesc.packet == SET_RPM
    run(vesc, 0.2)
    assert vesc.timed_out
    assert (vesc.packet, vesc.command) == (SET_CURRENT, 0.0)
    assert vesc.decode_command(frame(0x807, f"FD 00 32 {ASK_STATUS}"))
    assert list(vesc.frames())[-1].data[7] == 1


def test_a_speed_is_reached_and_feedback_comes_in_its_rhythm() -> None:
    vesc = FakeVesc(7, rate_hz=100.0)
    sent = run(vesc, 2.0, again=frame(0x307, "00 00 1B 58"))
    assert vesc.velocity_rpm == pytest.approx(1000.0, abs=10.0)
    by_packet = [message.arbitration_id >> 8 for message in sent]
    assert by_packet.count(STATUS) == by_packet.count(STATUS_5)
    assert 199 <= by_packet.count(STATUS) <= 201
    assert all(message.is_extended_id for message in sent)


def test_below_its_least_speed_it_lets_go() -> None:
    vesc = FakeVesc(7)
    run(vesc, 0.1, again=frame(0x307, "00 00 01 00"))
    assert vesc.current_a == 0.0


def test_a_brake_stops_and_never_pushes() -> None:
    vesc = FakeVesc(7)
    vesc.speed_rad_s = 100.0
    run(vesc, 1.0, again=frame(0x207, "00 00 27 10"))
    assert vesc.speed_rad_s == pytest.approx(0.0, abs=0.1)


def test_a_reboot_is_told_and_the_counter_begins_anew() -> None:
    vesc = FakeVesc(7)
    vesc.angle_rad = 55.0
    vesc.reboot()
    assert [message.arbitration_id for message in vesc.frames()] == [NOTIFY_BOOT << 8 | 7]
    assert struct.unpack_from(">i", vesc.status_5())[0] == 0


def test_the_command_line_takes_it_beside_dji_motors() -> None:
    options = cli._parser().parse_args(
        ["--motor", "VESC:7", "--motor", "M3508:1", "--load-nm", "VESC:7=0.1"]
    )
    drives = cli.build_drives(options)
    assert [motor.name for motor in drives.motors] == ["VESC:7", "M3508:1"]
    drives.receive(frame(0x107, "00 00 03 E8"))
    drives.receive(frame(0x107, "00 00 07 D0", extended=False))
    assert drives.motors[0].command == 1.0
    drives.step(0.001)
    ids = {message.arbitration_id for message in drives.feedback()}
    assert ids == {0x907, 0x1B07, 0x1007, 0x201}
    assert EXTENDED | 0x107 in drives.command_ids


def test_two_with_one_id_are_refused() -> None:
    with pytest.raises(ValueError, match="VESC:7"):
        Drives([FakeVesc(7), FakeVesc(7)])


@pytest.mark.parametrize("text", ["VESC", "VESC:x", "VESC:255", "VESC:1:2"])
def test_impossible_ones_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="VESC"):
        family_spec(text)


def test_a_motor_without_pole_pairs_is_refused() -> None:
    with pytest.raises(ValueError, match="pole pairs"):
        FakeVesc(7, pole_pairs=0)
