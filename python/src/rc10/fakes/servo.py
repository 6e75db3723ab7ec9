"""A motor with the loops of a drive: what fakes that take targets of many kinds have in common."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Protocol, TypeVar

from rc10.fakes.pieces import pieces
from rc10.spelling import not_one_of

if TYPE_CHECKING:
    import can
    from typing_extensions import Self

    from rc10.fakes.fake import Spec

_MAX_STEP_S = 0.0005
AMBIENT_C = 25.0


class Servo:
    """Everything is at the drive's output.

    Public attributes may be read and set at any time:
        angle_deg: multi-turn.
        speed_deg_s: of the output.
        torque_nm: that the motor gives.
        temperature_c: of the winding.
        load_nm: constant torque against positive rotation.

    Args:
        full_nm: the most that the motor gives.
        full_deg_s: at which that would be eaten by friction after 0.1 s of acceleration.
    """

    def __init__(self, full_nm: float, full_deg_s: float) -> None:
        self.full_nm = full_nm
        self.angle_deg = 0.0
        self.speed_deg_s = 0.0
        self.torque_nm = 0.0
        self.temperature_c = AMBIENT_C
        self.load_nm = 0.0
        # Chosen, so that a motor at full torque reaches full speed in a tenth of a second.
        self._inertia = full_nm * 0.1 / full_deg_s
        self._friction_nm = 0.01 * full_nm
        self._kept_nm = 0.0
        self.release()

    def release(self) -> None:
        """No torque."""
        self._mode = "off"
        self._value = self._fastest = self._limit_nm = 0.0
        self._motion = (0.0, 0.0, 0.0, 0.0, 0.0)

    def follow_torque(self, nm: float) -> None:
        """Gives this torque."""
        self._mode, self._value = "torque", nm

    def follow_speed(self, deg_s: float, limit_nm: float = 0.0) -> None:
        """Turns at this speed, with no more than `limit_nm`; 0: the motor's own."""
        self._mode, self._value, self._limit_nm = "speed", deg_s, limit_nm

    def follow_angle(self, deg: float, fastest_deg_s: float) -> None:
        """Goes to this multi-turn angle, no faster than that."""
        self._mode, self._value, self._fastest = "angle", deg, fastest_deg_s
        self._limit_nm = 0.0

    def follow_motion(
        self, rad: float, rad_s: float, stiffness: float, damping: float, nm: float
    ) -> None:
        """A spring and a damper, in N·m for each rad and rad/s, and a torque."""
        self._mode, self._motion = "motion", (rad, rad_s, stiffness, damping, nm)

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        for part_s in pieces(dt_s, _MAX_STEP_S):
            self._step(part_s)

    def _step(self, dt_s: float) -> None:
        wanted = self._wanted_nm(dt_s)
        self.torque_nm = max(-self.full_nm, min(self.full_nm, wanted))
        speed = self.speed_deg_s + (self.torque_nm - self.load_nm) / self._inertia * dt_s
        # Friction slows down and holds; it never turns a motor round.
        friction = self._friction_nm / self._inertia * dt_s
        self.speed_deg_s = math.copysign(max(0.0, abs(speed) - friction), speed)
        self.angle_deg += self.speed_deg_s * dt_s
        final_c = AMBIENT_C + 80.0 * (self.torque_nm / self.full_nm) ** 2
        self.temperature_c += (final_c - self.temperature_c) * dt_s / 100.0

    def _wanted_nm(self, dt_s: float) -> float:
        if self._mode == "torque":
            return self._value
        if self._mode == "motion":
            rad, rad_s, stiffness, damping, nm = self._motion
            error = rad - math.radians(self.angle_deg)
            return stiffness * error + damping * (rad_s - math.radians(self.speed_deg_s)) + nm
        if self._mode == "off":
            self._kept_nm = 0.0
            return 0.0
        wanted = self._value
        if self._mode == "angle":
            wanted = 20.0 * (self._value - self.angle_deg)
            wanted = max(-self._fastest, min(self._fastest, wanted))
        limit = min(self._limit_nm or self.full_nm, self.full_nm)
        error = wanted - self.speed_deg_s
        gain = self._inertia * 100.0
        self._kept_nm = max(-limit, min(limit, self._kept_nm + 10.0 * gain * error * dt_s))
        return max(-limit, min(limit, gain * error + self._kept_nm))


@dataclass(frozen=True)
class ReplyAddress:
    """The place of a drive that answers on one id."""

    feedback_id: int


class _Named(Protocol):
    @property
    def name(self) -> str: ...


_Model = TypeVar("_Model", bound=_Named)


@dataclass(frozen=True)
class ModelAtId(Generic[_Model]):
    """A drive as it is asked for, MODEL:ID. A family says what there is and where it replies."""

    model: _Model
    motor_id: int

    models: ClassVar[tuple[Any, ...]] = ()
    max_id: ClassVar[int] = 32

    @property
    def name(self) -> str:
        """Model and id."""
        return f"{self.model.name}:{self.motor_id}"

    @classmethod
    def parse(cls, text: str) -> Self:
        """Reads MODEL:ID.

        Raises:
            ValueError: it is something else, or there is no such drive.
        """
        by_name = {model.name: model for model in cls.models}
        name, *rest = text.split(":")
        if name not in by_name:
            raise ValueError(not_one_of(text, name, by_name))
        if len(rest) != 1 or not rest[0].isdecimal():
            raise ValueError(f"{text!r}: give {name}:ID")
        if not 1 <= int(rest[0]) <= cls.max_id:
            raise ValueError(f"{text}: {name} has the ids 1 to {cls.max_id}")
        return cls(by_name[name], int(rest[0]))


def standard_payload(message: can.Message) -> bytes | None:
    """Returns the bytes of a classic data frame of eight with a standard id, None of any other."""
    other = (
        message.is_extended_id
        or message.is_remote_frame
        or message.is_error_frame
        or message.is_fd
        or len(message.data) != 8
    )
    return None if other else bytes(message.data)


def clamped_int16(value: float) -> int:
    """Returns the nearest that 16 bits hold."""
    return max(-32768, min(32767, round(value)))


class AnsweringDrive:
    """A drive that speaks only when spoken to, with its motor.

    Public attributes may be read at any time:
        servo: the motor; what it does may be set there.
        speed_rad_s, current_a, temperature_c: of the last step.
        commands: frames for it.
        command: the last target, in the unit of its frame.

    Args:
        spec: what it was made from.
        servo: the motor.
        nm_per_a: torque at the output for each ampere.
    """

    def __init__(self, spec: Spec, servo: Servo, nm_per_a: float) -> None:
        self.spec = spec
        self.servo = servo
        self.speed_rad_s = 0.0
        self.current_a = 0.0
        self.temperature_c = servo.temperature_c
        self.commands = 0
        self.command = 0.0
        self._nm_per_a = nm_per_a
        self._answers: list[can.Message] = []

    @property
    def name(self) -> str:
        """Model and id."""
        return self.spec.name

    @property
    def velocity_rpm(self) -> float:
        """Velocity of the output shaft."""
        return self.servo.speed_deg_s / 6.0

    @property
    def angle_deg(self) -> float:
        """Multi-turn, of the output shaft."""
        return self.servo.angle_deg

    def frames(self) -> list[can.Message]:
        """Returns the frames that it sends now, and forgets them."""
        frames, self._answers = self._answers, []
        return frames

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        self.servo.step(dt_s)
        self.speed_rad_s = math.radians(self.servo.speed_deg_s)
        self.current_a = self._flowing_a
        self.temperature_c = self.servo.temperature_c

    @property
    def _flowing_a(self) -> float:
        return self.servo.torque_nm / self._nm_per_a
