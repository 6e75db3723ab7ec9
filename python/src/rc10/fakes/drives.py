"""All fake motors of one bus, and what goes wrong with them."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from rc10.fakes.address import check_collisions
from rc10.fakes.fake import EXTENDED
from rc10.spelling import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    import can
    from can.typechecking import CanFilter

    from rc10.fakes.fake import Fake


class Drives:
    """The fake motors of one bus. Knows no bus and no clock, as the motors do not.

    Args:
        motors: with different feedback ids.
        silent_after_s: by name of motor: after so long its cable is cut. It then neither sends
            nor hears, and does on and on what it was last told.
        drop: by name of motor: the probability from 0 to 1 that a feedback frame is lost.
        seed: of the lost frames.

    Raises:
        ValueError: two motors with one id, a motor that is not there, or a wrong probability.
    """

    def __init__(
        self,
        motors: Sequence[Fake],
        *,
        silent_after_s: Mapping[str, float] | None = None,
        drop: Mapping[str, float] | None = None,
        seed: int = 0,
    ) -> None:
        check_collisions(motor.spec for motor in motors)
        self.motors = list(motors)
        self.sent = dict.fromkeys((motor.name for motor in motors), 0)
        if len(self.sent) != len(self.motors):
            raise ValueError(
                "two motors have one name: give one of them another id, or another bus"
            )
        self.dropped = dict(self.sent)
        self._silent_after_s = dict(silent_after_s or {})
        self._drop = {name: p for name, p in (drop or {}).items() if p > 0}
        for name in (*self._silent_after_s, *self._drop):
            if name not in self.sent:
                raise ValueError(
                    f"{name}: no such motor here; there are {', '.join(self.sent)}"
                    f"{did_you_mean(name, self.sent)}"
                )
        for name, probability in self._drop.items():
            if probability > 1:
                raise ValueError(f"{name}: drop = {probability} is not within 0 to 1")
        self._random = random.Random(seed)
        self._time_s = 0.0
        self._by_command_id: dict[int, list[Fake]] = {}
        for motor in self.motors:
            for command_id in motor.command_ids:
                self._by_command_id.setdefault(command_id, []).append(motor)
        self._by_filter = [
            (can_id, mask | EXTENDED, motor)
            for motor in self.motors
            for can_id, mask in getattr(motor, "command_filters", ())
        ]

    @property
    def command_ids(self) -> list[int]:
        """The ids that motors name one by one, extended ones with EXTENDED added."""
        return sorted(self._by_command_id)

    @property
    def filters(self) -> list[CanFilter]:
        """All that some motor listens to, for a bus of python-can."""
        whole = [
            (command_id, 0x1FFFFFFF if command_id & EXTENDED else 0x7FF)
            for command_id in self.command_ids
        ]
        masked = [(can_id, mask) for can_id, mask, _ in self._by_filter]
        return [
            {
                "can_id": can_id & ~EXTENDED,
                "can_mask": mask & ~EXTENDED,
                "extended": bool(can_id & EXTENDED),
            }
            for can_id, mask in whole + masked
        ]

    @property
    def fd(self) -> bool:
        """Whether some motor speaks CAN FD."""
        return any(getattr(motor, "fd", False) for motor in self.motors)

    def receive(self, message: can.Message) -> None:
        """Hands a frame to the motors that listen to it."""
        command_id = message.arbitration_id | (EXTENDED if message.is_extended_id else 0)
        for motor in self._by_command_id.get(command_id, ()):
            if not self._is_silent(motor):
                motor.decode_command(message)
        for can_id, mask, motor in self._by_filter:
            if (command_id ^ can_id) & mask == 0 and not self._is_silent(motor):
                motor.decode_command(message)

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        self._time_s += dt_s
        for motor in self.motors:
            motor.step(dt_s)

    def feedback(self) -> Iterator[can.Message]:
        """Yields the frames that reach the bus now; each is to be sent before the next."""
        for motor in self.motors:
            if self._is_silent(motor):
                continue
            for message in motor.frames():
                if motor.name in self._drop and self._random.random() < self._drop[motor.name]:
                    self.dropped[motor.name] += 1
                    continue
                self.sent[motor.name] += 1
                yield message

    def _is_silent(self, motor: Fake) -> bool:
        after_s = self._silent_after_s.get(motor.name)
        return after_s is not None and self._time_s >= after_s
