"""Fake MyActuator RMD-X drives, protocol V3 and V4."""

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

_RESET, _RELEASE_BRAKE, _LOCK_BRAKE, _SHUTDOWN, _STOP = 0x76, 0x77, 0x78, 0x80, 0x81
_ANGLE, _STATUS, _READING = 0x92, 0x9A, 0x9C
_CURRENT, _SPEED, _POSITION = 0xA1, 0xA2, 0xA4
_RUN_TIME, _SILENCE_LIMIT, _SILENCE_NOTICE = 0xB1, 0xB3, 0xF1
_READ_ACCELERATION, _SET_ACCELERATION = 0x42, 0x43
_FUNCTION, _SET_ID = 0x20, 5
_NOTICE_EVERY_S = 1.0

_NEEDS_RESTART = 0x0002 | 0x0010 | 0x0080
_SUPPLY_V = 48.0

_INT16 = struct.Struct("<4xh")
_INT32 = struct.Struct("<4xi")
_UINT32 = struct.Struct("<4xI")
_POSITION_FIELDS = struct.Struct("<2xHi")
_READING_REPLY = struct.Struct("<Bbhhh")
_STATUS_REPLY = struct.Struct("<BbxBHH")
_ANGLE_REPLY = struct.Struct("<B3xi")
_RUN_TIME_REPLY = struct.Struct("<B3xI")


@dataclass(frozen=True)
class MyActuatorModel:
    """Data of one model by its maker, at its output."""

    name: str
    gear_ratio: float
    rated_nm: float
    rated_a: float
    rated_rpm: float
    peak_nm: float

    @property
    def nm_per_a(self) -> float:
        """Torque for each ampere."""
        return self.rated_nm / self.rated_a


MYACTUATOR_MODELS = (
    MyActuatorModel("RMD-X6-7", 6, 3.5, 4.0, 400, 7),
    MyActuatorModel("RMD-X6-8", 8, 4.5, 3.6, 310, 8),
    MyActuatorModel("RMD-X8-20", 6, 10, 5.2, 190, 20),
    MyActuatorModel("RMD-X8-25", 9, 10, 3.2, 110, 25),
    MyActuatorModel("RMD-X8-60", 36, 30, 4.0, 40, 60),
    MyActuatorModel("RMD-X10-40", 7, 15, 6.5, 165, 40),
    MyActuatorModel("RMD-X10-100", 35, 50, 6.7, 50, 100),
)


def _field(raw: int, low: float, high: float, bits: int) -> float:
    return low + raw * (high - low) / ((1 << bits) - 1)


def _raw(value: float, low: float, high: float, bits: int) -> int:
    return round((max(low, min(high, value)) - low) / (high - low) * ((1 << bits) - 1))


class MyActuatorSpec(ModelAtId[MyActuatorModel]):
    """A motor as it is asked for."""

    models = MYACTUATOR_MODELS

    @property
    def address(self) -> ReplyAddress:
        """Its place on the bus."""
        return ReplyAddress(0x240 + self.motor_id)

    def make(self, *, initial_angle_deg: float = 0.0, load_nm: float = 0.0) -> FakeMyActuator:
        """Returns the drive."""
        return FakeMyActuator(self, initial_angle_deg=initial_angle_deg, load_nm=load_nm)


class FakeMyActuator(AnsweringDrive):
    """A drive with its motor. It speaks only when spoken to.

    Public attributes may be read and set at any time:
        servo: the motor; angles and speeds of the output.
        errors: the error word; `fail()` sets it.
        silence_limit_s: 0xB3: after so long without a frame the output is off; 0: never.

    Args:
        spec: model and id.
        initial_angle_deg: of the output.
        load_nm: constant torque against positive rotation.
    """

    def __init__(
        self, spec: MyActuatorSpec, *, initial_angle_deg: float = 0.0, load_nm: float = 0.0
    ) -> None:
        model = spec.model
        super().__init__(spec, Servo(model.peak_nm, model.rated_rpm * 6.0), model.nm_per_a)
        self.servo.angle_deg = initial_angle_deg
        self.servo.load_nm = load_nm
        self.model = model
        self.motor_id = spec.motor_id
        self.errors = 0
        self.silence_limit_s = 0.0
        self.brake_released = False
        self._silence_s = 0.0
        self._stopped_by_silence = False
        self._since_notice_s = 0.0
        self._run_time_s = 0.0
        # Accelerations of position (up, down) and velocity (up, down), deg/s².
        self._accelerations = [1000] * 4

    @property
    def command_ids(self) -> list[int]:
        """Filters of its requests, its motion commands, and requests to all."""
        return [0x140 + self.motor_id, 0x400 + self.motor_id, 0x280]

    def decode_command(self, message: can.Message) -> bool:
        """Takes any frame on the bus; returns whether it was for this drive."""
        data = standard_payload(message)
        if data is None:
            return False
        can_id = message.arbitration_id
        motion = can_id == 0x400 + self.motor_id
        if not motion and can_id not in (0x140 + self.motor_id, 0x280):
            return False
        self.commands += 1
        self._silence_s = 0.0
        if self._stopped_by_silence:
            # The first frame only ends the silence, and comes back as it was.
            self._stopped_by_silence = False
            self._answer(data)
        elif motion:
            self._obey_motion(data)
        else:
            self._obey(data)
        return True

    def _obey(self, data: bytes) -> None:
        code = data[0]
        if code in (_CURRENT, _SPEED, _POSITION):
            if not self.errors:
                self._follow(data)
            self._answer_reading(code)
        elif code == _READING:
            self._answer_reading(code)
        elif code == _ANGLE:
            self._answer(_ANGLE_REPLY.pack(code, round(self.servo.angle_deg * 100)))
        elif code == _STATUS:
            self._answer(
                _STATUS_REPLY.pack(
                    code,
                    round(self.servo.temperature_c),
                    int(self.brake_released),
                    round(_SUPPLY_V * 10),
                    self.errors,
                )
            )
        elif code == _RUN_TIME:
            self._answer(_RUN_TIME_REPLY.pack(code, int(self._run_time_s * 1000) & 0xFFFFFFFF))
        elif code == _RESET:
            self.restart()
        elif code in (_READ_ACCELERATION, _SET_ACCELERATION):
            self._answer_acceleration(data)
        else:
            if code == _SHUTDOWN:
                self.servo.release()
            elif code == _STOP:
                self.servo.follow_speed(0.0)
            elif code in (_RELEASE_BRAKE, _LOCK_BRAKE):
                self.brake_released = code == _RELEASE_BRAKE
            elif code == _FUNCTION:
                self._set_function(data)
                return
            elif code == _SILENCE_LIMIT:
                self.silence_limit_s = _UINT32.unpack(data)[0] * 1e-3
            else:
                return
            self._answer(data)

    def _set_function(self, data: bytes) -> None:
        # Stored at once; the answer is a copy, of the drive that it is now.
        if data[1] == _SET_ID:
            self.motor_id = _UINT32.unpack(data)[0] & 0x3F
        self._answer(data)

    def _answer_acceleration(self, data: bytes) -> None:
        index = data[1]
        if index < len(self._accelerations):
            if data[0] == _SET_ACCELERATION:
                self._accelerations[index] = max(100, min(60_000, _UINT32.unpack(data)[0]))
            else:
                data = data[:4] + self._accelerations[index].to_bytes(4, "little")
        self._answer(data)

    def _follow(self, data: bytes) -> None:
        if data[0] == _CURRENT:
            self.command = _INT16.unpack_from(data)[0] * 0.01
            self.servo.follow_torque(self.command * self.model.nm_per_a)
        elif data[0] == _SPEED:
            self.command = _INT32.unpack(data)[0] * 0.01
            self.servo.follow_speed(self.command)
        else:
            fastest_deg_s, raw = _POSITION_FIELDS.unpack(data)
            self.command = raw * 0.01
            self.servo.follow_angle(self.command, float(fastest_deg_s or 65535))

    def _obey_motion(self, data: bytes) -> None:
        bits = int.from_bytes(data, "big")
        if not self.errors:
            self.servo.follow_motion(
                _field(bits >> 48, -12.5, 12.5, 16),
                _field(bits >> 36 & 0xFFF, -45.0, 45.0, 12),
                _field(bits >> 24 & 0xFFF, 0.0, 500.0, 12),
                _field(bits >> 12 & 0xFFF, 0.0, 5.0, 12),
                _field(bits & 0xFFF, -24.0, 24.0, 12),
            )
        radians = self.servo.angle_deg * 0.017453292519943295
        rad_s = self.servo.speed_deg_s * 0.017453292519943295
        word = (
            _raw(radians, -12.5, 12.5, 16) << 24
            | _raw(rad_s, -45.0, 45.0, 12) << 12
            | _raw(self.servo.torque_nm, -24.0, 24.0, 12)
        )
        self._answer(
            bytes([self.motor_id]) + word.to_bytes(5, "big") + bytes(2), 0x500 + self.motor_id
        )

    def _answer_reading(self, code: int) -> None:
        servo = self.servo
        self._answer(
            _READING_REPLY.pack(
                code,
                round(servo.temperature_c),
                clamped_int16(self._flowing_a * 100),
                clamped_int16(servo.speed_deg_s),
                clamped_int16(servo.angle_deg),
            )
        )

    def _answer(self, data: bytes, can_id: int | None = None) -> None:
        self._answers.append(
            can.Message(
                arbitration_id=0x240 + self.motor_id if can_id is None else can_id,
                is_extended_id=False,
                data=data,
            )
        )

    def fail(self, errors: int) -> None:
        """Makes it report errors, bits of the word of 0x9A; 0 ends those that end by themselves."""
        self.errors = errors | self.errors & _NEEDS_RESTART
        if self.errors:
            self.servo.release()

    def restart(self) -> None:
        """As if its power had been away for a moment: it knows where in a turn it is."""
        self.servo.release()
        self.servo.angle_deg %= 360.0
        self.errors = 0
        self.brake_released = self._stopped_by_silence = False
        self._run_time_s = self._silence_s = 0.0

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        super().step(dt_s)
        self._run_time_s += dt_s
        self._silence_s += dt_s
        limit_s = self.silence_limit_s
        if limit_s and self._silence_s > limit_s and not self._stopped_by_silence:
            self._stopped_by_silence = True
            self.servo.release()
            self._since_notice_s = _NOTICE_EVERY_S
        if self._stopped_by_silence:
            self._since_notice_s += dt_s
            if self._since_notice_s >= _NOTICE_EVERY_S:
                self._since_notice_s = 0.0
                self._answer(bytes([_SILENCE_NOTICE]) + bytes(7))
