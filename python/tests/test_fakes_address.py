"""Ids, groups and slots of DJI drives: manuals of C620 V1.01, C610 and GM6020 v1.2."""

from __future__ import annotations

import itertools

import pytest

from rc10.fakes import Drives, FakeMotor, MotorSpec, check_collisions

C6XX = ("M3508", "M2006")


@pytest.mark.parametrize("model", C6XX)
@pytest.mark.parametrize(
    ("motor_id", "command_id", "slot"),
    [(i, 0x200, i - 1) for i in (1, 2, 3, 4)] + [(i, 0x1FF, i - 5) for i in (5, 6, 7, 8)],
)
def test_c620_and_c610_share_their_ids(
    model: str, motor_id: int, command_id: int, slot: int
) -> None:
    address = MotorSpec.parse(f"{model}:{motor_id}").address
    assert (address.command_id, address.slot) == (command_id, slot)
    assert address.feedback_id == 0x200 + motor_id


@pytest.mark.parametrize(
    ("kind", "low", "high"), [(":voltage", 0x1FF, 0x2FF), (":current", 0x1FE, 0x2FE)]
)
@pytest.mark.parametrize("motor_id", range(1, 8))
def test_gm6020_commands_and_feedback_have_their_ids(
    motor_id: int, kind: str, low: int, high: int
) -> None:
    address = MotorSpec.parse(f"GM6020:{motor_id}{kind}").address
    assert address.command_id == (low if motor_id <= 4 else high)
    assert address.slot == (motor_id - 1) % 4
    assert address.feedback_id == 0x204 + motor_id


def test_a_gm6020_takes_currents_unless_told_otherwise() -> None:
    assert MotorSpec.parse("GM6020:1").address == MotorSpec.parse("GM6020:1:current").address


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("M3508:0", "M3508 has the ids 1 to 8"),
        ("M2006:9", "M2006 has the ids 1 to 8"),
        ("GM6020:8", "GM6020 has the ids 1 to 7"),
        ("M3508:1:voltage", "M3508 takes no voltage commands"),
        ("GM6020:1:speed", "'speed' is neither current nor voltage"),
        ("M3510:1", "'M3510' is not one of M3508, M2006, GM6020"),
        ("M3508", "give M3508:ID"),
        ("M3508:x", "give M3508:ID"),
        ("M3508:1:current:2", "give M3508:ID"),
    ],
)
def test_what_is_no_motor_is_refused(text: str, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        MotorSpec.parse(text)


@pytest.mark.parametrize(
    ("first", "second", "feedback_id"),
    [
        ("M3508:1", "M3508:1", "0x201"),
        ("M3508:3", "M2006:3", "0x203"),
        ("GM6020:7", "GM6020:7:voltage", "0x20B"),
        # In voltage mode the commands collide too; in current mode only the feedback does.
        *((f"M3508:{i + 4}", f"GM6020:{i}:voltage", f"0x{0x204 + i:X}") for i in (1, 2, 3, 4)),
        *((f"M2006:{i + 4}", f"GM6020:{i}:current", f"0x{0x204 + i:X}") for i in (1, 2, 3, 4)),
    ],
)
def test_collisions_name_both(first: str, second: str, feedback_id: str) -> None:
    specs = [MotorSpec.parse(text) for text in (first, "M3508:2", second)]
    message = f"{specs[0].name} and {specs[2].name} would both send feedback {feedback_id}"
    with pytest.raises(ValueError, match=message):
        check_collisions(specs)
    with pytest.raises(ValueError, match=message):
        Drives([FakeMotor(spec) for spec in specs])


def test_the_largest_bus_has_eleven_motors() -> None:
    texts = [f"M3508:{i}" for i in range(1, 5)]
    texts += [f"M2006:{i}" for i in range(5, 9)]
    texts += [f"GM6020:{i}" for i in (5, 6, 7)]
    check_collisions(MotorSpec.parse(text) for text in texts)


def test_motors_that_share_a_slot_always_share_a_feedback_id() -> None:
    every = [MotorSpec.parse(f"{model}:{i}") for model in C6XX for i in range(1, 9)]
    every += [
        MotorSpec.parse(f"GM6020:{i}:{k}") for i in range(1, 8) for k in ("current", "voltage")
    ]
    for a, b in itertools.combinations(every, 2):
        same_slot = (a.address.command_id, a.address.slot) == (b.address.command_id, b.address.slot)
        assert not same_slot or a.address.feedback_id == b.address.feedback_id
