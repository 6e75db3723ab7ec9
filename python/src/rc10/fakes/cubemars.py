"""A fake CubeMars AK drive, from the AK series module driver manual V1.0.8."""

from __future__ import annotations

import math
import struct
from collections import deque
from dataclasses import dataclass
from enum import Enum
from typing import TYPE_CHECKING

import can

from rc10.fakes.fake import EXTENDED
from rc10.fakes.pieces import pieces
from rc10.fakes.servo import ReplyAddress
from rc10.fakes.shaft import RPM_PER_RAD_S, Shaft
from rc10.spelling import not_one_of

if TYPE_CHECKING:
    from collections.abc import Iterator

DUTY, CURRENT, BRAKE, VELOCITY, POSITION, ORIGIN, POSITION_SPEED = range(7)
MIT_V3 = 8
FEEDBACK = 0x29

ENTER, EXIT, ZERO = (bytes([0xFF] * 7 + [last]) for last in (0xFC, 0xFD, 0xFE))

MAX_CURRENT_A = 60.0
MAX_ERPM = 100_000.0
MAX_STIFFNESS, MAX_DAMPING = 500.0, 5.0
AMBIENT_C = 25.0

_LENGTHS = {DUTY: 4, CURRENT: 4, BRAKE: 4, VELOCITY: 4, POSITION: 4, ORIGIN: 1}
_LENGTHS |= {POSITION_SPEED: 8, MIT_V3: 8}
_MAX_STEP_S = 0.0005
# No data sheet has the loops or the inertia: a stiff drive on a light load.
_VELOCITY_BANDWIDTH_RAD_S = 100.0
_POSITION_BANDWIDTH_RAD_S = 15.0
_SPEED_UP_S = 0.1  # from standstill to no-load speed with all its torque
_FRICTION = 0.02  # of all its torque


class Protocol(Enum):
    """Settings of the vendor's program."""

    SERVO = "servo"
    MIT = "mit"
    MIT_V3 = "mit_v3"


@dataclass(frozen=True)
class CubeMarsModel:
    """A motor with its gear; everything at the output shaft but pole pairs and kt.

    Attributes:
        name: "AK80-9"; V3 drives have "-V3" behind it.
        gear_ratio: rotor turns for one output turn.
        pole_pairs: electrical turns for one rotor turn.
        kt_nm_per_a: torque of the rotor for each ampere.
        no_load_rpm: about; where a duty of 1 leads.
        position_rad: reach of the position field of MIT frames, to both sides.
        velocity_rad_s: the same of the velocity.
        torque_nm: the same of the torque; also all that the motor can.
        signed_current: servo feedback tells the direction of the current, not its amount alone.
    """

    name: str
    gear_ratio: float
    pole_pairs: int
    kt_nm_per_a: float
    no_load_rpm: float
    position_rad: float
    velocity_rad_s: float
    torque_nm: float
    signed_current: bool = True

    @property
    def v3(self) -> bool:
        """Whether its drive is of the third generation."""
        return self.name.endswith("-V3")

    @property
    def output_nm_per_a(self) -> float:
        """Torque of the output shaft for each ampere."""
        return self.kt_nm_per_a * self.gear_ratio


CUBEMARS_MODELS = {
    model.name: model
    for model in (
        CubeMarsModel("AK10-9", 9, 21, 0.16, 320, 12.5, 50, 65),
        CubeMarsModel("AK60-6", 6, 14, 0.068, 560, 12.5, 45, 15),
        CubeMarsModel("AK70-10", 10, 21, 0.095, 480, 12.5, 50, 25),
        CubeMarsModel("AK80-6", 6, 21, 0.091, 800, 12.5, 76, 12),
        CubeMarsModel("AK80-8", 8, 21, 0.159, 360, 12.5, 37.5, 32),
        CubeMarsModel("AK80-9", 9, 21, 0.091, 533, 12.5, 50, 18),
        CubeMarsModel("AK80-64", 64, 21, 0.119, 60, 12.5, 8, 144),
        CubeMarsModel("AK10-9-V3", 9, 21, 1.1314 / 9, 320, 12.56, 28, 54, signed_current=False),
        CubeMarsModel("AK60-6-V3", 6, 14, 0.119, 640, 12.56, 60, 12),
        CubeMarsModel("AK80-8-V3", 8, 21, 1.0566 / 8, 360, 12.5, 37.5, 32),
        CubeMarsModel("AK80-9-V3", 9, 21, 0.095, 533, 12.56, 65, 18),
    )
}


@dataclass(frozen=True)
class CubeMarsSpec:
    """A drive as it is asked for: "AK80-9:5", "AK80-9:5:mit"."""

    model: CubeMarsModel
    motor_id: int
    protocol: Protocol = Protocol.SERVO

    def __post_init__(self) -> None:
        if not 1 <= self.motor_id <= 254:
            raise ValueError(f"{self.name}: the ids are 1 to 254")
        if self.protocol is (Protocol.MIT if self.model.v3 else Protocol.MIT_V3):
            raise ValueError(f"{self.name}: this drive has no {self.protocol.value}")

    @property
    def name(self) -> str:
        """Model and id."""
        return f"{self.model.name}:{self.motor_id}"

    @property
    def extended(self) -> bool:
        """Only MIT drives of before V3 have standard ids."""
        return self.protocol is not Protocol.MIT

    @property
    def address(self) -> ReplyAddress:
        """Its place on the bus.

        MIT drives share the id 0: there it is what tells them apart, byte 0 of their frames,
        above the bits of the id.
        """
        if self.extended:
            return ReplyAddress(EXTENDED | FEEDBACK << 8 | self.motor_id)
        return ReplyAddress(self.motor_id << 11)

    @classmethod
    def parse(cls, text: str) -> CubeMarsSpec:
        """Reads MODEL:ID or MODEL:ID:PROTOCOL.

        Raises:
            ValueError: it is something else, or there is no such drive.
        """
        name, *rest = text.split(":")
        model = CUBEMARS_MODELS.get(name)
        if model is None:
            raise ValueError(not_one_of(text, name, CUBEMARS_MODELS))
        if len(rest) not in (1, 2) or not rest[0].isdecimal():
            raise ValueError(f"{text!r}: give {name}:ID or {name}:ID:PROTOCOL")
        try:
            protocol = Protocol(rest[1]) if len(rest) == 2 else Protocol.SERVO
        except ValueError:
            known = [each.value for each in Protocol]
            raise ValueError(not_one_of(text, rest[1], known)) from None
        return cls(model, int(rest[0]), protocol)

    def make(self, *, initial_angle_deg: float = 0.0, load_nm: float = 0.0) -> FakeCubeMars:
        """Returns the drive."""
        return FakeCubeMars(self, initial_angle_deg=initial_angle_deg, load_nm=load_nm)


class FakeCubeMars(Shaft):
    """An AK drive in one of its three protocols.

    When commands stop, it holds the last one: no timeout is documented. `timeout_s` makes a
    kinder drive. A MIT drive of before V3 takes in laws only after ENTER, and keeps the last one
    over EXIT; each frame to it is answered, with fields that wrap.

    Public attributes may be read and set at any time:
        current_a: torque-producing; positive drives in the positive direction.
        speed_rad_s, angle_rad: of the output shaft; the angle is multi-turn.
        temperature_c: as told.
        load_nm: constant torque against positive rotation.
        error: the code that it tells; while it is not 0 the motor is let go. ENTER ends it.

    Args:
        spec: model, id and protocol.
        initial_angle_deg: of the output shaft.
        load_nm: see above.
        rate_hz: of the feedback of the servo protocol, 1 to 500.
        timeout_s: no torque after so long without a command; None: never.
        answers_on_own_id: MIT answers come with the drive's own id instead of 0.
    """

    def __init__(
        self,
        spec: CubeMarsSpec,
        *,
        initial_angle_deg: float = 0.0,
        load_nm: float = 0.0,
        rate_hz: float = 500.0,
        timeout_s: float | None = None,
        answers_on_own_id: bool = False,
    ) -> None:
        if not 1 <= rate_hz <= 500:
            raise ValueError(f"{spec.name}: rate_hz = {rate_hz} is not 1 to 500")
        self.spec = spec
        self.model = spec.model
        self.motor_id = spec.motor_id
        self.protocol = spec.protocol
        self.extended = spec.extended
        self.commands = 0
        self.command = 0.0
        self.current_a = 0.0
        self.speed_rad_s = 0.0
        self.angle_rad = math.radians(initial_angle_deg)
        self.temperature_c = AMBIENT_C
        self.load_nm = load_nm
        self.error = 0
        self.entered = False
        self._period_s = 1.0 / rate_hz
        self._timeout_s = timeout_s
        self._age_s = 0.0
        self._due_in_s = self._period_s
        self._answer_id = spec.motor_id if answers_on_own_id else 0
        self._mode: int | None = None
        self._limit_rad_s = math.inf
        self._mit = (0.0, 0.0, 0.0, 0.0, 0.0)
        self._integral_nm = 0.0
        self._outbox: deque[can.Message] = deque()

    @property
    def name(self) -> str:
        """Model and id, "AK80-9:5"."""
        return self.spec.name

    @property
    def erpm(self) -> float:
        """Electrical turns per minute."""
        return self.velocity_rpm * self.model.gear_ratio * self.model.pole_pairs

    @property
    def command_ids(self) -> list[int]:
        """The ids that it listens to: its own, below each command if that is an extended one."""
        if not self.extended:
            return [self.motor_id]
        return [EXTENDED | command << 8 | self.motor_id for command in _LENGTHS]

    def decode_command(self, message: can.Message) -> bool:
        """Takes a frame; returns whether it was for this drive."""
        if (
            message.is_remote_frame
            or message.is_error_frame
            or message.is_fd
            or message.is_extended_id != self.extended
        ):
            return False
        data = bytes(message.data)
        if not self.extended:
            if message.arbitration_id != self.motor_id or len(data) != 8:
                return False
            self._take_mit(data)
        else:
            command, motor_id = message.arbitration_id >> 8, message.arbitration_id & 0xFF
            if motor_id != self.motor_id or len(data) != _LENGTHS.get(command):
                return False
            if command == MIT_V3 and self.protocol is not Protocol.MIT_V3:
                return False
            self._take_servo(command, data)
        self.commands += 1
        self._age_s = 0.0
        return True

    def _take_servo(self, command: int, data: bytes) -> None:
        if command == ORIGIN:
            self.angle_rad = 0.0
            return
        if command == MIT_V3:
            stiffness, damping = _two_of_12_bits(data[0:3])
            velocity, torque = _two_of_12_bits(data[5:8])
            self._obey_mit(int.from_bytes(data[3:5], "big"), velocity, stiffness, damping, torque)
            return
        (raw,) = struct.unpack_from(">i", data)
        self._limit_rad_s = math.inf
        if command == DUTY:
            self.command = _within(raw / 1e5, 1.0)
        elif command in (CURRENT, BRAKE):
            self.command = _within(raw / 1e3, MAX_CURRENT_A)
        elif command == VELOCITY:
            self.command = _within(float(raw), MAX_ERPM)
        else:
            self.command = raw / 1e4
            if command == POSITION_SPEED:
                speed = struct.unpack_from(">h", data, 4)[0] * 10.0
                self._limit_rad_s = abs(self._rad_s(speed))
        self._obey(command)

    def _take_mit(self, data: bytes) -> None:
        if data == ENTER:
            self.entered = True
            self.error = 0
        elif data == EXIT:
            self.entered = False
        elif data == ZERO:
            self.angle_rad = 0.0
        else:
            velocity, stiffness = _two_of_12_bits(data[2:5])
            damping, torque = _two_of_12_bits(data[5:8])
            if self.entered:
                position = int.from_bytes(data[0:2], "big")
                self._obey_mit(position, velocity, stiffness, damping, torque)
        self._outbox.append(self._mit_answer())

    def _obey_mit(
        self, position: int, velocity: int, stiffness: int, damping: int, torque: int
    ) -> None:
        model = self.model
        self._mit = (
            _value(position, 16, -model.position_rad, model.position_rad),
            _value(velocity, 12, -model.velocity_rad_s, model.velocity_rad_s),
            _value(stiffness, 12, 0.0, MAX_STIFFNESS),
            _value(damping, 12, 0.0, MAX_DAMPING),
            _value(torque, 12, -model.torque_nm, model.torque_nm),
        )
        self.command = self._mit[4]
        self._obey(MIT_V3)

    def _obey(self, mode: int) -> None:
        if mode != self._mode:
            self._integral_nm = 0.0
        self._mode = mode

    @property
    def mit(self) -> tuple[float, float, float, float, float]:
        """The last MIT command: rad, rad/s, N·m/rad, N·m·s/rad, N·m."""
        return self._mit

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        parts_s = pieces(dt_s, _MAX_STEP_S)
        self._age_s += dt_s
        if self._timeout_s is not None and self._age_s > self._timeout_s:
            self._mode = None
        for part_s in parts_s:
            self._step(part_s)
        self._due_in_s -= dt_s

    def _step(self, dt_s: float) -> None:
        model = self.model
        full_nm = model.torque_nm
        no_load_rad_s = model.no_load_rpm / RPM_PER_RAD_S
        inertia = full_nm * _SPEED_UP_S / no_load_rad_s
        nm = 0.0 if self.error else _within(self._wanted_nm(inertia, dt_s), full_nm)
        # The supply reaches less and less torque towards the no-load speed.
        nm = min(nm, full_nm * 4 * (1 - self.speed_rad_s / no_load_rad_s))
        nm = max(nm, -full_nm * 4 * (1 + self.speed_rad_s / no_load_rad_s))
        self.current_a = nm / model.output_nm_per_a
        speed = self.speed_rad_s + (nm - self.load_nm) / inertia * dt_s
        friction = _FRICTION * full_nm / inertia * dt_s
        self.speed_rad_s = math.copysign(max(0.0, abs(speed) - friction), speed)
        self.angle_rad += self.speed_rad_s * dt_s

    def _wanted_nm(self, inertia: float, dt_s: float) -> float:
        model = self.model
        if self._mode is None or not (self.extended or self.entered):
            return 0.0
        if self._mode == DUTY:
            no_load_rad_s = model.no_load_rpm / RPM_PER_RAD_S
            return 4 * model.torque_nm * (self.command - self.speed_rad_s / no_load_rad_s)
        if self._mode == CURRENT:
            return self.command * model.output_nm_per_a
        if self._mode == BRAKE:
            limit_nm = max(self.command, 0.0) * model.output_nm_per_a
            return _within(self._velocity_nm(0.0, inertia, dt_s), limit_nm)
        if self._mode == VELOCITY:
            return self._velocity_nm(self._rad_s(self.command), inertia, dt_s)
        if self._mode in (POSITION, POSITION_SPEED):
            error = math.radians(self.command) - self.angle_rad
            wanted = _within(_POSITION_BANDWIDTH_RAD_S * error, self._limit_rad_s)
            return self._velocity_nm(wanted, inertia, dt_s)
        position, velocity, stiffness, damping, torque = self._mit
        return (
            stiffness * (position - self.angle_rad)
            + damping * (velocity - self.speed_rad_s)
            + torque
        )

    def _velocity_nm(self, wanted_rad_s: float, inertia: float, dt_s: float) -> float:
        error_nm = _VELOCITY_BANDWIDTH_RAD_S * inertia * (wanted_rad_s - self.speed_rad_s)
        grown = self._integral_nm + _VELOCITY_BANDWIDTH_RAD_S / 4 * error_nm * dt_s
        if abs(error_nm + grown) <= self.model.torque_nm:
            self._integral_nm = grown
        return error_nm + self._integral_nm

    def _rad_s(self, erpm: float) -> float:
        return erpm / (self.model.pole_pairs * self.model.gear_ratio) / RPM_PER_RAD_S

    def frames(self) -> Iterator[can.Message]:
        """Yields what it sends now: answers, and feedback that is due."""
        while self._outbox:
            yield self._outbox.popleft()
        if self.extended and self._due_in_s <= 1e-9:
            self._due_in_s = max(self._due_in_s + self._period_s, 0.0)
            yield self.feedback()

    def feedback(self) -> can.Message:
        """Returns the feedback of the servo protocol."""
        told_a = self.current_a if self.spec.model.signed_current else abs(self.current_a)
        data = struct.pack(
            ">hhhbB",
            _int16(self.angle_deg * 10.0),
            _int16(self.erpm / 10.0),
            _int16(told_a * 100.0),
            max(-20, min(127, round(self.temperature_c))),
            self.error,
        )
        arbitration_id = FEEDBACK << 8 | self.motor_id
        return can.Message(arbitration_id=arbitration_id, is_extended_id=True, data=data)

    def _mit_answer(self) -> can.Message:
        model = self.model
        position = _code(self.angle_rad, 16, model.position_rad)
        velocity = _code(self.speed_rad_s, 12, model.velocity_rad_s)
        torque = _code(self.current_a * model.output_nm_per_a, 12, model.torque_nm)
        data = bytes(
            (
                self.motor_id,
                position >> 8,
                position & 0xFF,
                velocity >> 4,
                (velocity & 0xF) << 4 | torque >> 8,
                torque & 0xFF,
                max(0, min(255, round(self.temperature_c) + 40)),
                self.error,
            )
        )
        return can.Message(arbitration_id=self._answer_id, is_extended_id=False, data=data)


def _within(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


def _int16(value: float) -> int:
    return max(-32000, min(32000, round(value)))


def _two_of_12_bits(data: bytes) -> tuple[int, int]:
    both = int.from_bytes(data, "big")
    return both >> 12, both & 0xFFF


def _value(code: int, bits: int, low: float, high: float) -> float:
    return low + (high - low) * code / ((1 << bits) - 1)


def _code(value: float, bits: int, reach: float) -> int:
    """Scales without limits, as float_to_uint() of the Mini Cheetah's firmware: it wraps."""
    last = (1 << bits) - 1
    return math.trunc((value + reach) / (2 * reach) * last) & last
