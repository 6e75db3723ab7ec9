"""Fake LK-Tech MF, MHF and MG drives."""

from __future__ import annotations

import struct
from dataclasses import dataclass

import can

from rc10.fakes.servo import (
    AnsweringDrive,
    ModelAtId,
    ReplyAddress,
    Servo,
    clamped_int16,
    standard_payload,
)

_OFF, _STOP, _ON = 0x80, 0x81, 0x88
_ANGLE, _STATUS, _CLEAR, _READING = 0x92, 0x9A, 0x9B, 0x9C
_CURRENT, _SPEED, _ANGLE_FREE, _ANGLE_BOUNDED = 0xA1, 0xA2, 0xA3, 0xA4
_GROUP_ID = 0x280

_MF_A, _MG_A = 33.0 / 4096.0, 66.0 / 4096.0
_SUPPLY_V = 24.0

_INT16 = struct.Struct("<4xh")
_SPEED_FIELDS = struct.Struct("<2xhi")
_ANGLE_FIELDS = struct.Struct("<2xHi")
_GROUP_FIELDS = struct.Struct("<4h")
_READING_REPLY = struct.Struct("<BbhhH")
_STATUS_REPLY = struct.Struct("<BbHhBB")


@dataclass(frozen=True)
class LKTechModel:
    """One model.

    Attributes:
        name: as in the configuration.
        gear_ratio: angles and speeds on the bus are those of the rotor.
        amperes_per_raw: of currents in frames.
        rotor_nm_per_a: torque at the rotor.
        peak_nm: at the output.
        fast_rpm: of the output; chosen.
    """

    name: str
    gear_ratio: float
    amperes_per_raw: float
    rotor_nm_per_a: float
    peak_nm: float
    fast_rpm: float

    @property
    def nm_per_a(self) -> float:
        """Torque at the output for each ampere."""
        return self.rotor_nm_per_a * self.gear_ratio


LKTECH_MODELS = (
    LKTechModel("LK-MF9025", 1, _MF_A, 0.32, 4.2, 300),
    LKTechModel("LK-MHF7015", 1, _MG_A, 0.51, 2.42, 300),
    LKTechModel("LK-MG4005E-i10", 10, _MG_A, 0.06, 2.5, 300),
    LKTechModel("LK-MG4010E-i10", 10, _MG_A, 0.07, 4.5, 300),
    LKTechModel("LK-MG5010E-i10", 10, _MG_A, 0.1, 7.0, 300),
    LKTechModel("LK-MG5010E-i36", 36, _MG_A, 0.3, 25.0, 60),
    LKTechModel("LK-MG6012E-i8", 8, _MG_A, 1.09 / 8, 16.0, 200),
)


class LKTechSpec(ModelAtId[LKTechModel]):
    """A motor as it is asked for."""

    models = LKTECH_MODELS

    @property
    def address(self) -> ReplyAddress:
        """Its place on the bus."""
        return ReplyAddress(0x140 + self.motor_id)

    def make(self, *, initial_angle_deg: float = 0.0, load_nm: float = 0.0) -> FakeLKTech:
        """Returns the drive."""
        return FakeLKTech(self, initial_angle_deg=initial_angle_deg, load_nm=load_nm)


class FakeLKTech(AnsweringDrive):
    """A drive with its motor. It speaks only when spoken to, and on the same id.

    Public attributes may be read and set at any time:
        servo: the motor; angles and speeds of the output.
        on: it follows what it is told; so after power-up.
        errors: the error byte; `fail()` sets it.

    Args:
        spec: model and id.
        initial_angle_deg: of the output.
        load_nm: constant torque against positive rotation.
    """

    def __init__(
        self, spec: LKTechSpec, *, initial_angle_deg: float = 0.0, load_nm: float = 0.0
    ) -> None:
        model = spec.model
        super().__init__(spec, Servo(model.peak_nm, model.fast_rpm * 6.0), model.nm_per_a)
        self.servo.angle_deg = initial_angle_deg
        self.servo.load_nm = load_nm
        self.model = model
        self.motor_id = spec.motor_id
        self.on = True
        self.errors = 0
        self._cause = 0

    @property
    def _own_id(self) -> int:
        return 0x140 + self.motor_id

    @property
    def command_ids(self) -> list[int]:
        """Filters of its own id, and of the frame of the ids 1 to 4."""
        return [self._own_id, _GROUP_ID] if self.motor_id <= 4 else [self._own_id]

    def decode_command(self, message: can.Message) -> bool:
        """Takes any frame on the bus; returns whether it was for this drive."""
        data = standard_payload(message)
        if data is None:
            return False
        if message.arbitration_id == self._own_id:
            self.commands += 1
            self._obey(data)
        elif message.arbitration_id == _GROUP_ID and self.motor_id <= 4:
            self.commands += 1
            raw = _GROUP_FIELDS.unpack(data)[self.motor_id - 1]
            self._follow_current(max(-2000, min(2000, raw)))
            self._answer_reading(_CURRENT)
        else:
            return False
        return True

    def _obey(self, data: bytes) -> None:
        code = data[0]
        if code in (_CURRENT, _SPEED, _ANGLE_FREE, _ANGLE_BOUNDED):
            self._follow(data)
            self._answer_reading(code)
        elif code == _READING:
            self._answer_reading(code)
        elif code == _ANGLE:
            raw = round(self.servo.angle_deg * self.model.gear_ratio * 100)
            self._answer(bytes([code]) + (raw & (1 << 56) - 1).to_bytes(7, "little"))
        elif code in (_STATUS, _CLEAR):
            if code == _CLEAR:
                self.errors = self._cause
            state = 0x00 if self.on else 0x10
            volts = round(_SUPPLY_V * 100)
            temperature = round(self.servo.temperature_c)
            self._answer(_STATUS_REPLY.pack(code, temperature, volts, 0, state, self.errors))
        elif code in (_OFF, _STOP, _ON):
            if code != _ON:
                self.servo.release()
            if code == _OFF:
                self.servo.angle_deg %= 360.0
            if code != _STOP:
                self.on = code == _ON
            self._answer(data)

    def _follow_current(self, raw: int) -> None:
        if self.on and not self.errors:
            self.command = max(-2048, min(2048, raw)) * self.model.amperes_per_raw
            self.servo.follow_torque(self.command * self.model.nm_per_a)

    def _follow(self, data: bytes) -> None:
        if not self.on or self.errors:
            return
        gear = self.model.gear_ratio
        if data[0] == _CURRENT:
            self._follow_current(_INT16.unpack_from(data)[0])
        elif data[0] == _SPEED:
            limit, raw = _SPEED_FIELDS.unpack(data)
            limit_nm = abs(limit) * self.model.amperes_per_raw * self.model.nm_per_a
            self.command = raw * 0.01
            self.servo.follow_speed(self.command / gear, limit_nm)
        else:
            fastest, raw = _ANGLE_FIELDS.unpack(data)
            self.command = raw * 0.01
            free = data[0] == _ANGLE_FREE or fastest == 0
            self.servo.follow_angle(self.command / gear, (65535 if free else fastest) / gear)

    def _answer_reading(self, code: int) -> None:
        servo = self.servo
        self._answer(
            _READING_REPLY.pack(
                code,
                round(servo.temperature_c),
                clamped_int16(self._flowing_a / self.model.amperes_per_raw),
                clamped_int16(servo.speed_deg_s * self.model.gear_ratio),
                int(servo.angle_deg % 360.0 / 360.0 * 65536) % 65536,
            )
        )

    def _answer(self, data: bytes) -> None:
        self._answers.append(
            can.Message(arbitration_id=self._own_id, is_extended_id=False, data=data)
        )

    def fail(self, errors: int) -> None:
        """Makes it report errors, bits of the byte of 0x9A; 0 takes their cause away."""
        self._cause = errors
        self.errors |= errors
        if self.errors:
            self.servo.release()

    def restart(self) -> None:
        """As if its power had been away for a moment: it knows where in a turn it is."""
        self.servo.release()
        self.servo.angle_deg %= 360.0
        self.on = True
        self.errors = self._cause
