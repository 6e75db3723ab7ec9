"""Vectors from the manuals RS00 to RS06, EL05 and CyberGear, and what a drive does."""

from __future__ import annotations

import math
import struct

import can
import pytest

from rc10.fakes.cli import main
from rc10.fakes.drives import Drives
from rc10.fakes.families import family_spec
from rc10.fakes.robstride import ROBSTRIDE_MODELS, FakeRobStride, RobStrideSpec

MODELS = {model.name: model for model in ROBSTRIDE_MODELS}


def fake(name: str = "RS00", motor_id: int = 127) -> FakeRobStride:
    return RobStrideSpec(MODELS[name], motor_id).make()


def frame(arbitration_id: int, data: str, **flags: bool) -> can.Message:
    return can.Message(
        arbitration_id=arbitration_id,
        is_extended_id=flags.pop("is_extended_id", True),
        data=bytes.fromhex(data),
        **flags,
    )


def ask(drive: FakeRobStride, arbitration_id: int, data: str = "00" * 8) -> list[can.Message]:
    drive.decode_command(frame(arbitration_id, data))
    return list(drive.frames())


def write(drive: FakeRobStride, index: int, value: float) -> None:
    drive.decode_command(frame(0x1200FD7F, struct.pack("<HHf", index, 0, value).hex()))


def mode_of(message: can.Message) -> int:
    return message.arbitration_id >> 22 & 3


def run(drive: FakeRobStride, seconds: float) -> None:
    for _ in range(round(seconds * 1000)):
        drive.step(0.001)


ENABLE, STOP, CLEAR = 0x0300FD7F, 0x0400FD7F, "01" + "00" * 7


def test_an_operation_command_has_its_torque_in_the_id() -> None:
    drive = fake()
    ask(drive, ENABLE)
    (answer,) = ask(drive, 0x0192487F, "8A 2E 7F FF 0F 5C 33 33")
    position, velocity, kp, kd, torque = drive.operation
    assert position == pytest.approx(1.0, abs=2 * 12.57 / 65535)
    assert velocity == pytest.approx(0.0, abs=2 * 33 / 65535)
    assert kp == pytest.approx(30.0, abs=500 / 65535)
    assert kd == pytest.approx(1.0, abs=5 / 65535)
    assert torque == pytest.approx(2.0, abs=28 / 65535)
    assert answer.arbitration_id == 0x02807FFD


def test_feedback_of_a_running_drive_is_that_of_the_manual() -> None:
    drive = fake()
    ask(drive, ENABLE)
    drive.position_rad, drive.speed_rad_s = -1.5, 2.0
    drive.current_a = 0.7 / drive.model.nm_per_a
    drive.temperature_c = 31.2
    (answer,) = ask(drive, 0x0192487F, "8A 2E 7F FF 0F 5C 33 33")
    assert answer.arbitration_id == 0x02807FFD
    assert bytes(answer.data) == bytes.fromhex("70 B9 87 C1 86 65 01 38")


def test_feedback_with_faults() -> None:
    drive = fake(motor_id=1)
    drive.temperature_c = 145.5
    drive.fail(0b101, 0b000101)
    assert [message.arbitration_id for message in list(drive.frames())] == [0x150001FD]
    (answer,) = ask(drive, 0x0300FD01)
    assert answer.arbitration_id == 0x020501FD
    assert bytes(answer.data) == bytes.fromhex("7F FF 7F FF 7F FF 05 AF")


def test_the_vendors_read_of_a_parameter() -> None:
    (answer,) = ask(fake(), 0x1100FD7F, "1E 70 00 00 00 00 00 00")
    assert answer.arbitration_id == 0x11007FFD
    assert bytes(answer.data) == bytes.fromhex("1E 70 00 00 00 00 F0 41")


def test_an_unknown_parameter_is_refused() -> None:
    (answer,) = ask(fake(), 0x1100FD7F, "34 12 00 00 00 00 00 00")
    assert answer.arbitration_id == 0x11017FFD


def test_a_written_parameter_is_read_back() -> None:
    drive = fake()
    ask(drive, 0x1200FD7F, "16 70 00 00 C3 F5 48 40")
    assert drive.parameter(0x7016) == pytest.approx(3.14, abs=1e-6)
    ask(drive, 0x1200FD7F, "05 70 00 00 01 00 00 00")
    (answer,) = ask(drive, 0x1100FD7F, "05 70 00 00 00 00 00 00")
    assert answer.data[4] == 1
    ask(drive, ENABLE)
    ask(drive, 0x1200FD7F, "05 70 00 00 02 00 00 00")
    (answer,) = ask(drive, 0x1100FD7F, "05 70 00 00 00 00 00 00")
    assert answer.data[4] == 1, "the run mode changes only while it is stopped"


def test_the_id_is_answered_to_everyone() -> None:
    (answer,) = ask(fake(), 0x0000FD7F)
    assert answer.arbitration_id == 0x00007FFE


def test_set_zero_makes_the_present_angle_zero() -> None:
    drive = fake()
    drive.position_rad = 2.0
    ask(drive, 0x0600FD7F, CLEAR)
    assert drive.position_rad == 0.0


@pytest.mark.parametrize(
    "message",
    [
        frame(0x0300FD7E, "00" * 8),
        frame(0x0300FD7F, "00" * 7),
        frame(0x07F, "00" * 8, is_extended_id=False),
        can.Message(arbitration_id=0x0300FD7F, is_remote_frame=True, dlc=8),
        frame(0x0300FD7F, "00" * 8, is_fd=True),
        frame(0x1700FD7F, "01 02 03 04 05 06 01 00"),
    ],
)
def test_frames_of_others_do_nothing(message: can.Message) -> None:
    drive = fake()
    assert not drive.decode_command(message)
    assert not list(drive.frames())
    assert not drive.enabled


def test_a_drive_stops_when_its_watchdog_trips() -> None:
    drive = fake()
    ask(drive, 0x1200FD7F, "28 70 00 00 D0 07 00 00")
    ask(drive, ENABLE)
    run(drive, 0.099)
    assert drive.enabled
    run(drive, 0.003)
    assert not drive.enabled


def test_without_a_watchdog_the_last_command_holds() -> None:
    drive = fake()
    ask(drive, ENABLE)
    run(drive, 5.0)
    assert drive.enabled


def test_a_fault_is_latched_until_it_is_cleared() -> None:
    drive = fake("CyberGear")
    drive.fail(1 << 3)
    list(drive.frames())
    assert mode_of(ask(drive, ENABLE)[0]) == 0
    ask(drive, STOP)
    assert mode_of(ask(drive, ENABLE)[0]) == 0
    ask(drive, STOP, CLEAR)
    assert mode_of(ask(drive, ENABLE)[0]) == 2


@pytest.mark.parametrize("name", MODELS)
def test_the_loops_reach_their_targets(name: str) -> None:
    model = MODELS[name]
    for run_mode, index, value in (
        (3, 0x7006, 0.2 * model.max_a),
        (2, 0x700A, 3.0),
        (model.position_mode, 0x7016, 2.0),
    ):
        drive = fake(name)
        drive.decode_command(frame(0x1200FD7F, f"05 70 00 00 {run_mode:02X} 00 00 00"))
        ask(drive, ENABLE)
        write(drive, index, value)
        run(drive, 0.02 if run_mode == 3 else 3.0)
        if run_mode == 3:
            assert drive.torque_nm == pytest.approx(0.2 * model.max_a * model.nm_per_a)
            assert drive.speed_rad_s > 0
        elif run_mode == 2:
            assert drive.speed_rad_s == pytest.approx(3.0, abs=0.05)
        else:
            assert drive.position_rad == pytest.approx(2.0, abs=0.02)


def test_positions_go_on_at_the_other_end_of_the_scale() -> None:
    drive = fake()
    drive.position_rad = 5 * math.pi
    (answer,) = ask(drive, STOP)
    (raw,) = struct.unpack_from(">H", answer.data)
    assert raw / 65535 * 2 * 12.57 - 12.57 == pytest.approx(-3 * math.pi, abs=1e-3)
    drive = fake("CyberGear")
    drive.position_rad = 13.0
    (answer,) = ask(drive, STOP)
    assert bytes(answer.data[:2]) == b"\xff\xff"


def test_power_away_forgets() -> None:
    drive = fake()
    ask(drive, 0x1200FD7F, "28 70 00 00 D0 07 00 00")
    ask(drive, ENABLE)
    drive.position_rad = 7.0
    drive.restart()
    assert not drive.enabled
    assert drive.position_rad == pytest.approx(7.0 - math.tau)
    (answer,) = ask(drive, 0x1100FD7F, "28 70 00 00 00 00 00 00")
    assert not any(answer.data[4:])


@pytest.mark.parametrize("name", MODELS)
def test_every_model_is_named_by_its_id(name: str) -> None:
    spec = family_spec(f"{name}:3")
    assert isinstance(spec, RobStrideSpec)
    assert spec.name == f"{name}:3"
    with pytest.raises(ValueError, match="1 to 127"):
        family_spec(f"{name}:0")
    with pytest.raises(ValueError, match=f"give {name}:ID"):
        family_spec(f"{name}:x")


def test_a_drive_hears_all_ids_that_end_with_its_own_and_no_others() -> None:
    first, second = fake("RS00", 0x7F), fake("EL05", 0x7E)
    drives = Drives([first, second], silent_after_s={"EL05:126": 0.5})
    assert drives.filters == [
        {"can_id": 0x7F, "can_mask": 0xFF, "extended": True},
        {"can_id": 0x7E, "can_mask": 0xFF, "extended": True},
    ]
    drives.receive(frame(ENABLE, "00" * 8))
    drives.receive(frame(0x0192487F, "8A 2E 7F FF 0F 5C 33 33"))
    drives.receive(frame(0x0300127E, "00" * 8))
    drives.receive(frame(0x07F, "00" * 8, is_extended_id=False))
    assert (first.commands, second.commands) == (2, 1)
    assert first.command == pytest.approx(32.0, abs=0.02), "30 N·m/rad over 1 rad, and 2 N·m"
    sent = [message.arbitration_id for message in drives.feedback()]
    assert sent == [0x02807FFD, 0x02807FFD, 0x02807E12]
    drives.step(0.5)
    drives.receive(frame(0x0300127E, "00" * 8))
    assert second.commands == 1, "its cable is cut"


def test_two_drives_with_one_id_are_refused() -> None:
    with pytest.raises(ValueError, match="RS00:5 and CyberGear:5 would both send"):
        Drives([fake("RS00", 5), fake("CyberGear", 5)])


def test_the_command_line_knows_them(capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["--interface", "virtual", "--channel", "robstride", "--duration", "0.05"]
    motors = ["--motor", "RS00:1", "--motor", "CyberGear:2", "--angle-deg", "RS00:1=90"]
    assert main(arguments + motors) == 0
    output = capsys.readouterr().out
    assert output.startswith("ready: RS00:1 CyberGear:2")
    assert "angle_deg=90.00" in output


def test_a_new_id_counts_at_once_and_is_told() -> None:
    drive = fake()
    (answer,) = ask(drive, 0x0709FD7F)
    assert answer.arbitration_id == 0x000009FE
    assert not ask(drive, STOP)
    assert len(ask(drive, 0x0400FD09)) == 1


@pytest.mark.parametrize(("model", "saves"), [("RS00", True), ("CyberGear", False)])
def test_what_is_saved_outlives_a_restart(model: str, saves: bool) -> None:
    drive = fake(model)
    ask(drive, 0x1200FD7F, struct.pack("<HHf", 0x7018, 0, 3.0).hex())
    assert len(ask(drive, 0x1600FD7F, "01 02 03 04 05 06 07 08")) == int(saves)
    drive.restart()
    assert drive.parameter(0x7018) == (3.0 if saves else drive.model.max_a)
