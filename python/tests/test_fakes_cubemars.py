"""Vectors from the AK series module driver manual V1.0.8, and what an AK drive does with them."""

from __future__ import annotations

import math

import can
import pytest

from rc10.fakes import Drives
from rc10.fakes.cli import main
from rc10.fakes.cubemars import CUBEMARS_MODELS, ENTER, EXIT, CubeMarsSpec, FakeCubeMars
from rc10.fakes.families import family_spec


def drive(text: str) -> FakeCubeMars:
    return CubeMarsSpec.parse(text).make()


def frame(arbitration_id: int, data: str, *, extended: bool = True) -> can.Message:
    return can.Message(
        arbitration_id=arbitration_id, is_extended_id=extended, data=bytes.fromhex(data)
    )


def order(motor_id: int, data: bytes) -> can.Message:
    return can.Message(arbitration_id=motor_id, is_extended_id=False, data=data)


def run(fake: FakeCubeMars, seconds: float) -> list[can.Message]:
    sent: list[can.Message] = []
    for _ in range(round(seconds * 1000)):
        fake.step(0.001)
        sent.extend(fake.frames())
    return sent


# ---- vectors -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("arbitration_id", "data", "command"),
    [
        (0x168, "FF FF F2 54", -3.5),
        (0x368, "00 00 27 10", 10000.0),
        (0x468, "00 1B 77 40", 180.0),
        (0x668, "00 0D BB A0 01 F4 01 2C", 90.0),
    ],
)
def test_servo_commands_are_those_of_the_manual(
    arbitration_id: int, data: str, command: float
) -> None:
    fake = drive("AK80-9:104")
    assert fake.decode_command(frame(arbitration_id, data))
    assert fake.command == pytest.approx(command)
    assert fake.commands == 1


def test_an_origin_is_one_byte() -> None:
    fake = drive("AK80-9:104")
    fake.angle_rad = 2.0
    assert not fake.decode_command(frame(0x568, "00 00"))
    assert fake.decode_command(frame(0x568, "00"))
    assert fake.angle_deg == 0.0


def test_servo_feedback_is_that_of_the_manual() -> None:
    fake = drive("AK80-9:104")
    fake.angle_rad = math.radians(123.4)
    fake.speed_rad_s = -2500 / (21 * 9) * math.tau / 60
    fake.current_a = 5.67
    fake.temperature_c = 42.2
    message = fake.feedback()
    assert message.arbitration_id == 0x2968
    assert message.is_extended_id
    assert message.data == bytes.fromhex("04D2FF0602372A00")


def test_a_mit_command_is_decoded_as_in_the_manual() -> None:
    fake = drive("AK80-9:104:mit")
    assert fake.decode_command(order(0x68, ENTER))
    assert fake.decode_command(frame(0x68, "85 1E 82 81 99 33 38 E3", extended=False))
    assert fake.mit == pytest.approx((0.49992, 0.98901, 49.9389, 1.0, 2.0), abs=1e-4)


def test_a_v3_command_has_another_order() -> None:
    fake = drive("AK10-9-V3:104:mit_v3")
    assert fake.decode_command(frame(0x868, "19 93 33 85 17 84 88 4B"))
    position, velocity, stiffness, damping, torque = fake.mit
    assert position == pytest.approx(0.5, abs=0.0004)
    assert velocity == pytest.approx(1.0, abs=0.014)
    assert stiffness == pytest.approx(49.9389, abs=1e-4)
    assert damping == pytest.approx(1.0, abs=0.0013)
    assert torque == pytest.approx(2.0, abs=0.027)


def test_a_mit_answer_is_that_of_the_manual() -> None:
    fake = drive("AK80-9:104:mit")
    fake.angle_rad = 3.00015
    fake.speed_rad_s = -0.005
    fake.current_a = 0.0045 / (0.091 * 9)
    fake.temperature_c = 30.0
    fake.decode_command(order(0x68, EXIT))
    (message,) = fake.frames()
    assert message.arbitration_id == 0
    assert not message.is_extended_id
    assert message.data == bytes.fromhex("689EB87FF8004600")


# ---- what belongs to a drive ---------------------------------------------------------------------


@pytest.mark.parametrize(
    "other",
    [
        frame(0x105, "00 00 00 00", extended=False),
        frame(0x106, "00 00 00 00"),
        frame(0x105, "00 00 00"),
        frame(0x805, "00 00 00 00 00 00 00 00"),
        frame(0x705, "00 00 00 00"),
        can.Message(arbitration_id=0x105, is_remote_frame=True, dlc=4),
    ],
)
def test_a_servo_drive_takes_nothing_else(other: can.Message) -> None:
    assert not drive("AK80-9:5").decode_command(other)


@pytest.mark.parametrize("text", ["AK80-9", "AK80-9:0", "AK80-9:255", "AK80-9:1:foo", "AK99:1"])
def test_there_are_no_such_drives(text: str) -> None:
    with pytest.raises(ValueError, match="AK"):
        drive(text)


@pytest.mark.parametrize("text", ["AK80-9:1:mit_v3", "AK10-9-V3:1:mit"])
def test_a_drive_speaks_the_protocols_of_its_generation(text: str) -> None:
    with pytest.raises(ValueError, match="has no mit"):
        drive(text)


# ---- behaviour -----------------------------------------------------------------------------------


def test_servo_velocity_and_position_are_reached() -> None:
    fake = drive("AK80-9:5")
    fake.decode_command(frame(0x305, "00 00 27 10"))
    run(fake, 1.0)
    assert fake.erpm == pytest.approx(10000, rel=0.02)
    fake.decode_command(frame(0x405, "00 1B 77 40"))
    run(fake, 3.0)
    assert fake.angle_deg == pytest.approx(180.0, abs=0.5)


def test_servo_speaks_at_its_rate_without_being_asked() -> None:
    sent = run(FakeCubeMars(CubeMarsSpec.parse("AK80-9:5"), rate_hz=200), 1.0)
    assert len(sent) == pytest.approx(200, abs=1)
    assert {message.arbitration_id for message in sent} == {0x2905}


def test_mit_obeys_only_after_it_was_entered() -> None:
    fake = drive("AK80-9:5:mit")
    torque = frame(0x05, "7F FF 7F F0 00 00 08 E3", extended=False)  # 2 N·m
    fake.decode_command(torque)
    run(fake, 0.1)
    assert fake.current_a == 0.0
    fake.decode_command(order(5, ENTER))
    fake.decode_command(torque)
    run(fake, 0.1)
    assert fake.current_a == pytest.approx(2 / (0.091 * 9), rel=0.01)
    fake.decode_command(order(5, EXIT))
    run(fake, 0.1)
    assert fake.current_a == 0.0


def test_a_law_outlives_leaving_the_mode_and_acts_again_in_it() -> None:
    fake = drive("AK80-9:5:mit")
    fake.decode_command(order(5, ENTER))
    fake.decode_command(frame(0x05, "7F FF 7F F0 00 00 08 E3", extended=False))
    fake.decode_command(order(5, EXIT))
    ignored = frame(0x05, "7F FF 7F F0 00 00 07 FF", extended=False)  # no torque
    fake.decode_command(ignored)
    run(fake, 0.1)
    assert fake.current_a == 0.0
    fake.decode_command(order(5, ENTER))
    run(fake, 0.1)
    assert fake.current_a == pytest.approx(2 / (0.091 * 9), rel=0.01)


@pytest.mark.parametrize(("rad_s", "code"), [(49.9, 0xFFA), (50.1, 0x003), (-50.1, 0xFFC)])
def test_a_mit_speed_beyond_its_field_wraps(rad_s: float, code: int) -> None:
    fake = drive("AK80-9:5:mit")
    fake.speed_rad_s = rad_s
    fake.decode_command(order(5, EXIT))
    (message,) = fake.frames()
    assert message.data[3] << 4 | message.data[4] >> 4 == code


def test_mit_answers_each_frame_and_nothing_else() -> None:
    fake = drive("AK80-9:5:mit")
    assert run(fake, 0.1) == []
    for _ in range(3):
        fake.decode_command(order(5, EXIT))
    assert len(run(fake, 0.1)) == 3


def test_an_error_lets_go_and_entering_ends_it() -> None:
    fake = drive("AK80-9:5:mit")
    fake.decode_command(order(5, ENTER))
    fake.decode_command(frame(0x05, "7F FF 7F F0 00 00 08 E3", extended=False))
    fake.error = 2
    run(fake, 0.1)
    assert fake.current_a == 0.0
    fake.decode_command(order(5, ENTER))
    *_, answer = fake.frames()
    assert answer.data[7] == 0


def test_without_a_timeout_the_last_command_holds() -> None:
    for timeout_s, current_a in ((None, 2.0), (0.5, 0.0)):
        fake = FakeCubeMars(CubeMarsSpec.parse("AK80-9:5"), timeout_s=timeout_s)
        fake.load_nm = 2.0 * fake.model.output_nm_per_a
        fake.decode_command(frame(0x105, "00 00 07 D0"))
        run(fake, 1.0)
        assert fake.current_a == pytest.approx(current_a, abs=0.01)


def test_drives_of_both_kinds_share_a_bus() -> None:
    servo, mit = drive("AK80-9:5"), drive("AK60-6:5:mit")
    drives = Drives([servo, mit])
    drives.receive(frame(0x105, "00 00 07 D0"))
    drives.receive(order(5, EXIT))
    assert (servo.commands, mit.commands) == (1, 1)
    drives.step(0.002)
    assert [message.arbitration_id for message in drives.feedback()] == [0x2905, 0]
    for protocol in ("", ":mit"):
        with pytest.raises(ValueError, match="both send"):
            Drives([drive(f"AK80-9:5{protocol}"), drive(f"AK60-6:5{protocol}")])
    with pytest.raises(ValueError, match="one name"):
        Drives([drive("AK80-9:5"), drive("AK80-9:5:mit")])


@pytest.mark.parametrize("name", CUBEMARS_MODELS)
def test_every_model_is_named_by_its_id(name: str) -> None:
    spec = family_spec(f"{name}:3")
    assert isinstance(spec, CubeMarsSpec)
    assert spec.name == f"{name}:3"


def test_the_command_line_knows_them(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--interface", "virtual", "--channel", "cubemars", "--duration", "0.05"]
    motors = ["--motor", "AK80-9:5", "--motor", "AK60-6:6:mit", "--load-nm", "AK80-9:5=1.5"]
    assert main(arguments + motors) == 0
    output = capsys.readouterr().out
    assert output.startswith("ready: AK80-9:5 AK60-6:6")
    assert "velocity_rpm=-" in output.splitlines()[1], "the load turned it"


@pytest.mark.parametrize(
    ("text", "amperes"), [("AK10-9-V3:5", 2.0), ("AK80-9-V3:5", -2.0), ("AK60-6-V3:5", -2.0)]
)
def test_some_tell_the_amount_of_the_current_alone(text: str, amperes: float) -> None:
    fake = drive(text)
    fake.decode_command(frame(0x105, "FF FF F8 30"))
    told = [message for message in run(fake, 0.05) if message.arbitration_id == 0x2905]
    assert int.from_bytes(told[-1].data[4:6], "big", signed=True) == round(amperes * 100)
