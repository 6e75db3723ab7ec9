"""Which frames a DJI motor listens to and sends."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

from rc10.fakes.models import GM6020, MODELS
from rc10.spelling import not_one_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rc10.fakes.fake import Spec
    from rc10.fakes.models import MotorModel


class CommandKind(Enum):
    """Meaning of the numbers in a motor's command frame: a setting stored in the drive."""

    CURRENT = "current"
    VOLTAGE = "voltage"


@dataclass(frozen=True)
class Address:
    """A motor's place on the bus.

    Attributes:
        command_id: the group frame that carries its command.
        slot: from 0 to 3, which two bytes of that frame.
        feedback_id: the frame that it sends.
    """

    command_id: int
    slot: int
    feedback_id: int


# For the ids 1 to 4 and from 5 on.
_COMMAND_IDS = {
    (False, CommandKind.CURRENT): (0x200, 0x1FF),
    (True, CommandKind.VOLTAGE): (0x1FF, 0x2FF),
    (True, CommandKind.CURRENT): (0x1FE, 0x2FE),
}


def address_of(model: MotorModel, motor_id: int, kind: CommandKind) -> Address:
    """Returns the address of a motor.

    Raises:
        ValueError: there is no such motor.
    """
    if not 1 <= motor_id <= model.max_id:
        raise ValueError(f"{model.name}:{motor_id}: {model.name} has the ids 1 to {model.max_id}")
    pair = _COMMAND_IDS.get((model is GM6020, kind))
    if pair is None:
        raise ValueError(f"{model.name}:{motor_id}: {model.name} takes no {kind.value} commands")
    group, slot = divmod(motor_id - 1, 4)
    return Address(pair[group], slot, model.feedback_base + motor_id)


@dataclass(frozen=True)
class MotorSpec:
    """A motor as it is asked for: "M3508:1", "GM6020:6:voltage"."""

    model: MotorModel
    motor_id: int
    kind: CommandKind = CommandKind.CURRENT

    @property
    def name(self) -> str:
        """Model and id, "M3508:1": how a motor is referred to."""
        return f"{self.model.name}:{self.motor_id}"

    @property
    def address(self) -> Address:
        """Its place on the bus."""
        return address_of(self.model, self.motor_id, self.kind)

    @classmethod
    def parse(cls, text: str) -> MotorSpec:
        """Reads MODEL:ID or MODEL:ID:current or MODEL:ID:voltage.

        Raises:
            ValueError: it is something else, or there is no such motor.
        """
        name, *rest = text.split(":")
        model = MODELS.get(name)
        if model is None:
            raise ValueError(not_one_of(text, name, MODELS))
        if len(rest) not in (1, 2) or not rest[0].isdecimal():
            raise ValueError(f"{text!r}: give {name}:ID or {name}:ID:voltage")
        try:
            kind = CommandKind(rest[1]) if len(rest) == 2 else CommandKind.CURRENT
        except ValueError:
            raise ValueError(f"{text!r}: {rest[1]!r} is neither current nor voltage") from None
        spec = cls(model, int(rest[0]), kind)
        spec.address  # noqa: B018  raises for an id that the model does not have
        return spec


def check_collisions(specs: Iterable[Spec]) -> None:
    """Refuses motors that cannot be told apart on one bus.

    Two motors that share a slot of a command frame also share a feedback id, so one check finds
    both. (Real drives blink and give no torque when their ids are equal.)

    Raises:
        ValueError: naming both motors.
    """
    by_id: dict[int, Spec] = {}
    for spec in specs:
        feedback_id = spec.address.feedback_id
        other = by_id.setdefault(feedback_id, spec)
        if other is not spec:
            raise ValueError(
                f"{other.name} and {spec.name} would both send feedback 0x{feedback_id:03X}: "
                "give one of them another id, or another bus"
            )
