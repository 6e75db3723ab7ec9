"""One fake ODrive axis on CANSimple: frames in, physics, frames out. Knows no bus and no clock."""

from __future__ import annotations

import math
import struct
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

import can

from rc10.fakes.pieces import pieces
from rc10.fakes.shaft import RPM_PER_RAD_S
from rc10.spelling import not_one_of

if TYPE_CHECKING:
    from collections.abc import Iterator

AMBIENT_C = 25.0
SUPPLY_V = 24.0

_MAX_STEP_S = 0.001
_HEARTBEAT_S = 0.1
# After power-up: no frame, then heartbeats of a drive that does not obey yet.
_SILENT_S, _BOOT_S = 0.3, 1.5
UNDEFINED, INITIALIZING = 0, 1
_TWO_FLOATS = struct.Struct("<ff")
_POSITION = struct.Struct("<fhh")
_TWO_INTS = struct.Struct("<ii")
_FLOAT = struct.Struct("<f")
_UINT = struct.Struct("<I")
_HEARTBEAT = struct.Struct("<IBBBB")


class Cmd(IntEnum):
    """The low five bits of an id."""

    HEARTBEAT = 0x01
    ESTOP = 0x02
    SET_AXIS_STATE = 0x07
    GET_ENCODER_ESTIMATES = 0x09
    SET_CONTROLLER_MODE = 0x0B
    SET_INPUT_POS = 0x0C
    SET_INPUT_VEL = 0x0D
    SET_INPUT_TORQUE = 0x0E
    SET_LIMITS = 0x0F
    GET_IQ = 0x14
    GET_TEMPERATURE = 0x15
    REBOOT = 0x16
    GET_BUS_VOLTAGE_CURRENT = 0x17
    CLEAR_ERRORS = 0x18
    GET_TORQUES = 0x1C


IDLE = 1
CLOSED_LOOP = 8

TORQUE = 1
VELOCITY = 2
POSITION = 3

# Told when a remote frame asks for it.
_ASKED = (
    Cmd.HEARTBEAT,
    Cmd.GET_ENCODER_ESTIMATES,
    Cmd.GET_IQ,
    Cmd.GET_TEMPERATURE,
    Cmd.GET_BUS_VOLTAGE_CURRENT,
    Cmd.GET_TORQUES,
)

_HEARD = (
    *_ASKED,
    Cmd.ESTOP,
    Cmd.SET_AXIS_STATE,
    Cmd.SET_CONTROLLER_MODE,
    Cmd.SET_INPUT_POS,
    Cmd.SET_INPUT_VEL,
    Cmd.SET_INPUT_TORQUE,
    Cmd.SET_LIMITS,
    Cmd.REBOOT,
    Cmd.CLEAR_ERRORS,
)


@dataclass(frozen=True)
class Generation:
    """Differences between the two firmwares.

    Attributes:
        watchdog: error bit.
        estop: error bit.
        torques: sends torques and temperatures; the older one sends currents.
    """

    watchdog: int
    estop: int
    torques: bool


V3 = Generation(watchdog=0x800, estop=0x4000, torques=False)
V06 = Generation(watchdog=0x1000000, estop=0x2000000, torques=True)

MODELS = {"ODrive_S1": V06, "ODrive_Pro": V06, "ODrive_v3": V3}


@dataclass(frozen=True)
class OdriveAddress:
    """The block of 32 ids of a node."""

    node: int

    def id_of(self, cmd: Cmd) -> int:
        """The id of one message."""
        return self.node << 5 | cmd

    @property
    def feedback_id(self) -> int:
        """The id of its encoder estimates."""
        return self.id_of(Cmd.GET_ENCODER_ESTIMATES)


@dataclass(frozen=True)
class OdriveSpec:
    """An axis as it is asked for: "ODrive_S1:3"."""

    model: str
    node: int

    @property
    def name(self) -> str:
        """Model and node id."""
        return f"{self.model}:{self.node}"

    @property
    def address(self) -> OdriveAddress:
        """Its place on the bus."""
        return OdriveAddress(self.node)

    @classmethod
    def parse(cls, text: str) -> OdriveSpec:
        """Reads MODEL:NODE.

        Raises:
            ValueError: it is something else, or there is no such axis.
        """
        model, *rest = text.split(":")
        if model not in MODELS:
            raise ValueError(not_one_of(text, model, MODELS))
        if len(rest) != 1 or not rest[0].isdecimal():
            raise ValueError(f"{text!r}: give {model}:NODE")
        if not 0 <= int(rest[0]) <= 62:
            raise ValueError(f"{text}: ODrive nodes are 0 to 62")
        return cls(model, int(rest[0]))

    def make(self, *, initial_angle_deg: float, load_nm: float) -> FakeOdrive:
        """Returns the axis."""
        return FakeOdrive(self, initial_angle_deg=initial_angle_deg, load_nm=load_nm)


class FakeOdrive:
    """An ODrive axis with its motor, on a stiff 24 V supply, tuned by somebody who knew how.

    Its encoder counts from where it is when power comes on. It has no watchdog unless one is
    given, as it is delivered.

    Public attributes may be read and set at any time:
        speed_rad_s, turns: of the shaft.
        current_a: that flows; torque-producing.
        temperature_c: of the winding.
        load_nm: constant torque against positive rotation.
        errors: bits of its own firmware, as in the heartbeat.
        axis_state: IDLE or CLOSED_LOOP.
        motor_failed, encoder_failed, controller_failed: flags of a v3's heartbeat.

    Args:
        spec: model and node.
        initial_angle_deg: where the shaft is, whatever the encoder says.
        load_nm: see above.
        torque_constant_nm_per_a: of the motor; as delivered by the vendor for 150 rpm/V.
        watchdog_s: watchdog_timeout if enable_watchdog is set; None: it is not.
    """

    def __init__(
        self,
        spec: OdriveSpec,
        *,
        initial_angle_deg: float = 0.0,
        load_nm: float = 0.0,
        torque_constant_nm_per_a: float = 8.27 / 150,
        watchdog_s: float | None = None,
    ) -> None:
        self.spec = spec
        self.generation = MODELS[spec.model]
        self.speed_rad_s = 0.0
        self.turns = initial_angle_deg / 360.0
        self.current_a = 0.0
        self.temperature_c = AMBIENT_C
        self.load_nm = load_nm
        self.commands = 0
        self.errors = 0
        self.motor_failed = self.encoder_failed = self.controller_failed = False
        self.axis_state = IDLE
        self.control_mode = POSITION
        self.input_mode = 1
        self.input_pos = 0.0
        self.input_vel = 0.0
        self.input_torque = 0.0
        self.vel_limit = 2.0
        self.current_limit_a = 10.0
        self._kt = torque_constant_nm_per_a
        self._zero_turns = self.turns
        self._watchdog_s = watchdog_s
        self._unfed_s = 0.0
        self._since_heartbeat_s = _HEARTBEAT_S
        self._asked: list[int] = []
        self._started_s = math.inf
        self._integral_nm = 0.0
        # A rotor of about half a kilogram, alone.
        self._inertia_kg_m2 = 2e-4
        self._viscous_nms_per_rad = 2e-5
        self._coulomb_nm = 0.01

    @property
    def name(self) -> str:
        """Model and node, "ODrive_S1:3"."""
        return self.spec.name

    @property
    def command_ids(self) -> list[int]:
        """The ids that it listens to."""
        return [self.spec.address.id_of(cmd) for cmd in _HEARD]

    @property
    def velocity_rpm(self) -> float:
        """Velocity of the shaft."""
        return self.speed_rad_s * RPM_PER_RAD_S

    @property
    def angle_deg(self) -> float:
        """Multi-turn angle of the shaft."""
        return self.turns * 360.0

    @property
    def pos_estimate(self) -> float:
        """Position of its encoder, in turns."""
        return self.turns - self._zero_turns

    @property
    def command(self) -> float:
        """The input in force: N·m, turns per second or turns; 0 while it is idle."""
        if self.axis_state != CLOSED_LOOP:
            return 0.0
        inputs = {TORQUE: self.input_torque, VELOCITY: self.input_vel, POSITION: self.input_pos}
        return inputs.get(self.control_mode, 0.0)

    def disarm(self, errors: int = 0) -> None:
        """Leaves closed loop, with these errors."""
        self.errors |= errors
        self.axis_state = IDLE
        self._integral_nm = 0.0

    def decode_command(self, message: can.Message) -> bool:
        """Takes a frame.

        Returns:
            Whether it was for this axis.
        """
        if (
            message.is_extended_id
            or message.is_error_frame
            or message.arbitration_id >> 5 != self.spec.node
        ):
            return False
        if self.starting:
            return False
        self._unfed_s = 0.0
        if message.is_remote_frame:
            cmd = message.arbitration_id & 0x1F
            if cmd in _ASKED:
                self._asked.append(cmd)
            return cmd in _ASKED
        self.commands += 1
        try:
            self._obey(message.arbitration_id & 0x1F, bytes(message.data))
        except struct.error:
            return False
        return True

    def _obey(self, cmd: int, data: bytes) -> None:
        if cmd == Cmd.ESTOP:
            self.disarm(self.generation.estop)
        elif cmd == Cmd.SET_AXIS_STATE:
            self._request(_UINT.unpack_from(data)[0])
        elif cmd == Cmd.SET_CONTROLLER_MODE:
            self.control_mode, self.input_mode = _TWO_INTS.unpack_from(data)
            self.input_pos = self.pos_estimate
        elif cmd == Cmd.SET_INPUT_POS:
            self.input_pos, vel_ff, torque_ff = _POSITION.unpack_from(data)
            self.input_vel = vel_ff * 0.001
            self.input_torque = torque_ff * 0.001
        elif cmd == Cmd.SET_INPUT_VEL:
            self.input_vel, self.input_torque = _TWO_FLOATS.unpack_from(data)
        elif cmd == Cmd.SET_INPUT_TORQUE:
            (self.input_torque,) = _FLOAT.unpack_from(data)
        elif cmd == Cmd.SET_LIMITS:
            self.vel_limit, self.current_limit_a = _TWO_FLOATS.unpack_from(data)
        elif cmd == Cmd.REBOOT:
            self.restart()
        elif cmd == Cmd.CLEAR_ERRORS:
            self._clear()

    def _request(self, state: int) -> None:
        if state == CLOSED_LOOP and self.errors == 0:
            self.axis_state = CLOSED_LOOP
            self.input_pos = self.pos_estimate
        else:
            self.disarm()

    def _clear(self) -> None:
        self.errors = 0
        self.motor_failed = self.encoder_failed = self.controller_failed = False

    def restart(self) -> None:
        """As if its power had been away for a moment."""
        self.disarm()
        self._clear()
        self.control_mode = POSITION
        self.input_pos = self.input_vel = self.input_torque = 0.0
        self.vel_limit, self.current_limit_a = 2.0, 10.0
        self._zero_turns = self.turns
        self._unfed_s = self._started_s = 0.0
        self._since_heartbeat_s = _HEARTBEAT_S
        self._asked = []

    @property
    def starting(self) -> bool:
        """It was restarted, and takes no command yet."""
        return self._started_s < _BOOT_S

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        parts_s = pieces(dt_s, _MAX_STEP_S)
        self._since_heartbeat_s += dt_s
        self._started_s += dt_s
        self._unfed_s = 0.0 if self.starting else self._unfed_s + dt_s
        if self._watchdog_s is not None and self._unfed_s > self._watchdog_s:
            self.disarm(self.generation.watchdog)
        for part_s in parts_s:
            self._step(part_s)

    def _wanted_nm(self, dt_s: float) -> float:
        if self.axis_state != CLOSED_LOOP:
            return 0.0
        limit_nm = self.current_limit_a * self._kt
        if self.control_mode == TORQUE:
            return max(-limit_nm, min(limit_nm, self.input_torque))
        speed = self.input_vel
        if self.control_mode == POSITION:
            speed += 20.0 * (self.input_pos - self.pos_estimate)
        speed = max(-self.vel_limit, min(self.vel_limit, speed))
        error = speed * math.tau - self.speed_rad_s
        gain = self._inertia_kg_m2 * 100.0
        grown = self._integral_nm + gain * 25.0 * error * dt_s
        torque_nm = gain * error + grown + self.input_torque
        if abs(torque_nm) <= limit_nm:
            self._integral_nm = grown
        return max(-limit_nm, min(limit_nm, torque_nm))

    def _step(self, dt_s: float) -> None:
        # The current loop is far quicker than a step; the supply's back-EMF bounds it.
        stall_a = 200.0
        back_emf = self.speed_rad_s * self._kt / SUPPLY_V
        wanted_a = self._wanted_nm(dt_s) / self._kt
        self.current_a = max(stall_a * (-1.0 - back_emf), min(stall_a * (1.0 - back_emf), wanted_a))
        speed = self.speed_rad_s
        speed += (self._kt * self.current_a - self.load_nm) / self._inertia_kg_m2 * dt_s
        speed /= 1.0 + self._viscous_nms_per_rad / self._inertia_kg_m2 * dt_s
        friction = self._coulomb_nm / self._inertia_kg_m2 * dt_s
        speed = math.copysign(max(0.0, abs(speed) - friction), speed)
        self.speed_rad_s = speed
        self.turns += speed / math.tau * dt_s
        final_c = AMBIENT_C + 0.05 * self.current_a**2
        self.temperature_c += (final_c - self.temperature_c) * dt_s / 120.0

    def heartbeat(self) -> can.Message:
        """Returns its heartbeat."""
        flags = (0, 0, 0)
        if self.generation is V3:
            flags = (int(self.motor_failed), int(self.encoder_failed), int(self.controller_failed))
        errors, state = self.errors, self.axis_state
        if self.starting:
            errors, state = errors | (0 if self.generation is V3 else INITIALIZING), UNDEFINED
        return self._message(Cmd.HEARTBEAT, _HEARTBEAT.pack(errors, state, *flags))

    def estimates(self) -> can.Message:
        """Returns position and speed."""
        return self._pair(Cmd.GET_ENCODER_ESTIMATES, self.pos_estimate, self.speed_rad_s / math.tau)

    def frames(self) -> Iterator[can.Message]:
        """Yields what was asked for, position and speed, every 100 ms heartbeat and telemetry."""
        if self._started_s < _SILENT_S:
            return
        asked, self._asked = self._asked, []
        for cmd in asked:
            yield from self._told(cmd)
        # A float of the clock may be a hair short of the period.
        if self._since_heartbeat_s >= _HEARTBEAT_S - 1e-9:
            self._since_heartbeat_s = 0.0
            yield self.heartbeat()
            yield from self._told(Cmd.GET_BUS_VOLTAGE_CURRENT)
            if self.generation.torques:
                yield from self._told(Cmd.GET_TORQUES)
                yield from self._told(Cmd.GET_TEMPERATURE)
            else:
                yield from self._told(Cmd.GET_IQ)
        yield self.estimates()

    def _told(self, cmd: int) -> Iterator[can.Message]:
        if cmd == Cmd.HEARTBEAT:
            yield self.heartbeat()
        elif cmd == Cmd.GET_ENCODER_ESTIMATES:
            yield self.estimates()
        elif cmd == Cmd.GET_IQ:
            yield self._pair(Cmd.GET_IQ, self.current_a, self.current_a)
        elif cmd == Cmd.GET_BUS_VOLTAGE_CURRENT:
            yield self._pair(Cmd.GET_BUS_VOLTAGE_CURRENT, SUPPLY_V, 0.0)
        # The older firmware means something else by these two.
        elif cmd == Cmd.GET_TORQUES and self.generation.torques:
            torque_nm = self.current_a * self._kt
            yield self._pair(Cmd.GET_TORQUES, torque_nm, torque_nm)
        elif cmd == Cmd.GET_TEMPERATURE and self.generation.torques:
            yield self._pair(Cmd.GET_TEMPERATURE, AMBIENT_C, self.temperature_c)

    def _pair(self, cmd: Cmd, first: float, second: float) -> can.Message:
        return self._message(cmd, _TWO_FLOATS.pack(first, second))

    def _message(self, cmd: Cmd, data: bytes) -> can.Message:
        return can.Message(
            arbitration_id=self.spec.address.id_of(cmd), is_extended_id=False, data=data
        )
