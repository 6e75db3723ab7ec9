"""Vectors from ODrive@f9b5419c, docs/can-protocol.rst, and what a fake axis does."""

from __future__ import annotations

import struct

import can
import pytest

from rc10.fakes import Drives, FakeMotor, MotorSpec, check_collisions
from rc10.fakes.families import family_spec
from rc10.fakes.odrive import CLOSED_LOOP, IDLE, POSITION, TORQUE, VELOCITY, FakeOdrive, OdriveSpec


def axis(text: str = "ODrive_S1:3", **options: float) -> FakeOdrive:
    return FakeOdrive(OdriveSpec.parse(text), **options)


def frame(arbitration_id: int, data: str, **flags: bool) -> can.Message:
    return can.Message(
        arbitration_id=arbitration_id,
        is_extended_id=flags.pop("is_extended_id", False),
        data=bytes.fromhex(data),
        **flags,
    )


def mode(fake: FakeOdrive, control_mode: int) -> None:
    assert fake.decode_command(frame(0x06B, struct.pack("<ii", control_mode, 1).hex()))


def close_loop(fake: FakeOdrive, vel_limit: float = 50.0, current_limit_a: float = 20.0) -> None:
    assert fake.decode_command(frame(0x06F, struct.pack("<ff", vel_limit, current_limit_a).hex()))
    assert fake.decode_command(frame(0x067, "08 00 00 00"))


def run(fake: FakeOdrive, seconds: float) -> None:
    for _ in range(round(seconds * 1000)):
        fake.step(0.001)


def test_a_position_comes_with_its_feed_forwards() -> None:
    fake = axis()
    assert fake.decode_command(frame(0x06C, "00 00 20 40 DC 05 06 FF"))
    assert fake.input_pos == 2.5
    assert fake.input_vel == pytest.approx(1.5)
    assert fake.input_torque == pytest.approx(-0.25)


def test_a_velocity_comes_with_its_torque() -> None:
    fake = axis()
    assert fake.decode_command(frame(0x06D, "00 00 80 C0 CD CC CC 3D"))
    assert fake.input_vel == -4.0
    assert fake.input_torque == pytest.approx(0.1)


def test_axis_states_and_control_modes_are_numbers() -> None:
    fake = axis()
    assert fake.decode_command(frame(0x06B, "03 00 00 00 05 00 00 00"))
    assert (fake.control_mode, fake.input_mode) == (POSITION, 5)
    assert fake.decode_command(frame(0x067, "08 00 00 00"))
    assert fake.axis_state == CLOSED_LOOP


def test_a_heartbeat_of_v3_has_errors_and_flags() -> None:
    fake = axis("ODrive_v3:3")
    fake.errors = 0x40
    fake.motor_failed = fake.controller_failed = True
    message = fake.heartbeat()
    assert message.arbitration_id == 0x061
    assert message.data == bytes.fromhex("40 00 00 00 01 01 00 01")


def test_a_heartbeat_of_firmware_06_has_its_active_errors() -> None:
    fake = axis("ODrive_S1:3")
    fake.errors = 0x100
    message = fake.heartbeat()
    assert message.arbitration_id == 0x061
    assert message.data == bytes.fromhex("00 01 00 00 01 00 00 00")


def test_encoder_estimates_are_turns_and_turns_per_second() -> None:
    fake = axis()
    fake.turns = -0.125
    fake.speed_rad_s = 3.5 * 6.283185307179586
    message = fake.estimates()
    assert (message.arbitration_id, message.dlc, message.is_extended_id) == (0x069, 8, False)
    assert message.data == bytes.fromhex("00 00 00 BE 00 00 60 40")


@pytest.mark.parametrize(
    "other",
    [
        frame(0x087, "08 00 00 00"),
        frame(0x067, "08 00 00 00", is_extended_id=True),
        frame(0x067, "08 00 00 00", is_error_frame=True),
        can.Message(arbitration_id=0x067, is_extended_id=False, is_remote_frame=True, dlc=4),
        frame(0x067, "08 00"),
    ],
)
def test_other_frames_change_nothing(other: can.Message) -> None:
    fake = axis()
    assert not fake.decode_command(other)
    assert fake.axis_state == IDLE


def test_velocity_position_and_torque_are_reached() -> None:
    fake = axis()
    mode(fake, VELOCITY)
    close_loop(fake)
    fake.decode_command(frame(0x06D, struct.pack("<ff", 5.0, 0.0).hex()))
    run(fake, 1.0)
    assert fake.velocity_rpm == pytest.approx(300.0, abs=3.0)
    mode(fake, POSITION)
    fake.decode_command(frame(0x06C, struct.pack("<fhh", -2.0, 0, 0).hex()))
    run(fake, 2.0)
    assert fake.pos_estimate == pytest.approx(-2.0, abs=0.01)
    mode(fake, TORQUE)
    fake.decode_command(frame(0x06E, struct.pack("<f", 0.11).hex()))
    run(fake, 0.005)
    assert fake.current_a == pytest.approx(0.11 * 150 / 8.27, rel=0.01)


def test_it_keeps_to_its_limits() -> None:
    fake = axis()
    mode(fake, VELOCITY)
    close_loop(fake, vel_limit=2.0, current_limit_a=3.0)
    fake.decode_command(frame(0x06D, struct.pack("<ff", 50.0, 0.0).hex()))
    for _ in range(1000):
        fake.step(0.001)
        assert abs(fake.current_a) <= 3.0 + 1e-9
    assert fake.velocity_rpm == pytest.approx(120.0, abs=2.0)


def test_idle_has_no_torque() -> None:
    fake = axis(load_nm=0.1)
    mode(fake, VELOCITY)
    close_loop(fake)
    run(fake, 0.2)
    assert fake.current_a > 1.0
    fake.decode_command(frame(0x067, "01 00 00 00"))
    run(fake, 0.001)
    assert fake.current_a == 0.0


def test_errors_hold_until_they_are_cleared() -> None:
    fake = axis()
    close_loop(fake)
    fake.disarm(0x100)
    close_loop(fake)
    assert fake.axis_state == IDLE
    fake.decode_command(frame(0x078, "00"))
    close_loop(fake)
    assert fake.axis_state == CLOSED_LOOP


@pytest.mark.parametrize(("text", "bit"), [("ODrive_v3:3", 0x800), ("ODrive_Pro:3", 0x1000000)])
def test_a_watchdog_expires_without_frames(text: str, bit: int) -> None:
    fake = axis(text, watchdog_s=0.1)
    close_loop(fake)
    run(fake, 0.09)
    assert fake.axis_state == CLOSED_LOOP
    fake.decode_command(frame(0x06E, "00 00 00 00"))
    run(fake, 0.09)
    assert fake.axis_state == CLOSED_LOOP
    run(fake, 0.02)
    assert (fake.axis_state, fake.errors) == (IDLE, bit)


def test_an_estop_is_an_error_that_a_restart_ends() -> None:
    fake = axis()
    close_loop(fake)
    fake.decode_command(frame(0x062, ""))
    assert (fake.axis_state, fake.errors) == (IDLE, 0x2000000)
    fake.turns = 4.0
    fake.decode_command(frame(0x076, "00"))
    assert (fake.errors, fake.pos_estimate) == (0, 0.0)


@pytest.mark.parametrize(("model", "errors"), [("ODrive_S1", 1), ("ODrive_v3", 0)])
def test_a_restart_is_a_silence_and_then_a_drive_that_does_not_obey_yet(
    model: str, errors: int
) -> None:
    fake = OdriveSpec.parse(f"{model}:3").make(initial_angle_deg=0.0, load_nm=0.0)
    fake.decode_command(frame(0x076, "00"))
    fake.step(0.29)
    assert not list(fake.frames())
    fake.step(0.02)
    first = next(fake.frames())
    assert bytes(first.data)[:5] == bytes([errors, 0, 0, 0, 0])
    fake.decode_command(frame(0x067, "08 00 00 00"))
    assert fake.axis_state == IDLE
    fake.step(1.2)
    fake.decode_command(frame(0x067, "08 00 00 00"))
    assert fake.axis_state == CLOSED_LOOP


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("ODrive_S1:3", {0x061, 0x069, 0x077, 0x07C, 0x075}),
        ("ODrive_v3:3", {0x061, 0x069, 0x077, 0x074}),
    ],
)
def test_it_sends_heartbeats_every_100_ms(text: str, ids: set[int]) -> None:
    fake = axis(text)
    assert {message.arbitration_id for message in fake.frames()} == ids
    heartbeats = 0
    for _ in range(1000):
        fake.step(0.001)
        heartbeats += sum(message.arbitration_id == 0x061 for message in fake.frames())
    assert heartbeats == 10


@pytest.mark.parametrize("text", ["ODrive_S2:3", "ODrive_S1", "ODrive_S1:63", "ODrive_S1:x:y"])
def test_names_that_are_none(text: str) -> None:
    with pytest.raises(ValueError, match="ODrive"):
        family_spec(text)


def test_families_are_found_by_name() -> None:
    spec = family_spec("ODrive_S1:0")
    assert spec is not None
    assert spec.make(initial_angle_deg=90.0, load_nm=0.0).angle_deg == 90.0
    assert family_spec("M3508:1") is None


def test_it_shares_a_bus_with_other_families() -> None:
    drives = Drives([axis("ODrive_S1:3"), FakeMotor(MotorSpec.parse("M3508:1"))])
    drives.receive(frame(0x067, "08 00 00 00"))
    assert [motor.commands for motor in drives.motors] == [1, 0]
    assert 0x201 in {message.arbitration_id for message in drives.feedback()}
    with pytest.raises(ValueError, match="ODrive_v3:3"):
        check_collisions([OdriveSpec.parse("ODrive_S1:3"), OdriveSpec.parse("ODrive_v3:3")])
    # Node 16 has the ids 0x200 to 0x21F; what it sends most is a motor's feedback.
    with pytest.raises(ValueError, match="0x209"):
        check_collisions([OdriveSpec.parse("ODrive_S1:16"), MotorSpec.parse("GM6020:5")])


def asked(fake: FakeOdrive, arbitration_id: int) -> list[can.Message]:
    """Its answers to a remote frame, without what it sends unasked."""
    question = can.Message(
        arbitration_id=arbitration_id, is_extended_id=False, is_remote_frame=True
    )
    list(fake.frames())
    heard = fake.decode_command(question)
    answers = list(fake.frames())[:-1]
    assert heard == bool(answers) or fake.generation.torques is False
    return answers


def test_remote_frames_are_answered() -> None:
    fake = axis()
    fake.current_a = 2.0
    (currents,) = asked(fake, 0x074)
    assert currents.data == struct.pack("<ff", 2.0, 2.0)
    (supply,) = asked(fake, 0x077)
    assert supply.data == struct.pack("<ff", 24.0, 0.0)
    assert [message.arbitration_id for message in asked(fake, 0x07C)] == [0x07C]
    assert [message.arbitration_id for message in asked(fake, 0x075)] == [0x075]
    assert not asked(fake, 0x067)


def test_the_older_firmware_means_something_else_by_two_of_them() -> None:
    fake = axis("ODrive_v3:3")
    assert not asked(fake, 0x075)
    assert not asked(fake, 0x07C)
    assert [message.arbitration_id for message in asked(fake, 0x074)] == [0x074]
