"""One fake DJI motor: frames in, physics, frames out. Knows no bus and no clock."""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING

import can

from rc10.fakes.address import CommandKind, MotorSpec
from rc10.fakes.models import GM6020_VOLTAGE_SCALE_RAW, SUPPLY_V
from rc10.fakes.pieces import pieces
from rc10.fakes.shaft import RPM_PER_RAD_S

if TYPE_CHECKING:
    from collections.abc import Iterator

COUNTS = 8192
"""Encoder counts of one rotor turn."""

AMBIENT_C = 25.0

_FEEDBACK = struct.Struct(">HhhBB")
_SLOTS = tuple(struct.Struct(f">{2 * slot}xh") for slot in range(4))

# Longer steps are divided: the back-EMF of an M3508 settles in about 5 ms.
_MAX_STEP_S = 0.001


class FakeMotor:
    """A DJI motor with its drive, on a stiff 24 V supply.

    When commands stop, it holds the last one: these drives have no watchdog that is known, so
    this is what a host must be able to live with. `command_timeout_s` makes a kinder drive.

    Public attributes may be read and set at any time:
        speed_rad_s: of the output shaft, counter-clockwise positive.
        rotor_turns: position of the rotor since the encoder's zero.
        current_a: that flows; torque-producing.
        temperature_c: of the winding.
        load_nm: constant torque against positive rotation, as a hanging weight gives; it turns
            a motor backwards that does not hold it.
        stops_deg: the angles beyond which something hard is in the shaft's way: the ends of an
            axis, a ball that jams a feeder. It stands still there, without bouncing.

    Args:
        spec: model, id, and for a GM6020 the kind of command.
        initial_angle_deg: of the output shaft. An M3508 or M2006 shows only where within one
            rotor turn that is.
        load_nm: see above.
        command_timeout_s: no torque after so long without a command; None: never.
    """

    def __init__(
        self,
        spec: MotorSpec,
        *,
        initial_angle_deg: float = 0.0,
        load_nm: float = 0.0,
        command_timeout_s: float | None = None,
    ) -> None:
        self.spec = spec
        self.address = spec.address
        self.speed_rad_s = 0.0
        self.rotor_turns = initial_angle_deg / 360.0 * spec.model.gear_ratio
        self.current_a = 0.0
        self.temperature_c = AMBIENT_C
        self.load_nm = load_nm
        self.stops_deg = (-math.inf, math.inf)
        self.commands = 0
        self._command_raw = 0
        self._command_timeout_s = command_timeout_s
        self._command_age_s = 0.0
        self._voltage = spec.kind is CommandKind.VOLTAGE
        self._limit_raw = (
            GM6020_VOLTAGE_SCALE_RAW if self._voltage else spec.model.current_scale_raw
        )
        self._unit_per_raw = (
            SUPPLY_V / GM6020_VOLTAGE_SCALE_RAW
            if self._voltage
            else spec.model.current_scale_a / spec.model.current_scale_raw
        )
        self._message = can.Message(
            arbitration_id=self.address.feedback_id, is_extended_id=False, data=bytearray(8)
        )

    @property
    def name(self) -> str:
        """Model and id, "M3508:1"."""
        return self.spec.name

    @property
    def command_ids(self) -> list[int]:
        """The one id that it listens to."""
        return [self.address.command_id]

    @property
    def velocity_rpm(self) -> float:
        """Velocity of the output shaft."""
        return self.speed_rad_s * RPM_PER_RAD_S

    @property
    def angle_deg(self) -> float:
        """Multi-turn angle of the output shaft, from the encoder's zero."""
        return self.rotor_turns / self.spec.model.gear_ratio * 360.0

    @property
    def command(self) -> float:
        """The command in force, in A, or in V for a GM6020 that takes voltages."""
        return self._command_raw * self._unit_per_raw

    def decode_command(self, message: can.Message) -> bool:
        """Takes its command out of a group frame.

        Returns:
            Whether the frame was for this motor: its standard id, and 8 bytes of data.
        """
        if (
            message.arbitration_id != self.address.command_id
            or message.is_extended_id
            or message.is_remote_frame
            or message.is_error_frame
            or len(message.data) != 8
        ):
            return False
        (raw,) = _SLOTS[self.address.slot].unpack_from(message.data)
        self._command_raw = max(-self._limit_raw, min(self._limit_raw, raw))
        self._command_age_s = 0.0
        self.commands += 1
        return True

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        parts_s = pieces(dt_s, _MAX_STEP_S)
        self._command_age_s += dt_s
        timeout_s = self._command_timeout_s
        if timeout_s is not None and self._command_age_s > timeout_s:
            self._command_raw = 0
        for part_s in parts_s:
            self._step(part_s)

    def _step(self, dt_s: float) -> None:
        model = self.spec.model
        speed = self.speed_rad_s
        back_emf = speed / model.no_load_rad_s
        if self._voltage:
            final_a = model.stall_a * (self.command / SUPPLY_V - back_emf)
            self.current_a += (final_a - self.current_a) * -math.expm1(
                -dt_s / model.electrical_lag_s
            )
        else:
            # The drive's own current loop is far quicker than a step: it gives the current that
            # it is told, as far as the supply reaches against the back-EMF.
            high_a = model.stall_a * (1.0 - back_emf)
            low_a = -model.stall_a * (1.0 + back_emf)
            self.current_a = max(low_a, min(high_a, self.command))

        torque_nm = model.kt_nm_per_a * self.current_a - self.load_nm
        speed += torque_nm / model.inertia_kg_m2 * dt_s
        speed /= 1.0 + model.viscous_nms_per_rad / model.inertia_kg_m2 * dt_s
        # Friction slows down and holds; it never turns a motor round.
        friction = model.coulomb_nm / model.inertia_kg_m2 * dt_s
        speed = math.copysign(max(0.0, abs(speed) - friction), speed)

        self.speed_rad_s = speed
        self.rotor_turns += speed / math.tau * model.gear_ratio * dt_s
        self._meet_stops()
        final_c = AMBIENT_C + model.heating_k_per_a2 * self.current_a**2
        self.temperature_c += (final_c - self.temperature_c) * dt_s / model.heating_time_s

    def _meet_stops(self) -> None:
        low, high = (deg / 360.0 * self.spec.model.gear_ratio for deg in self.stops_deg)
        if not low <= self.rotor_turns <= high:
            self.rotor_turns = max(low, min(high, self.rotor_turns))
            self.speed_rad_s = 0.0

    def feedback(self) -> can.Message:
        """Returns its feedback frame.

        It is the same object each time, with other data: copy it to keep it.
        """
        model = self.spec.model
        rpm = self.velocity_rpm * model.gear_ratio
        current_raw = self.current_a / model.current_scale_a * model.current_scale_raw
        temperature = round(self.temperature_c) if model.reports_temperature else 0
        _FEEDBACK.pack_into(
            self._message.data,
            0,
            math.floor(self.rotor_turns * COUNTS) % COUNTS,
            _int16(rpm),
            _int16(current_raw),
            max(0, min(255, temperature)),
            0,
        )
        return self._message

    def frames(self) -> Iterator[can.Message]:
        """Yields what it sends: its feedback frame."""
        yield self.feedback()


def _int16(value: float) -> int:
    return max(-32768, min(32767, round(value)))
