"""Fake RobStride RS00-RS06, EL05 and CyberGear drives on their private protocol."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING

import can

from rc10.fakes.fake import EXTENDED
from rc10.fakes.pieces import pieces
from rc10.fakes.servo import ModelAtId, ReplyAddress
from rc10.fakes.shaft import RPM_PER_RAD_S

if TYPE_CHECKING:
    from collections.abc import Iterator

# Types of frames: bits 28 to 24 of the id.
_GET_ID, _OPERATE, _FEEDBACK, _ENABLE, _STOP, _SET_ZERO, _SET_ID = 0, 1, 2, 3, 4, 6, 7
_READ, _WRITE, _FAULT, _SAVE, _REPORT = 17, 18, 21, 22, 24

_RUN_MODE, _IQ_REF, _SPD_REF, _LIMIT_TORQUE = 0x7005, 0x7006, 0x700A, 0x700B
_LOC_REF, _LIMIT_SPD, _LIMIT_CUR = 0x7016, 0x7017, 0x7018
_MECH_POS, _IQF, _MECH_VEL, _VBUS = 0x7019, 0x701A, 0x701B, 0x701C
_LOC_KP, _SPD_KP, _SPD_KI = 0x701E, 0x701F, 0x7020

_TAKEN = (_GET_ID, _OPERATE, _ENABLE, _STOP, _SET_ZERO, _SET_ID, _READ, _WRITE, _SAVE)

_OPERATION, _PROFILE, _VELOCITY, _CURRENT, _CYCLIC = 0, 1, 2, 3, 5

_BIG_ENDIAN = struct.Struct(">HHHH")
_PARAMETER = struct.Struct("<HxxI")
_FLOAT = struct.Struct("<f")
_FULL = 65535
_TIMEOUT_COUNTS_PER_S = 20000
_MAX_STEP_S = 0.0005
_HOST_ID = 0xFD
AMBIENT_C = 25.0


@dataclass(frozen=True)
class RobStrideModel:
    """Data of one model by its manuals, at its output.

    Attributes:
        name: "RS00" to "RS06", "EL05" or "CyberGear".
        position_rad: end of the position scale, to each side of zero.
        velocity_rad_s: end of the velocity scale.
        torque_nm: end of the torque scale.
        kp: end of the stiffness scale, N·m/rad.
        kd: end of the damping scale, N·m·s/rad.
        max_a: peak of the phase current.
        nm_per_arms: torque for each effective ampere.
        supply_v: of the fake.
        timeout_index: parameter with the CAN timeout.
        position_mode: run mode that follows positions without a profile.
        turns: position goes on at the other end of the scale.
    """

    name: str
    position_rad: float
    velocity_rad_s: float
    torque_nm: float
    kp: float
    kd: float
    max_a: float
    nm_per_arms: float
    supply_v: float = 48.0
    timeout_index: int = 0x7028
    position_mode: int = _CYCLIC
    turns: bool = True

    @property
    def nm_per_a(self) -> float:
        """Torque for each ampere of the peak value, in which the drive counts."""
        return self.nm_per_arms / math.sqrt(2.0)


ROBSTRIDE_MODELS = (
    RobStrideModel("RS00", 12.57, 33, 14, 500, 5, 15.5, 1.48),
    RobStrideModel("RS01", 12.57, 44, 17, 500, 5, 23, 1.22),
    RobStrideModel("RS02", 12.57, 44, 17, 500, 5, 23, 1.22),
    RobStrideModel("RS03", 12.57, 20, 60, 5000, 100, 43, 2.36),
    RobStrideModel("RS04", 12.57, 15, 120, 5000, 100, 90, 2.1),
    RobStrideModel("RS05", 12.57, 50, 5.5, 500, 5, 11, 0.94),
    RobStrideModel("RS06", 12.57, 50, 36, 5000, 100, 57, 1.09),
    RobStrideModel("EL05", 12.57, 50, 5.5, 500, 5, 11, 0.94),
    RobStrideModel(
        "CyberGear",
        12.5,
        30,
        12,
        500,
        5,
        23,
        0.87,
        supply_v=24.0,
        timeout_index=0x200C,
        position_mode=_PROFILE,
        turns=False,
    ),
)


class RobStrideSpec(ModelAtId[RobStrideModel]):
    """A drive as it is asked for: "RS00:127"."""

    models = ROBSTRIDE_MODELS
    max_id = 127

    @property
    def address(self) -> ReplyAddress:
        """Its place on the bus: the id of its feedback to the usual host, without its state."""
        return ReplyAddress(EXTENDED | _FEEDBACK << 24 | self.motor_id << 8 | _HOST_ID)

    def make(self, *, initial_angle_deg: float = 0.0, load_nm: float = 0.0) -> FakeRobStride:
        """Returns the drive."""
        return FakeRobStride(self, initial_angle_deg=initial_angle_deg, load_nm=load_nm)


def _to_raw(value: float, low: float, high: float) -> int:
    share = (max(low, min(high, value)) - low) / (high - low)
    return int(share * _FULL)


def _from_raw(raw: int, low: float, high: float) -> float:
    return low + raw * (high - low) / _FULL


class FakeRobStride:
    """A drive with its motor. It speaks only when spoken to, but for a fault frame.

    Public attributes may be read and set at any time:
        position_rad, speed_rad_s: of the output, over turns.
        current_a: peak value of the phases; torque-producing.
        temperature_c: of the winding.
        load_nm: constant torque against positive rotation.
        fault_bits: word of the fault frame; `fail()` sets it.
        enabled: it follows its references.

    Args:
        spec: model and id.
        initial_angle_deg: of the output.
        load_nm: see above.
    """

    def __init__(
        self, spec: RobStrideSpec, *, initial_angle_deg: float = 0.0, load_nm: float = 0.0
    ) -> None:
        model = spec.model
        self.spec = spec
        self.model = model
        self.motor_id = spec.motor_id
        self.commands = 0
        self.position_rad = 0.0
        self.speed_rad_s = 0.0
        self.current_a = 0.0
        self.temperature_c = AMBIENT_C
        self.load_nm = load_nm
        self.fault_bits = 0
        self.status_bits = 0
        self.enabled = False
        self.host_id = _HOST_ID
        # Chosen, so that a motor at full torque reaches full speed in a tenth of a second.
        self._inertia = model.torque_nm * 0.1 / model.velocity_rad_s
        self._friction_nm = 0.01 * model.torque_nm
        self._answers: list[can.Message] = []
        self._silence_s = 0.0
        self._kept_nm = 0.0
        self._operation = (0.0, 0.0, 0.0, 0.0, 0.0)
        self._parameters: dict[int, int] = {}
        self._saved: dict[int, int] = {}
        self._power_up()
        self.position_rad = math.radians(initial_angle_deg)

    @property
    def name(self) -> str:
        """Model and id."""
        return self.spec.name

    @property
    def velocity_rpm(self) -> float:
        """Velocity of the output shaft."""
        return self.speed_rad_s * RPM_PER_RAD_S

    @property
    def angle_deg(self) -> float:
        """Multi-turn, of the output shaft."""
        return math.degrees(self.position_rad)

    @property
    def torque_nm(self) -> float:
        """That the motor gives."""
        return self.current_a * self.model.nm_per_a

    @property
    def command(self) -> float:
        """The target in force: N·m, A, rad/s or rad, as its run mode says; 0 while stopped."""
        if not self.enabled:
            return 0.0
        run_mode = self._parameters[_RUN_MODE]
        if run_mode == _OPERATION:
            return self._operation_nm()
        return self.parameter({_CURRENT: _IQ_REF, _VELOCITY: _SPD_REF}.get(run_mode, _LOC_REF))

    # ---- what it hears ---------------------------------------------------------------------------

    @property
    def command_ids(self) -> list[int]:
        """None: see command_filters."""
        return []

    @property
    def command_filters(self) -> list[tuple[int, int]]:
        """Filter of all extended ids that end with its own."""
        return [(EXTENDED | self.motor_id, 0xFF)]

    def decode_command(self, message: can.Message) -> bool:
        """Takes any frame on the bus; returns whether it was for this drive."""
        if (
            not message.is_extended_id
            or message.is_remote_frame
            or message.is_error_frame
            or message.is_fd
            or message.arbitration_id & 0xFF != self.motor_id
            or len(message.data) != 8
        ):
            return False
        kind = message.arbitration_id >> 24
        data = bytes(message.data)
        if kind not in _TAKEN or (kind == _SAVE and self.model.name == "CyberGear"):
            return False
        self.commands += 1
        self._silence_s = 0.0
        if kind != _OPERATE:
            self.host_id = message.arbitration_id >> 8 & 0xFF
        if kind == _SET_ID:
            self.motor_id = message.arbitration_id >> 16 & 0x7F
        if kind in (_GET_ID, _SET_ID):
            self._answer(_GET_ID, self.motor_id, 0xFE, bytes(8))
        elif kind == _READ:
            self._answer_parameter(int.from_bytes(data[:2], "little"))
        else:
            self._obey(kind, message.arbitration_id >> 8 & 0xFFFF, data)
            self._answer_state()
        return True

    def _obey(self, kind: int, extra: int, data: bytes) -> None:
        if kind == _OPERATE:
            self._operate(extra, data)
        elif kind == _ENABLE:
            if not self.fault_bits and not self.status_bits:
                self.enabled = True
        elif kind == _STOP:
            self.enabled = False
            if data[0] == 1:
                self.fault_bits = self.status_bits = 0
        elif kind == _SET_ZERO:
            if data[0] == 1:
                self.position_rad = 0.0
        elif kind == _SAVE:
            kept = set(self._parameters) - {_RUN_MODE, _IQ_REF, _SPD_REF, _LOC_REF}
            self._saved = {index: self._parameters[index] for index in kept}
        elif kind == _WRITE:
            index, bits = _PARAMETER.unpack(data)
            self._write(index, bits)

    def _operate(self, torque: int, data: bytes) -> None:
        model = self.model
        position, velocity, kp, kd = _BIG_ENDIAN.unpack(data)
        if self.enabled and self._parameters[_RUN_MODE] == _OPERATION:
            self._operation = (
                _from_raw(position, -model.position_rad, model.position_rad),
                _from_raw(velocity, -model.velocity_rad_s, model.velocity_rad_s),
                _from_raw(kp, 0.0, model.kp),
                _from_raw(kd, 0.0, model.kd),
                _from_raw(torque, -model.torque_nm, model.torque_nm),
            )

    @property
    def operation(self) -> tuple[float, float, float, float, float]:
        """Position, velocity, kp, kd and torque that it was last told in operation mode."""
        return self._operation

    def _write(self, index: int, bits: int) -> None:
        if index not in self._parameters:
            return
        if index == _RUN_MODE:
            if not self.enabled:
                self._parameters[index] = bits & 0xFF
            return
        if index == self.model.timeout_index:
            self._parameters[index] = min(bits, 100_000)
            return
        (value,) = _FLOAT.unpack(bits.to_bytes(4, "little"))
        if not math.isfinite(value):
            return
        limit = {
            _IQ_REF: self.model.max_a,
            _LIMIT_CUR: self.model.max_a,
            _SPD_REF: self.model.velocity_rad_s,
            _LIMIT_SPD: self.model.velocity_rad_s,
            _LIMIT_TORQUE: self.model.torque_nm,
        }.get(index, math.inf)
        self._set(index, max(-limit, min(limit, value)))

    def _set(self, index: int, value: float) -> None:
        self._parameters[index] = int.from_bytes(_FLOAT.pack(value), "little")

    def parameter(self, index: int) -> float:
        """The number in a parameter that is a float."""
        (value,) = _FLOAT.unpack(self._parameters[index].to_bytes(4, "little"))
        return float(value)

    # ---- what it says ----------------------------------------------------------------------------

    def frames(self) -> Iterator[can.Message]:
        """Yields the frames that it sends now, and forgets them."""
        frames, self._answers = self._answers, []
        yield from frames

    def _answer(self, kind: int, data2: int, target: int, data: bytes) -> None:
        self._answers.append(
            can.Message(
                arbitration_id=kind << 24 | data2 << 8 | target, is_extended_id=True, data=data
            )
        )

    def _answer_state(self) -> None:
        model = self.model
        position = self.position_rad
        if model.turns:
            position = math.remainder(position, 8 * math.pi)
        mode = 2 if self.enabled else 0
        self._answer(
            _FEEDBACK,
            mode << 14 | self.status_bits << 8 | self.motor_id,
            self.host_id,
            _BIG_ENDIAN.pack(
                _to_raw(position, -model.position_rad, model.position_rad),
                _to_raw(self.speed_rad_s, -model.velocity_rad_s, model.velocity_rad_s),
                _to_raw(self.torque_nm, -model.torque_nm, model.torque_nm),
                round(self.temperature_c * 10),
            ),
        )

    def _answer_parameter(self, index: int) -> None:
        measured = {
            _MECH_POS: self.position_rad,
            _IQF: self.current_a,
            _MECH_VEL: self.speed_rad_s,
            _VBUS: self.model.supply_v,
        }
        failed = 0
        if index in measured:
            bits = int.from_bytes(_FLOAT.pack(measured[index]), "little")
        elif index in self._parameters:
            bits = self._parameters[index]
        else:
            bits, failed = 0, 1
        self._answer(_READ, failed << 8 | self.motor_id, self.host_id, _PARAMETER.pack(index, bits))

    # ---- what goes wrong -------------------------------------------------------------------------

    def fail(self, fault_bits: int, status_bits: int = 0) -> None:
        """Makes it report faults: the word of the fault frame, and bits 16 to 21 of the id."""
        self.fault_bits, self.status_bits = fault_bits, status_bits
        self.enabled = False
        self._answer(_FAULT, self.motor_id, self.host_id, struct.pack("<II", fault_bits, 0))

    def restart(self) -> None:
        """As if its power had been away for a moment."""
        self._power_up()

    def _power_up(self) -> None:
        self.enabled = False
        self.fault_bits = self.status_bits = 0
        self._kept_nm = 0.0
        self._operation = (0.0, 0.0, 0.0, 0.0, 0.0)
        if self.model.turns:
            self.position_rad = math.fmod(self.position_rad, math.tau)
        else:
            self.position_rad = 0.0
        self._parameters = {_RUN_MODE: _OPERATION, self.model.timeout_index: 0}
        for index, value in (
            (_IQ_REF, 0.0),
            (_SPD_REF, 0.0),
            (_LOC_REF, 0.0),
            (_LIMIT_TORQUE, self.model.torque_nm),
            (_LIMIT_SPD, 2.0),
            (_LIMIT_CUR, self.model.max_a),
            (_LOC_KP, 30.0),
            (_SPD_KP, 1.0),
            (_SPD_KI, 0.002),
        ):
            self._set(index, value)
        self._parameters.update(self._saved)

    # ---- physics ---------------------------------------------------------------------------------

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        parts_s = pieces(dt_s, _MAX_STEP_S)
        self._silence_s += dt_s
        timeout = self._parameters[self.model.timeout_index] / _TIMEOUT_COUNTS_PER_S
        if timeout and self._silence_s > timeout:
            self.enabled = False
        for part_s in parts_s:
            self._step(part_s)

    def _step(self, dt_s: float) -> None:
        wanted_nm = self._wanted_nm(dt_s) if self.enabled else 0.0
        self.current_a = wanted_nm / self.model.nm_per_a
        speed = self.speed_rad_s + (self.torque_nm - self.load_nm) / self._inertia * dt_s
        friction = self._friction_nm / self._inertia * dt_s
        speed = math.copysign(max(0.0, abs(speed) - friction), speed)
        self.speed_rad_s = speed
        self.position_rad += speed * dt_s
        rise_c = 80.0 * (self.torque_nm / self.model.torque_nm) ** 2
        self.temperature_c += (AMBIENT_C + rise_c - self.temperature_c) * dt_s / 100.0

    def _operation_nm(self) -> float:
        position, velocity, kp, kd, torque = self._operation
        return kp * (position - self.position_rad) + kd * (velocity - self.speed_rad_s) + torque

    def _wanted_nm(self, dt_s: float) -> float:
        run_mode = self._parameters[_RUN_MODE]
        full = self.model.max_a * self.model.nm_per_a
        if run_mode == _OPERATION:
            return max(-full, min(full, self._operation_nm()))
        if run_mode == _CURRENT:
            return self.parameter(_IQ_REF) * self.model.nm_per_a
        limit_nm = max(0.0, self.parameter(_LIMIT_CUR)) * self.model.nm_per_a
        if run_mode == _VELOCITY:
            wanted_rad_s = self.parameter(_SPD_REF)
        else:
            fastest = max(0.0, self.parameter(_LIMIT_SPD))
            wanted_rad_s = 20.0 * (self.parameter(_LOC_REF) - self.position_rad)
            wanted_rad_s = max(-fastest, min(fastest, wanted_rad_s))
        error = wanted_rad_s - self.speed_rad_s
        gain = self._inertia * 100.0
        self._kept_nm = max(-limit_nm, min(limit_nm, self._kept_nm + 10.0 * gain * error * dt_s))
        return max(-limit_nm, min(limit_nm, gain * error + self._kept_nm))
