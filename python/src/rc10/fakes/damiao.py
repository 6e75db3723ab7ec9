"""One fake Damiao drive: frames in, physics, frames out. Knows no bus and no clock."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

import can

from rc10.fakes.damiao_model import MODELS
from rc10.fakes.pieces import pieces
from rc10.fakes.shaft import RPM_PER_RAD_S, Shaft
from rc10.spelling import not_one_of

if TYPE_CHECKING:
    from collections.abc import Iterator

AMBIENT_C = 25.0
MOS_C = 30.0

DISABLED = 0
ENABLED = 1
COMMUNICATION_LOST = 0xD

READ = 0x33
WRITE = 0x55
SAVE = 0xAA
STATE = 0xCC
REGISTER_ID = 0x7FF

_ENABLE, _DISABLE, _ZERO, _CLEAR = 0xFC, 0xFD, 0xFE, 0xFB
_SEVEN_FF = bytes([0xFF] * 7)
_TWO_FLOATS = struct.Struct("<ff")
_FLOAT = struct.Struct("<f")
_UINT = struct.Struct("<I")
_HYBRID = struct.Struct("<fHH")
_TIMEOUT_STEP_S = 50e-6
_MAX_STEP_S = 0.001
# Answers that wait for the end of a tick; more than a host can make sense of.
_MAX_WAITING = 32


class Register(IntEnum):
    """The registers that this drive has."""

    UV = 0
    KT = 1
    OT = 2
    OC = 3
    ACC = 4
    DEC = 5
    MAX_SPD = 6
    MST_ID = 7
    ESC_ID = 8
    TIMEOUT = 9
    CTRL_MODE = 10
    DAMPING = 11
    INERTIA = 12
    HW_VER = 13
    SW_VER = 14
    SN = 15
    NPP = 16
    RS = 17
    LS = 18
    FLUX = 19
    GEAR = 20
    PMAX = 21
    VMAX = 22
    TMAX = 23
    OV = 29
    P_M = 80
    XOUT = 81


_WHOLE = (
    Register.MST_ID,
    Register.ESC_ID,
    Register.TIMEOUT,
    Register.CTRL_MODE,
    Register.HW_VER,
    Register.SW_VER,
    Register.SN,
    Register.NPP,
)


# Written and kept, without effect here.
_KEPT = (
    Register.UV,
    Register.OT,
    Register.OC,
    Register.ACC,
    Register.DEC,
    Register.MAX_SPD,
    Register.OV,
)


class Mode(IntEnum):
    """Register CTRL_MODE; also 1 + the third nibble of the ids of its commands."""

    MIT = 1
    POS_VEL = 2
    VEL = 3
    POS_FORCE = 4


@dataclass(frozen=True)
class DamiaoAddress:
    """A drive's place on the bus: its CAN ID, and the master id on which it answers."""

    can_id: int
    master_id: int

    @property
    def feedback_id(self) -> int:
        """Identity of its feedback: the master id, and above its bits the low nibble.

        Drives may share a master id: the nibble is in byte 0 of their frames.
        """
        return (self.can_id & 0x0F) << 11 | self.master_id


@dataclass(frozen=True)
class DamiaoSpec:
    """A drive as it is asked for: "DM4310:1", or "DM4310:1:0" with the master id 0.

    "DM4310:1:17:fd": its CAN baud is above 1 Mbit/s, so that it answers in CAN FD frames.
    """

    model: str
    can_id: int
    master_id: int
    fd: bool = False

    @property
    def name(self) -> str:
        """Model and id."""
        return f"{self.model}:{self.can_id}"

    @property
    def address(self) -> DamiaoAddress:
        """Its place on the bus."""
        return DamiaoAddress(self.can_id, self.master_id)

    @classmethod
    def parse(cls, text: str) -> DamiaoSpec:
        """Reads MODEL:ID[:MASTER[:fd]]; by custom the master id is 16 above the id.

        Raises:
            ValueError: it is something else, or there is no such drive.
        """
        model, *rest = text.split(":")
        if model not in MODELS:
            raise ValueError(not_one_of(text, model, MODELS))
        fd = rest[2:] == ["fd"]
        if fd:
            rest.pop()
        if len(rest) not in (1, 2) or not all(part.isdecimal() for part in rest):
            raise ValueError(f"{text!r}: give {model}:ID, {model}:ID:MASTER_ID or that with :fd")
        can_id = int(rest[0])
        master_id = int(rest[1]) if len(rest) == 2 else can_id + 16
        if not 1 <= can_id <= 15:
            raise ValueError(f"{text}: ids of Damiao drives are 1 to 15")
        if not 0 <= master_id < REGISTER_ID or master_id & 0xFF == can_id:
            raise ValueError(f"{text}: {master_id} is no master id of a drive with the id {can_id}")
        return cls(model, can_id, master_id, fd)

    def make(self, *, initial_angle_deg: float, load_nm: float) -> FakeDamiao:
        """Returns the drive."""
        return FakeDamiao(self, initial_angle_deg=initial_angle_deg, load_nm=load_nm)


def to_code(value: float, limit: float, bits: int) -> int:
    """Maps -limit..limit to 0..2^bits - 1; what lies outside wraps, as in the drive."""
    return math.trunc((value + limit) / (2 * limit) * ((1 << bits) - 1)) & ((1 << bits) - 1)


def from_code(code: int, limit: float, bits: int) -> float:
    """The inverse of to_code()."""
    return code * 2 * limit / ((1 << bits) - 1) - limit


@dataclass
class Target:
    """Last command of a drive, kept until it is disabled."""

    mode: Mode = Mode.MIT
    position_rad: float = 0.0
    velocity_rad_s: float = 0.0
    kp: float = 0.0
    kd: float = 0.0
    torque_nm: float = 0.0
    current_pu: float = 0.0


class FakeDamiao(Shaft):
    """A Damiao drive with its motor, on a supply that gives its no-load speed.

    Public attributes may be read and set at any time:
        speed_rad_s, angle_rad: of the shaft; the drive counts angle_rad on over turns.
        current_a: that flows; torque-producing.
        temperature_c: of the winding.
        load_nm: constant torque against positive rotation.
        status: DISABLED, ENABLED, or the code of a fault, latched until it is cleared.
        registers: their values.

    Args:
        spec: model, id and master id.
        initial_angle_deg: of the output shaft, which its second encoder knows.
        load_nm: see above.
        timeout: the register as saved in flash, in steps of 50 us; 0: no watchdog.
    """

    def __init__(
        self,
        spec: DamiaoSpec,
        *,
        initial_angle_deg: float = 0.0,
        load_nm: float = 0.0,
        timeout: int = 0,
    ) -> None:
        model = MODELS[spec.model]
        self.spec = spec
        self.model = model
        self.speed_rad_s = 0.0
        self.angle_rad = math.remainder(math.radians(initial_angle_deg), math.tau)
        self.current_a = 0.0
        self.temperature_c = AMBIENT_C
        self.load_nm = load_nm
        self.commands = 0
        self.status = DISABLED
        self.can_id = spec.can_id
        self.master_id = spec.master_id
        self.target = Target()
        self.registers: dict[Register, float] = {}
        self._saved: dict[Register, float] = {
            Register.MST_ID: spec.master_id,
            Register.ESC_ID: spec.can_id,
            Register.TIMEOUT: timeout,
            Register.CTRL_MODE: Mode.MIT,
            Register.GEAR: model.gear,
            # Read only; what the model's data do not have is 0.
            Register.KT: model.kt_nm_per_a,
            Register.HW_VER: 1,
            Register.SW_VER: 1,
            Register.SN: 1,
            **dict.fromkeys(
                (
                    *_KEPT,
                    Register.DAMPING,
                    Register.INERTIA,
                    Register.NPP,
                    Register.RS,
                    Register.LS,
                    Register.FLUX,
                ),
                0.0,
            ),
            Register.PMAX: model.p_max_rad,
            Register.VMAX: model.v_max_rad_s,
            Register.TMAX: model.t_max_nm,
        }
        self.registers.update(self._saved)
        self._silence_s = 0.0
        self._integral_nm = 0.0
        self._waiting: list[bytes] = []
        torque_nm = model.kt_nm_per_a * model.max_a
        self._coulomb_nm = 0.01 * torque_nm
        self._viscous_nms_per_rad = 0.01 * torque_nm / self._no_load_rad_s

    @property
    def name(self) -> str:
        """Model and id, "DM4310:1"."""
        return self.spec.name

    @property
    def command_ids(self) -> list[int]:
        """The ids that it listens to: all that end in its own, and that of the registers."""
        return [*(family << 8 | self.can_id for family in range(8)), REGISTER_ID]

    @property
    def command(self) -> float:
        """The target in force: torque, speed or position by its mode; 0 while disabled."""
        if self.status != ENABLED:
            return 0.0
        if self.target.mode is Mode.MIT:
            return self._mit_nm()
        if self.target.mode is Mode.VEL:
            return self.target.velocity_rad_s
        return self.target.position_rad

    @property
    def fd(self) -> bool:
        """Whether it speaks CAN FD."""
        return self.spec.fd

    @property
    def _no_load_rad_s(self) -> float:
        return self.model.no_load_rpm / RPM_PER_RAD_S

    def decode_command(self, message: can.Message) -> bool:
        """Takes a frame, and has its answer wait.

        Returns:
            Whether it was for this drive.
        """
        if message.is_extended_id or message.is_error_frame or message.is_remote_frame:
            return False
        if message.is_fd and not self.fd:
            return False
        data = bytes(message.data).ljust(8, b"\0")
        if message.arbitration_id == REGISTER_ID:
            return self._register(data)
        if message.arbitration_id & 0xFF != self.can_id:
            return False
        self.commands += 1
        self._silence_s = 0.0
        if len(message.data) == 8 and data[:7] == _SEVEN_FF and data[7] >= _CLEAR:
            self._special(data[7])
        else:
            self._setpoint(message.arbitration_id >> 8, data)
        self._answer(self.feedback())
        return True

    def _special(self, command: int) -> None:
        if command == _ENABLE and self.status == DISABLED:
            self.status = ENABLED
        elif command == _DISABLE:
            self._disarm(DISABLED if self.status == ENABLED else self.status)
        elif command == _CLEAR:
            self._disarm(DISABLED)
        elif command == _ZERO:
            self.angle_rad = 0.0

    def _disarm(self, status: int) -> None:
        self.status = status
        self.target = Target(Mode(int(self.registers[Register.CTRL_MODE])))
        self._integral_nm = 0.0

    def _setpoint(self, family: int, data: bytes) -> None:
        mode = Mode(int(self.registers[Register.CTRL_MODE]))
        if family + 1 != mode:
            return
        target = Target(mode)
        if mode is Mode.MIT:
            bits = int.from_bytes(data, "big")
            p_max, v_max, t_max = self._scale()
            target.position_rad = from_code(bits >> 48, p_max, 16)
            target.velocity_rad_s = from_code(bits >> 36 & 0xFFF, v_max, 12)
            target.kp = (bits >> 24 & 0xFFF) / 4095 * 500.0
            target.kd = (bits >> 12 & 0xFFF) / 4095 * 5.0
            target.torque_nm = from_code(bits & 0xFFF, t_max, 12)
        elif mode is Mode.POS_VEL:
            target.position_rad, target.velocity_rad_s = _TWO_FLOATS.unpack(data)
        elif mode is Mode.VEL:
            (target.velocity_rad_s,) = _FLOAT.unpack_from(data)
        else:
            target.position_rad, speed, current = _HYBRID.unpack(data)
            target.velocity_rad_s = min(speed, 10_000) / 100.0
            target.current_pu = min(current, 10_000) / 10_000.0
        numbers = (target.position_rad, target.velocity_rad_s)
        if all(math.isfinite(number) for number in numbers):
            self.target = target

    def _scale(self) -> tuple[float, float, float]:
        return (
            self.registers[Register.PMAX],
            self.registers[Register.VMAX],
            self.registers[Register.TMAX],
        )

    def _register(self, data: bytes) -> bool:
        if data[0] | data[1] << 8 != self.can_id:
            return False
        self.commands += 1
        operation, address = data[2], data[3]
        if operation == STATE:
            self._answer(self.feedback())
        elif operation == SAVE:
            # Only while disabled.
            if self.status != ENABLED:
                self._saved = dict(self.registers)
                self._answer(data[:3] + bytes([1]) + bytes(4))
        elif operation in (READ, WRITE) and address in list(Register):
            register = Register(address)
            if operation == WRITE and not self._write(register, data[4:8]):
                return True
            self._answer(data[:4] + self._value(register))
        return True

    def _value(self, register: Register) -> bytes:
        if register is Register.XOUT:
            return _FLOAT.pack(self.angle_rad)
        if register is Register.P_M:
            return _FLOAT.pack(math.remainder(self.angle_rad * self.model.gear, math.tau))
        value = self.registers[register]
        if register in _WHOLE:
            return _UINT.pack(int(value))
        return _FLOAT.pack(value)

    def _write(self, register: Register, raw: bytes) -> bool:
        (number,) = _FLOAT.unpack(raw)
        (whole,) = _UINT.unpack(raw)
        if register is Register.TIMEOUT:
            self.registers[register] = whole
        elif register is Register.CTRL_MODE and whole in list(Mode):
            if whole != self.registers[register]:
                self.registers[register] = whole
                self.target = Target(Mode(whole))
        elif register in (Register.PMAX, Register.VMAX, Register.TMAX) and 0 < number < math.inf:
            self.registers[register] = number
        elif register in (Register.MST_ID, Register.ESC_ID):
            # Counts from the next start on.
            self.registers[register] = whole if register is Register.MST_ID else whole & 0xFF
        elif register in _KEPT and math.isfinite(number):
            self.registers[register] = number
        else:
            return False
        return True

    def _answer(self, data: bytes) -> None:
        if len(self._waiting) < _MAX_WAITING:
            self._waiting.append(data)

    def feedback(self) -> bytes:
        """Returns the data of its state frame."""
        p_max, v_max, t_max = self._scale()
        position = to_code(self.angle_rad, p_max, 16)
        speed = to_code(self.speed_rad_s, v_max, 12)
        torque = to_code(self.current_a * self.model.kt_nm_per_a, t_max, 12)
        return bytes(
            [
                self.status << 4 | self.can_id & 0x0F,
                position >> 8,
                position & 0xFF,
                speed >> 4,
                (speed & 0xF) << 4 | torque >> 8,
                torque & 0xFF,
                int(MOS_C) & 0xFF,
                int(self.temperature_c) & 0xFF,
            ]
        )

    def frames(self) -> Iterator[can.Message]:
        """Yields its answers to what it was sent; it never speaks unasked."""
        waiting, self._waiting = self._waiting, []
        for data in waiting:
            yield can.Message(
                arbitration_id=self.master_id,
                is_extended_id=False,
                is_fd=self.fd,
                bitrate_switch=self.fd,
                data=data,
            )

    def fail(self, code: int) -> None:
        """Latches a fault."""
        self._disarm(code)

    def restart(self) -> None:
        """As if its power had been away for a moment."""
        self.registers.update(self._saved)
        self.can_id = int(self.registers[Register.ESC_ID])
        self.master_id = int(self.registers[Register.MST_ID])
        self._disarm(DISABLED)
        self.angle_rad = math.remainder(self.angle_rad, math.tau)

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        parts_s = pieces(dt_s, _MAX_STEP_S)
        self._silence_s += dt_s
        timeout_s = self.registers[Register.TIMEOUT] * _TIMEOUT_STEP_S
        if self.status == ENABLED and 0 < timeout_s < self._silence_s:
            self.fail(COMMUNICATION_LOST)
        for part_s in parts_s:
            self._step(part_s)

    def _mit_nm(self) -> float:
        target = self.target
        return (
            target.kp * (target.position_rad - self.angle_rad)
            + target.kd * (target.velocity_rad_s - self.speed_rad_s)
            + target.torque_nm
        )

    def _wanted_nm(self, dt_s: float) -> float:
        if self.status != ENABLED:
            return 0.0
        target = self.target
        limit_nm = self.model.max_a * self.model.kt_nm_per_a
        if target.mode is Mode.MIT:
            return max(-limit_nm, min(limit_nm, self._mit_nm()))
        speed = target.velocity_rad_s
        if target.mode is not Mode.VEL:
            bound = abs(speed)
            speed = max(-bound, min(bound, 20.0 * (target.position_rad - self.angle_rad)))
        if target.mode is Mode.POS_FORCE:
            limit_nm *= target.current_pu
        # Tuned for its own inertia.
        error = speed - self.speed_rad_s
        gain = self.model.inertia_kg_m2 * 100.0
        grown = self._integral_nm + gain * 25.0 * error * dt_s
        if abs(gain * error + grown) <= limit_nm:
            self._integral_nm = grown
        return max(-limit_nm, min(limit_nm, gain * error + self._integral_nm))

    def _step(self, dt_s: float) -> None:
        model = self.model
        # The supply drives any current between two lines that fall with the speed.
        stall_nm = 3.0 * model.kt_nm_per_a * model.max_a
        back_emf = self.speed_rad_s / self._no_load_rad_s
        torque_nm = max(
            stall_nm * (-1.0 - back_emf), min(stall_nm * (1.0 - back_emf), self._wanted_nm(dt_s))
        )
        if self.status != ENABLED:
            torque_nm = 0.0
        self.current_a = torque_nm / model.kt_nm_per_a
        speed = self.speed_rad_s
        speed += (torque_nm - self.load_nm) / model.inertia_kg_m2 * dt_s
        speed /= 1.0 + self._viscous_nms_per_rad / model.inertia_kg_m2 * dt_s
        friction = self._coulomb_nm / model.inertia_kg_m2 * dt_s
        speed = math.copysign(max(0.0, abs(speed) - friction), speed)
        self.speed_rad_s = speed
        self.angle_rad += speed * dt_s
        final_c = AMBIENT_C + 60.0 * (self.current_a / model.max_a) ** 2
        self.temperature_c += (final_c - self.temperature_c) * dt_s / 60.0
