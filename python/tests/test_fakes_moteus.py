"""Vectors from moteus@db1a762, docs/protocol/can.md; modes and watchdog."""

from __future__ import annotations

import math
import random
import socket
import struct

import can
import pytest
from can.interfaces.socketcan.socketcan import build_can_frame, dissect_can_frame

from rc10.fakes.drives import Drives
from rc10.fakes.families import family_spec
from rc10.fakes.moteus import (
    BRAKE,
    FAULT,
    POSITION,
    STOPPED,
    TIMEOUT,
    FakeMoteus,
    MoteusSpec,
)
from rc10.fakes.moteus_frames import ProtocolError, pad, parse, reply
from rc10.fakes.port import SocketPort

QUERY = "1100 1F01 1504 130D"


def frame(data: str | bytes, arbitration_id: int = 0x8001, **flags: bool) -> can.Message:
    payload = bytes.fromhex(data) if isinstance(data, str) else data
    return can.Message(
        arbitration_id=arbitration_id,
        is_extended_id=flags.pop("is_extended_id", True),
        is_fd=flags.pop("is_fd", True),
        bitrate_switch=flags.pop("bitrate_switch", True),
        data=pad(payload),
        **flags,
    )


def command(velocity_rev_s: float = 0.0, position_rev: float = math.nan, tail: str = "") -> bytes:
    """Position mode without limits, with a watchdog of 50 ms."""
    values = struct.pack("<ff", position_rev, velocity_rev_s)
    return bytes.fromhex("01000A 0E20") + values + bytes.fromhex("0128FF 0527 3200" + tail)


def ask(fake: FakeMoteus, data: str | bytes = QUERY) -> can.Message:
    fake.decode_command(frame(data))
    (answer,) = fake.answers()
    return answer


def run(fake: FakeMoteus, seconds: float, data: str | bytes | None = None) -> None:
    for _ in range(round(seconds * 1000)):
        if data is not None:
            fake.decode_command(frame(data))
        fake.step(0.001)
    fake.answers()


def enabled() -> FakeMoteus:
    fake = FakeMoteus(1)
    run(fake, 0.02, command())
    assert fake.mode == POSITION
    return fake


def test_the_librarys_position_command() -> None:
    fake = FakeMoteus(1)
    data = "01000A 0E20 0000803F 00000040 1100 1F01 130D"
    assert len(pad(bytes.fromhex(data))) == 20
    answer = ask(fake, data)
    assert fake.registers[0x020] == 1.0
    assert fake.registers[0x021] == 2.0
    # Read before the command acts: still stopped.
    assert bytes(answer.data[:3]) == bytes.fromhex("210000")


def test_the_documents_command() -> None:
    fake = FakeMoteus(1)
    ask(fake, "01000A 0720 6000 2001 50FF 140400 130D")
    assert fake.registers[0x020] == pytest.approx(0.0096)
    assert fake.registers[0x021] == pytest.approx(0.072)
    assert fake.registers[0x022] == pytest.approx(-1.76)


def test_the_documents_reply() -> None:
    fake = FakeMoteus(1)
    fake.mode, fake.position_rev, fake.velocity_rev_s, fake.torque_nm = 10, 0.0080, 0.064, -1.44
    fake.voltage_v, fake.temperature_c = 12.0, 20.0
    answer = ask(fake, "140400 130D")
    assert answer.arbitration_id == 0x100
    assert not answer.is_extended_id
    assert answer.is_fd
    assert answer.bitrate_switch
    assert bytes(answer.data) == bytes.fromhex("2404000A005000000170FF230D181400")


def test_a_drive_brakes_stops_and_answers_the_shortest_query() -> None:
    fake = enabled()
    fake.decode_command(frame("01000F"))
    assert fake.mode == BRAKE
    fake.decode_command(frame("010000"))
    assert fake.mode == STOPPED
    fake.answers()
    assert bytes(ask(fake, "1100110F").data) == bytes.fromhex("210000210F00")


def test_a_classic_question_has_a_classic_answer() -> None:
    fake = FakeMoteus(9)
    fake.decode_command(frame("1100110F", 0x8009, is_fd=False, bitrate_switch=False))
    (answer,) = fake.answers()
    assert not answer.is_fd
    assert answer.arbitration_id == 0x900
    assert answer.is_extended_id


def test_who_is_meant() -> None:
    fake = FakeMoteus(5, prefix=3)
    for identifier, extended, heard in (
        (0x38005, True, True),
        (0x8005, True, False),
        (0x8105, False, False),
        (0x38006, True, False),
    ):
        if extended or identifier <= 0x7FF:
            fake.decode_command(frame("010000", identifier, is_extended_id=extended))
            assert bool(fake.answers()) == heard
    fake.decode_command(frame("010000", 0x105, is_extended_id=False))
    assert fake.commands == 2
    assert not fake.answers(), "bit 15 asks for an answer"


def test_positions_velocities_and_torques() -> None:
    fake = enabled()
    run(fake, 1.0, command(velocity_rev_s=3.0))
    assert fake.velocity_rev_s == pytest.approx(3.0, abs=0.05)
    run(fake, 1.0, command(position_rev=2.5))
    assert fake.position_rev == pytest.approx(2.5, abs=0.01)
    # No gains, 0.1 N·m of feed-forward.
    run(fake, 0.002, "01000A 0D22 CDCCCC3D 022300 00 0128FF")
    assert fake.torque_nm == pytest.approx(0.1, abs=1e-3)


def test_the_torque_is_bounded_as_told() -> None:
    fake = enabled()
    for _ in range(50):
        fake.decode_command(frame(command(velocity_rev_s=400.0, tail="0D25 CDCCCC3D")))
        fake.step(0.001)
        assert abs(fake.torque_nm) <= 0.1 + 1e-6


def test_the_watchdog_latches_until_a_stop() -> None:
    fake = enabled()
    run(fake, 0.3, command(velocity_rev_s=3.0))
    run(fake, 0.045)
    assert fake.mode == POSITION
    run(fake, 0.01)
    assert fake.mode == TIMEOUT
    run(fake, 1.0, command(velocity_rev_s=3.0))
    assert fake.mode == TIMEOUT
    assert fake.velocity_rev_s == pytest.approx(0.0, abs=0.05)
    run(fake, 0.001, "010000")
    assert fake.mode == STOPPED


def test_a_fault_latches_until_a_stop() -> None:
    fake = enabled()
    fake.fail(35)
    run(fake, 0.1, command())
    assert (fake.mode, fake.fault) == (FAULT, 35)
    assert bytes(ask(fake, "1100110F").data) == bytes.fromhex("210001210F23")
    run(fake, 0.001, "010000")
    assert (fake.mode, fake.fault) == (STOPPED, 0)


def test_a_restart_is_seen_in_its_clock() -> None:
    fake = enabled()
    run(fake, 1.0)
    (before,) = parse(bytes(ask(fake, "1570").data))
    assert before.values[0] > 1000
    fake.restart()
    (after,) = parse(bytes(ask(fake, "1570").data))
    assert after.values[0] == 0
    assert fake.mode == STOPPED


@pytest.mark.parametrize("wire_type", [0, 1, 2])
@pytest.mark.parametrize("register", [0x001, 0x002, 0x003, 0x004, 0x00D, 0x00E, 0x023, 0x027])
def test_values_survive_and_saturate(wire_type: int, register: int) -> None:
    generator = random.Random(3)
    (subframe,) = parse(reply(wire_type, register, [1e9]))
    most = subframe.values[0]
    count = most / (127, 32767, 2147483647)[wire_type]
    for _ in range(50):
        value = generator.uniform(-most, most)
        (subframe,) = parse(reply(wire_type, register, [value]))
        # Truncated, in single precision.
        assert subframe.values[0] == pytest.approx(value, abs=count * 1.01, rel=1e-6)
    (subframe,) = parse(reply(wire_type, register, [math.nan]))
    assert math.isnan(subframe.values[0])


# The values that the firmware reads back as one count less.
@pytest.mark.parametrize("milliseconds", [63, 125, 126, 250, 252, 500, 504, 505, 509, 1000])
def test_a_watchdog_is_read_back_truncated(milliseconds: int) -> None:
    answer = ask(FakeMoteus(1), "01000A 0527" + struct.pack("<h", milliseconds).hex() + "1527")
    assert bytes(answer.data[:4]) == bytes.fromhex("2527") + struct.pack("<h", milliseconds - 1)


def test_a_watchdog_of_another_length_is_read_back_as_it_is() -> None:
    for milliseconds in (10, 50, 62, 64, 100, 200, 999):
        answer = ask(FakeMoteus(1), "01000A 0527" + struct.pack("<h", milliseconds).hex() + "1527")
        assert bytes(answer.data[:4]) == bytes.fromhex("2527") + struct.pack("<h", milliseconds)


def test_what_is_not_there_is_answered_with_an_error() -> None:
    fake = FakeMoteus(1)
    assert bytes(ask(fake, "1100 1108 110F").data) == bytes.fromhex("210000310801")
    assert bytes(ask(fake, "118202").data) == bytes.fromhex("31820201")
    assert bytes(ask(fake, "010800 010100").data) == bytes.fromhex("300801300102")
    assert [part.kind for part in parse(bytes.fromhex("300801310801"))] == ["error"] * 2


def test_its_other_modes_are_taken() -> None:
    for mode in (5, 6, 7, 8, 9, 12, 13, 15):
        fake = FakeMoteus(1)
        run(fake, 0.02, f"0100{mode:02X}")
        assert fake.mode == mode
    fake = FakeMoteus(1)
    run(fake, 0.02, "010009 051C 1E00")
    assert fake.current_a == pytest.approx(3.0)
    fake = FakeMoteus(1)
    run(fake, 1.0, "01000D 0640 1027 FF7F")
    assert fake.position_rev == pytest.approx(1.0, abs=0.05)


def test_garbage_does_nothing() -> None:
    generator = random.Random(5)
    fake = enabled()
    for _ in range(2000):
        data = generator.randbytes(generator.choice((1, 2, 5, 8, 12, 24, 64)))
        try:
            parse(data)
        except ProtocolError:
            fake.decode_command(frame(data))
            assert not fake.answers()
    assert fake.mode == POSITION


def test_it_is_asked_for_by_model_and_id() -> None:
    spec = family_spec("moteus:3")
    assert isinstance(spec, MoteusSpec)
    assert spec.make(initial_angle_deg=90.0, load_nm=0.0).angle_deg == 90.0
    for text in ("moteus", "moteus:0", "moteus:127", "moteus:x"):
        with pytest.raises(ValueError, match="moteus"):
            family_spec(text)


def test_it_answers_beside_others() -> None:
    drives = Drives([FakeMoteus(1), FakeMoteus(2)])
    assert drives.fd
    assert {"can_id": 2, "can_mask": 0x1FFF00FF, "extended": True} in drives.filters
    drives.receive(frame("01000F", 0x001, is_extended_id=False))
    assert [motor.commands for motor in drives.motors] == [1, 0], "nobody asks for an answer"
    drives.receive(frame(QUERY, 0x8002))
    drives.step(0.001)
    (answer,) = drives.feedback()
    assert answer.arbitration_id == 0x200
    assert drives.sent == {"moteus:1": 0, "moteus:2": 1}


def test_fd_frames_pass_a_socketcan_socket() -> None:
    near, far = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with near, far:
        port = SocketPort(near)
        question = frame(QUERY, 0x8008)
        far.send(build_can_frame(question))
        received = port.receive()
        assert received is not None
        assert received.equals(question, timestamp_delta=None, check_channel=False)
        fake = FakeMoteus(8)
        fake.decode_command(received)
        (answer,) = fake.answers()
        assert port.send(answer)
        can_id, length, flags, data = dissect_can_frame(far.recv(100))
        assert can_id == 0x800 | 0x80000000
        assert length == len(answer.data)
        assert flags & 1, "the bit rate switch"
        assert data == bytes(answer.data)
        # A classic frame after it leaves nothing of it.
        far.send(build_can_frame(can.Message(arbitration_id=0x200, is_extended_id=False)))
        received = port.receive()
        assert received is not None
        assert not received.is_fd
        assert not received.bitrate_switch
