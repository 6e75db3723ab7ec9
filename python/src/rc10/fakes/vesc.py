"""A fake VESC, from the description of its protocol: bldc@b9d287b, documentation/comm_can.md."""

from __future__ import annotations

import math
import struct
from collections import deque
from dataclasses import dataclass
from typing import TYPE_CHECKING

import can

from rc10.fakes.fake import EXTENDED
from rc10.fakes.pieces import pieces
from rc10.fakes.shaft import RPM_PER_RAD_S, Shaft

if TYPE_CHECKING:
    from collections.abc import Iterator

SET_DUTY, SET_CURRENT, SET_CURRENT_BRAKE, SET_RPM, SET_POS = range(5)
SHORT_BUFFER = 8
SET_CURRENT_REL, SET_BRAKE_REL, SET_HANDBRAKE, SET_HANDBRAKE_REL = 10, 11, 12, 13
STATUS, STATUS_4, STATUS_5, STATUS_6 = 9, 16, 27, 58
PING, PONG, NOTIFY_BOOT = 17, 18, 57
BROADCAST = 255

MOTOR_MAX_A = 60.0
SUPPLY_V = 24.0
TIMEOUT_S = 1.0
FAULT_STOP_S = 0.5
MIN_ERPM = 900.0

_GET_VALUES_SELECTIVE = 50
_FAULT_BIT, _STATUS_BIT = 1 << 15, 1 << 21
_STEPS_PER_ELECTRICAL_TURN = 6
_KT_NM_PER_A = 0.08
_KE_VS_PER_RAD = 0.095
_RESISTANCE_OHM = 0.1
_INERTIA_KG_M2 = 2e-4
_FRICTION_NM = 0.01
_MAX_STEP_S = 0.0005

_SCALES = {
    SET_DUTY: 1e5,
    SET_CURRENT: 1e3,
    SET_CURRENT_BRAKE: 1e3,
    SET_RPM: 1.0,
    SET_POS: 1e6,
    SET_CURRENT_REL: 1e5,
    SET_BRAKE_REL: 1e5,
    SET_HANDBRAKE: 1e3,
    SET_HANDBRAKE_REL: 1e5,
}


@dataclass(frozen=True)
class VescAddress:
    """A drive's place on the bus."""

    feedback_id: int


@dataclass(frozen=True)
class VescSpec:
    """A VESC as it is asked for: "VESC:7", or with an encoder "VESC:7:encoder"."""

    motor_id: int
    encoder: bool = False

    @property
    def name(self) -> str:
        """Model and id."""
        return f"VESC:{self.motor_id}"

    @property
    def address(self) -> VescAddress:
        """Its place on the bus."""
        return VescAddress(EXTENDED | STATUS << 8 | self.motor_id)

    @classmethod
    def parse(cls, text: str) -> VescSpec:
        """Reads VESC:ID or VESC:ID:encoder.

        Raises:
            ValueError: it is something else, or no VESC has that id.
        """
        model, _, rest = text.partition(":")
        motor_id, colon, encoder = rest.partition(":")
        known = encoder == "encoder" if colon else True
        if model != "VESC" or not known or not motor_id.isdecimal() or int(motor_id) > 254:
            raise ValueError(f"{text!r}: give VESC:ID or VESC:ID:encoder, with an id of 0 to 254")
        return cls(int(motor_id), encoder=bool(colon))

    def make(self, *, initial_angle_deg: float, load_nm: float) -> FakeVesc:
        """Returns the drive."""
        vesc = FakeVesc(self.motor_id, encoder=self.encoder)
        vesc.angle_rad = math.radians(initial_angle_deg)
        vesc.load_nm = load_nm
        return vesc


class FakeVesc(Shaft):
    """A VESC with firmware 6.00 or later, and a motor without a gear.

    It obeys any SET_* at once, lets its motor go `timeout_s` after the last one, and clears its
    faults by itself. It reads a SET_CURRENT of 6 bytes or more as firmware does: a delay first,
    then the current.

    Public attributes may be read and set at any time:
        current_a: torque-producing; positive drives forwards.
        speed_rad_s: of the shaft.
        angle_rad: multi-turn.
        load_nm: constant torque against positive rotation.
        fault: the code that it tells, see inject_fault().

    Args:
        motor_id: controller id, 0 to 254.
        pole_pairs: of the motor.
        rate_hz: of STATUS and STATUS_5; STATUS_4 comes 5 times a second.
        timeout_s: of its watchdog; 0: it has none.
        encoder: STATUS_4, which has the angle within a turn, comes at rate_hz instead of STATUS_5.
    """

    def __init__(
        self,
        motor_id: int,
        *,
        pole_pairs: int = 7,
        rate_hz: float = 100.0,
        timeout_s: float = TIMEOUT_S,
        encoder: bool = False,
    ) -> None:
        if not 0 <= motor_id <= 254:
            raise ValueError(f"VESC:{motor_id}: a VESC has the ids 0 to 254")
        if pole_pairs < 1:
            raise ValueError(f"VESC:{motor_id}: {pole_pairs} pole pairs are too few")
        self.spec = VescSpec(motor_id, encoder)
        self.name = self.spec.name
        self.motor_id = motor_id
        self.pole_pairs = pole_pairs
        self.commands = 0
        self.current_a = 0.0
        self.speed_rad_s = 0.0
        self.angle_rad = 0.0
        self.load_nm = 0.0
        self.temperature_c = 25.0
        self.duty = 0.0
        self.fault = 0
        self._packet = SET_CURRENT
        self._value = 0.0
        self._period_s = 1.0 / rate_hz
        self._timeout_s = timeout_s
        self._age_s = math.inf  # switched on long ago
        self._fault_left_s = 0.0
        self._fast_in_s = 0.0
        self._slow_in_s = 0.0
        self._speed_integral_a = 0.0
        self._held_rad = 0.0
        self._outbox: deque[can.Message] = deque()

    @property
    def command(self) -> float:
        """Its last command: A, rpm (electrical), degrees or a share, as the command says."""
        return self._value

    @property
    def packet(self) -> int:
        """The command that is in force."""
        return self._packet

    @property
    def timed_out(self) -> bool:
        """Whether its watchdog has let the motor go."""
        return self._timeout_s > 0 and self._age_s > self._timeout_s

    @property
    def command_ids(self) -> list[int]:
        """The ids that it listens to."""
        packets = (*_SCALES, SHORT_BUFFER, PING)
        return [
            EXTENDED | packet << 8 | to for packet in packets for to in (self.motor_id, BROADCAST)
        ]

    def inject_fault(self, code: int) -> None:
        """Shows a fault and obeys nothing for half a second, then goes on."""
        self.fault = code
        self._fault_left_s = FAULT_STOP_S

    def reboot(self) -> None:
        """Counts from 0 again and tells that it has started."""
        self.angle_rad = 0.0
        self._packet, self._value = SET_CURRENT, 0.0
        self._age_s = 0.0
        self._send(NOTIFY_BOOT, self.motor_id, b"60")

    def decode_command(self, message: can.Message) -> bool:
        """Takes a frame; returns whether it was for this drive."""
        if not message.is_extended_id or message.is_error_frame or message.is_fd:
            return False
        packet, to = message.arbitration_id >> 8, message.arbitration_id & 0xFF
        if to not in (self.motor_id, BROADCAST):
            return False
        data = bytes(message.data)
        if packet == SHORT_BUFFER:
            return self._question(data)
        if packet == PING and data:
            self._send(PONG, data[0], bytes([self.motor_id, 0]))
            return True
        if packet not in _SCALES or len(data) < 4:
            return False
        self.commands += 1
        self._age_s = 0.0
        if self._fault_left_s > 0:
            return True
        at = 2 if packet == SET_CURRENT and len(data) >= 6 else 0
        (raw,) = struct.unpack_from(">i", data, at)
        if packet != self._packet:
            self._speed_integral_a = 0.0
            self._held_rad = self.angle_rad
        self._packet, self._value = packet, raw / _SCALES[packet]
        return True

    def _question(self, data: bytes) -> bool:
        if len(data) != 7 or data[1] != 0 or data[2] != _GET_VALUES_SELECTIVE:
            return False
        (mask,) = struct.unpack_from(">I", data, 3)
        values = {_FAULT_BIT: self.fault, _STATUS_BIT: int(self.timed_out)}
        if mask not in values:
            return False
        answer = struct.pack(">BBBIB", self.motor_id, 1, _GET_VALUES_SELECTIVE, mask, values[mask])
        self._send(SHORT_BUFFER, data[0], answer)
        return True

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        parts_s = pieces(dt_s, _MAX_STEP_S)
        self._age_s += dt_s
        self._fault_left_s = max(0.0, self._fault_left_s - dt_s)
        if self._fault_left_s == 0:
            self.fault = 0
        else:
            self._packet, self._value = SET_CURRENT, 0.0
        if self.timed_out:
            self._packet, self._value = SET_CURRENT, 0.0
        for part_s in parts_s:
            self._step(part_s)
        self._tell(dt_s)

    def _wanted_a(self, dt_s: float) -> float:
        value = self._value
        speed = self.speed_rad_s
        if self._packet == SET_CURRENT_REL:
            return value * MOTOR_MAX_A
        if self._packet in (SET_CURRENT_BRAKE, SET_BRAKE_REL):
            most = abs(value) * (MOTOR_MAX_A if self._packet == SET_BRAKE_REL else 1.0)
            return -most * max(-1.0, min(1.0, speed))
        if self._packet in (SET_HANDBRAKE, SET_HANDBRAKE_REL):
            most = abs(value) * (MOTOR_MAX_A if self._packet == SET_HANDBRAKE_REL else 1.0)
            return max(-most, min(most, 20.0 * (self._held_rad - self.angle_rad) - 0.5 * speed))
        if self._packet == SET_RPM:
            if abs(value) < MIN_ERPM:
                return 0.0
            error = value / self.pole_pairs / RPM_PER_RAD_S - speed
            self._speed_integral_a += 2.0 * error * dt_s
            self._speed_integral_a = max(-MOTOR_MAX_A, min(MOTOR_MAX_A, self._speed_integral_a))
            return 0.3 * error + self._speed_integral_a
        if self._packet == SET_POS:
            way_deg = (value - self.angle_deg + 180.0) % 360.0 - 180.0
            return 0.5 * way_deg - 0.5 * speed
        if self._packet == SET_DUTY:
            duty = max(-1.0, min(1.0, value))
            return (duty * SUPPLY_V - _KE_VS_PER_RAD * speed) / _RESISTANCE_OHM
        return value

    def _step(self, dt_s: float) -> None:
        amperes = max(-MOTOR_MAX_A, min(MOTOR_MAX_A, self._wanted_a(dt_s)))
        # As far as the supply reaches against the back-EMF.
        back_emf_v = _KE_VS_PER_RAD * self.speed_rad_s
        high_a = (SUPPLY_V - back_emf_v) / _RESISTANCE_OHM
        low_a = (-SUPPLY_V - back_emf_v) / _RESISTANCE_OHM
        self.current_a = max(low_a, min(high_a, amperes))
        volts = back_emf_v + _RESISTANCE_OHM * self.current_a
        self.duty = max(-1.0, min(1.0, volts / SUPPLY_V))
        torque_nm = _KT_NM_PER_A * self.current_a - self.load_nm
        speed = self.speed_rad_s + torque_nm / _INERTIA_KG_M2 * dt_s
        friction = _FRICTION_NM / _INERTIA_KG_M2 * dt_s
        self.speed_rad_s = math.copysign(max(0.0, abs(speed) - friction), speed)
        self.angle_rad += self.speed_rad_s * dt_s

    def _tell(self, dt_s: float) -> None:
        self._fast_in_s -= dt_s
        self._slow_in_s -= dt_s
        if self._fast_in_s <= 1e-6:
            self._fast_in_s += self._period_s
            self._send(STATUS, self.motor_id, self.status())
            if self.spec.encoder:
                self._send(STATUS_4, self.motor_id, self.status_4())
            else:
                self._send(STATUS_5, self.motor_id, self.status_5())
        if self._slow_in_s <= 1e-6:
            self._slow_in_s += 0.2
            if self.spec.encoder:
                self._send(STATUS_5, self.motor_id, self.status_5())
            else:
                self._send(STATUS_4, self.motor_id, self.status_4())

    def status(self) -> bytes:
        """The payload of STATUS. The current has the sign of the power."""
        power = self.duty * self.current_a
        current_a = math.copysign(self.current_a, power) if power else abs(self.current_a)
        return struct.pack(
            ">ihh",
            int(self.velocity_rpm * self.pole_pairs),
            _int16(current_a * 10),
            _int16(self.duty * 1000),
        )

    def status_4(self) -> bytes:
        """The payload of STATUS_4."""
        return struct.pack(
            ">hhhh",
            _int16(self.temperature_c * 10),
            _int16(self.temperature_c * 10),
            _int16(self.duty * self.current_a * 10),
            _int16(self.angle_deg % 360.0 * 50),
        )

    def status_5(self) -> bytes:
        """The payload of STATUS_5."""
        steps = math.floor(self.angle_rad / math.tau * self.pole_pairs * _STEPS_PER_ELECTRICAL_TURN)
        return struct.pack(">ihh", (steps + 2**31) % 2**32 - 2**31, _int16(SUPPLY_V * 10), 0)

    def frames(self) -> Iterator[can.Message]:
        """Yields what it sends now: answers, and feedback that is due."""
        while self._outbox:
            yield self._outbox.popleft()

    def _send(self, packet: int, to: int, data: bytes) -> None:
        self._outbox.append(
            can.Message(arbitration_id=packet << 8 | to, is_extended_id=True, data=data)
        )


def _int16(value: float) -> int:
    return max(-32768, min(32767, int(value)))
