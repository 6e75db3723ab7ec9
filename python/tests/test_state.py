"""The typed state has what the message has."""

from __future__ import annotations

from dataclasses import fields

from rc10 import MotorState
from rc10.lcm_types.motor_state_t import motor_state_t


def test_a_motors_state_has_every_field_of_the_message() -> None:
    assert {part.name for part in fields(MotorState)} == set(motor_state_t.__slots__)  # type: ignore[attr-defined]
