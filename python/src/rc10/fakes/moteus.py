"""A fake moteus controller: CAN FD, registers, answers only when asked."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import can

from rc10.fakes.fake import EXTENDED
from rc10.fakes.moteus_frames import (
    NAN,
    READ_ERROR,
    READ_ONLY,
    UNKNOWN_REGISTER,
    WRITE_ERROR,
    ProtocolError,
    error,
    pad,
    parse,
    reply,
)
from rc10.fakes.pieces import pieces

if TYPE_CHECKING:
    from collections.abc import Iterator

STOPPED, FAULT, ENABLING, POSITION, TIMEOUT, ZERO_VELOCITY, BRAKE = 0, 1, 2, 10, 11, 12, 15
PWM, VOLTAGE, VOLTAGE_FOC, VOLTAGE_DQ, CURRENT, STAY_WITHIN = 5, 6, 7, 8, 9, 13
_OPEN = (PWM, VOLTAGE, VOLTAGE_FOC, VOLTAGE_DQ)
_DRIVEN = (*_OPEN, CURRENT, POSITION, ZERO_VELOCITY, STAY_WITHIN, BRAKE)
_WATCHED = (POSITION, STAY_WITHIN)

# Command registers after a write of the mode.
_DEFAULTS: dict[int, float] = {
    **dict.fromkeys((*range(0x10, 0x13), *range(0x14, 0x17), *range(0x18, 0x1F)), 0.0),
    0x020: 0.0,
    0x021: 0.0,
    0x022: 0.0,
    0x023: 1.0,
    0x024: 1.0,
    0x025: 100.0,
    0x026: NAN,
    0x027: 0.0,
    0x028: NAN,
    0x029: NAN,
    0x02A: NAN,
    0x02B: 1.0,
    0x02C: NAN,
    0x02D: 0.0,
    0x040: 0.0,
    0x041: 0.0,
}
# Second names, for the mode stay within.
_SAME = {
    0x042: 0x022,
    0x043: 0x023,
    0x044: 0x024,
    0x045: 0x025,
    0x046: 0x027,
    0x047: 0x02B,
    0x048: 0x02D,
}

_ENABLE_S = 0.01
_MAX_STEP_S = 0.00025


@dataclass(frozen=True)
class MoteusAddress:
    """Its place on the bus: what it listens to, and what it answers with."""

    command_id: int
    feedback_id: int


@dataclass(frozen=True)
class MoteusSpec:
    """A controller as it is asked for, moteus:ID."""

    motor_id: int
    prefix: int = 0

    def __post_init__(self) -> None:
        if not 1 <= self.motor_id <= 126:
            raise ValueError(f"{self.name}: moteus has the ids 1 to 126")

    @property
    def name(self) -> str:
        """Model and id."""
        return f"moteus:{self.motor_id}"

    @property
    def address(self) -> MoteusAddress:
        """Its place on the bus, for a host with the id 0."""
        base = self.prefix << 16
        return MoteusAddress(base | 0x8000 | self.motor_id, base | self.motor_id << 8)

    @classmethod
    def parse(cls, text: str) -> MoteusSpec:
        """Reads moteus:ID.

        Raises:
            ValueError: it is something else.
        """
        model, _, motor_id = text.partition(":")
        if model != "moteus" or not motor_id.isdecimal():
            raise ValueError(f"{text!r}: give moteus:ID")
        return cls(int(motor_id))

    def make(self, *, initial_angle_deg: float, load_nm: float) -> FakeMoteus:
        """Returns the controller."""
        return FakeMoteus(
            self.motor_id,
            prefix=self.prefix,
            initial_angle_deg=initial_angle_deg,
            load_nm=load_nm,
        )


class FakeMoteus:
    """One controller with a motor that turns freely. Knows no bus and no clock.

    Attributes:
        mode: register 0x000.
        fault: register 0x00F.
        position_rev: multi-turn, of the output.
        velocity_rev_s: of the output.
        torque_nm: what the motor gives.
        commands: frames that wrote the mode.

    Args:
        motor_id: 1 to 126.
        prefix: can.prefix.
        initial_angle_deg: of the output.
        load_nm: constant torque against positive rotation.
    """

    fd = True
    kt_nm_per_a = 0.0272
    full_torque_nm = 2.7
    inertia_kg_m2 = 1e-4
    friction_nms_per_rad = 1e-4
    default_timeout_s = 0.1

    def __init__(
        self,
        motor_id: int,
        *,
        prefix: int = 0,
        initial_angle_deg: float = 0.0,
        load_nm: float = 0.0,
    ) -> None:
        self.spec = MoteusSpec(motor_id, prefix)
        self.motor_id = motor_id
        self.prefix = prefix
        self.load_nm = load_nm
        self.position_rev = initial_angle_deg / 360.0
        self.velocity_rev_s = 0.0
        self.torque_nm = 0.0
        self.voltage_v = 24.0
        self.temperature_c = 25.0
        self.commands = 0
        self.mode = STOPPED
        self.fault = 0
        self.registers = dict(_DEFAULTS)
        self._wanted_mode = STOPPED
        self._left_s = 0.0
        self._enabling_s = 0.0
        self._course_rev: float | None = None
        self._clock_s = 0.0
        self._answers: list[can.Message] = []

    @property
    def name(self) -> str:
        """Model and id."""
        return self.spec.name

    @property
    def command_ids(self) -> list[int]:
        """None: see command_filters."""
        return []

    @property
    def command_filters(self) -> list[tuple[int, int]]:
        """Filters of all ids that end with its own: of any host, asking for an answer or not."""
        return [
            (EXTENDED | self.prefix << 16 | self.motor_id, 0x1FFF00FF),
            (self.motor_id, 0x1FFFF8FF),
        ]

    @property
    def command(self) -> float:
        """The velocity in rev/s that it was last told."""
        return self.registers[0x021]

    @property
    def velocity_rpm(self) -> float:
        """Velocity of the output."""
        return self.velocity_rev_s * 60.0

    @property
    def speed_rad_s(self) -> float:
        """Speed of the output."""
        return self.velocity_rev_s * math.tau

    @speed_rad_s.setter
    def speed_rad_s(self, speed_rad_s: float) -> None:
        self.velocity_rev_s = speed_rad_s / math.tau

    @property
    def angle_deg(self) -> float:
        """Multi-turn, of the output."""
        return self.position_rev * 360.0

    @property
    def current_a(self) -> float:
        """Current of the motor."""
        return self.torque_nm / self.kt_nm_per_a

    @current_a.setter
    def current_a(self, current_a: float) -> None:
        self.torque_nm = current_a * self.kt_nm_per_a

    def restart(self) -> None:
        """As if its power had been away for a moment."""
        self._stop()
        self.registers = dict(_DEFAULTS)
        self._clock_s = 0.0
        self.position_rev = math.remainder(self.position_rev, 1.0)

    def fail(self, code: int) -> None:
        """Makes it report a fault, until a stop."""
        self._stop()
        self.mode = FAULT
        self.fault = code

    def decode_command(self, message: can.Message) -> bool:
        """Takes any frame on the bus; returns whether it was for this controller."""
        identifier = message.arbitration_id
        if message.is_remote_frame or message.is_error_frame or identifier & 0xFF != self.motor_id:
            return False
        if message.is_extended_id and identifier >> 16 != self.prefix:
            return False
        try:
            subframes = parse(bytes(message.data))
        except ProtocolError:
            return False
        # Readings are from before the command, which acts as a whole.
        commanded = False
        answer = b""
        for part in subframes:
            registers = range(part.start, part.start + part.count)
            if part.kind == "read":
                values = [self._read(r, part.wire_type) for r in registers]
                if None in values:
                    # Nothing after it is read. Source: mjlib/multiplex/micro_server.cc.
                    missing = part.start + values.index(None)
                    answer += error(READ_ERROR, missing, UNKNOWN_REGISTER)
                    break
                answer += reply(part.wire_type, part.start, [v for v in values if v is not None])
            elif part.kind == "write":
                for register, value in zip(registers, part.values):
                    code = self._write(register, value)
                    commanded |= register == 0 and code == 0
                    answer += error(WRITE_ERROR, register, code) if code else b""
        if commanded:
            self._obey()
        if identifier & 0x8000:
            self._answer(message, answer)
        return True

    def _answer(self, question: can.Message, data: bytes) -> None:
        requester = question.arbitration_id >> 8 & 0x7F
        identifier = self.prefix << 16 | self.motor_id << 8 | requester
        self._answers.append(
            can.Message(
                arbitration_id=identifier,
                is_extended_id=identifier > 0x7FF,
                is_fd=question.is_fd or len(data) > 8,
                bitrate_switch=question.bitrate_switch,
                data=pad(data),
            )
        )

    def answers(self) -> list[can.Message]:
        """Returns the frames that it sends now, and forgets them."""
        answers, self._answers = self._answers, []
        return answers

    def frames(self) -> Iterator[can.Message]:
        """Yields what it sends now: the same."""
        yield from self.answers()

    def _read(self, register: int, wire_type: int) -> float | None:
        """Value of a register; None: there is no such, or not of this type."""
        fixed: dict[int, float] = {
            0x000: self.mode,
            0x001: math.remainder(self.position_rev, 65536.0),
            0x002: self.velocity_rev_s,
            0x003: self.torque_nm,
            0x004: self.torque_nm / self.kt_nm_per_a,
            0x005: 0.0,
            0x006: 0.0,
            0x007: self.torque_nm * self.speed_rad_s,
            0x00A: 0.0,
            0x00B: self._course_rev is None or math.isnan(self.registers[0x020]),
            0x00C: 1,
            0x00D: self.voltage_v,
            0x00E: self.temperature_c,
            0x00F: self.fault,
            0x070: (int(self._clock_s * 1000) + 32768) % 65536 - 32768,
        }
        if wire_type == 2:
            fixed[0x102] = 5
        register = _SAME.get(register, register)
        return fixed.get(register, self.registers.get(register))

    def _write(self, register: int, value: float) -> int:
        """Writes a register; returns the code of its error, or 0."""
        if register == 0x000:
            if not 0 <= value <= BRAKE:
                return UNKNOWN_REGISTER
            self._wanted_mode = int(value)
            self.registers = dict(_DEFAULTS)
            return 0
        register = _SAME.get(register, register)
        if register in self.registers:
            self.registers[register] = value
            return 0
        return UNKNOWN_REGISTER if self._read(register, 2) is None else READ_ONLY

    def _obey(self) -> None:
        self.commands += 1
        timeout_s = self.registers[0x027]
        self._left_s = self.default_timeout_s if timeout_s == 0 else timeout_s
        if self._wanted_mode == STOPPED:
            self._stop()
        elif self._wanted_mode in _DRIVEN:
            if self.mode == STOPPED:
                self.mode = ENABLING
                self._enabling_s = 0.0
            elif self.mode in _DRIVEN and self.mode != self._wanted_mode:
                self._change(self._wanted_mode)

    def _stop(self) -> None:
        self._change(STOPPED)
        self.fault = 0
        self.torque_nm = 0.0

    def _change(self, mode: int) -> None:
        self.mode = mode
        self._course_rev = None

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        for part_s in pieces(dt_s, _MAX_STEP_S):
            self._step(part_s)

    def _step(self, dt_s: float) -> None:
        self._clock_s += dt_s
        if self.mode == ENABLING:
            self._enabling_s += dt_s
            if self._enabling_s >= _ENABLE_S:
                self._change(self._wanted_mode)
        if not math.isnan(self._left_s):
            self._left_s = max(0.0, self._left_s - dt_s)
        if self.mode in _WATCHED and self._left_s <= 0.0:
            self._change(TIMEOUT)
        self.torque_nm = self._torque(dt_s)
        speed = self.velocity_rev_s * math.tau
        pushed = speed + (self.torque_nm - self.load_nm) / self.inertia_kg_m2 * dt_s
        speed = pushed / (1.0 + self.friction_nms_per_rad / self.inertia_kg_m2 * dt_s)
        self.velocity_rev_s = speed / math.tau
        self.position_rev += self.velocity_rev_s * dt_s

    def _torque(self, dt_s: float) -> float:
        # Gains that somebody has tuned for this motor: critically damped at 120 rad/s.
        kd = 2 * 120.0 * self.inertia_kg_m2 * math.tau
        if self.mode == POSITION:
            wanted = self._position_torque(dt_s, kd)
            most = self.registers[0x025]
            most = self.full_torque_nm if math.isnan(most) else min(most, self.full_torque_nm)
        elif self.mode == STAY_WITHIN:
            bound = min(max(self.position_rev, self.registers[0x040]), self.registers[0x041])
            away = bound - self.position_rev
            wanted = kd * (60.0 * away - self.velocity_rev_s) if away else 0.0
            wanted += self.registers[0x022]
            most = min(self.registers[0x025], self.full_torque_nm)
        elif self.mode == CURRENT:
            wanted = self.registers[0x01C] * self.kt_nm_per_a
            most = self.full_torque_nm
        elif self.mode in (TIMEOUT, ZERO_VELOCITY, BRAKE, *_OPEN):
            # Voltages without a look at the rotor hold it, here as a brake does.
            wanted = -kd * self.velocity_rev_s
            most = self.full_torque_nm
        else:
            return 0.0
        return max(-most, min(most, wanted))

    def _position_torque(self, dt_s: float, kd: float) -> float:
        command = self.registers
        velocity = 0.0 if math.isnan(command[0x021]) else command[0x021]
        goal = command[0x020]
        if self._course_rev is None:
            self._course_rev = self.position_rev
        limited = not command[0x028] < 0
        if math.isnan(goal):
            self._course_rev += velocity * dt_s
        else:
            # The register goes round; the nearest meaning counts.
            goal = self.position_rev + math.remainder(goal - self.position_rev, 65536.0)
            most = (command[0x028] if command[0x028] > 0 else 5.0) * dt_s
            part = goal - self._course_rev
            if limited and abs(part) > most:
                part = math.copysign(most, part)
                self._course_rev += part
                velocity = part / dt_s
            else:
                self._course_rev = goal + velocity * dt_s
                command[0x020] = NAN
        return (
            command[0x023] * kd * 60.0 * (self._course_rev - self.position_rev)
            + command[0x024] * kd * (velocity - self.velocity_rev_s)
            + command[0x022]
        )
