"""State of a robot and its motors, `<robot>.v1.state`."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from functools import cache
from types import MappingProxyType
from typing import TYPE_CHECKING, Callable

from rc10.errors import UnknownMotor
from rc10.lcm_types.motor_state_t import motor_state_t
from rc10.lcm_types.robot_state_t import robot_state_t
from rc10.printable import printable
from rc10.setpoints import Mode
from rc10.spelling import did_you_mean
from rc10.words import Word, WordSet

if TYPE_CHECKING:
    from collections.abc import Mapping


class RobotStatus(Word):
    """State of the whole robot."""

    RUN = robot_state_t.STATE_RUN
    ESTOP = robot_state_t.STATE_ESTOP
    """Latched until cleared."""
    STOPPING = robot_state_t.STATE_STOPPING


class MotorStatus(Word):
    """State of one motor."""

    OFFLINE = motor_state_t.STATUS_OFFLINE
    """No fresh feedback."""
    READY = motor_state_t.STATUS_READY
    """Feedback, waits to be enabled; `acting` says whether it holds, damps or brakes meanwhile."""
    ENABLING = motor_state_t.STATUS_ENABLING
    ACTIVE = motor_state_t.STATUS_ACTIVE
    """Obeys setpoints."""
    FAULT = motor_state_t.STATUS_FAULT
    """Latched until cleared."""


class Limit(WordSet):
    """Limits that act right now; they are not faults."""

    CURRENT = motor_state_t.LIMIT_CURRENT
    VELOCITY = motor_state_t.LIMIT_VELOCITY
    ANGLE = motor_state_t.LIMIT_ANGLE
    TEMPERATURE = motor_state_t.LIMIT_TEMPERATURE
    SLEW = motor_state_t.LIMIT_SLEW
    STALL = motor_state_t.LIMIT_STALL


class CommandUnit(Word):
    """Unit of MotorState.command_value."""

    NONE = motor_state_t.UNIT_NONE
    AMPERE = motor_state_t.UNIT_AMPERE
    VOLT = motor_state_t.UNIT_VOLT
    NATIVE = motor_state_t.UNIT_NATIVE
    """The drive closes the loop: the unit of the mode."""


class Acting(Word):
    """Source of the torque that a shaft feels."""

    NOTHING = motor_state_t.ACTING_NOTHING
    TARGET = motor_state_t.ACTING_TARGET
    HOLD = motor_state_t.ACTING_HOLD
    """The place where it stopped, with torque."""
    DAMP = motor_state_t.ACTING_DAMP
    BRAKE = motor_state_t.ACTING_BRAKE
    RAMP = motor_state_t.ACTING_RAMP
    """A velocity that falls to 0, then no torque."""
    UNKNOWN = -1
    """Something that this version of the client does not know."""

    @classmethod
    def _missing_(cls, _value: object) -> Acting:
        return cls.UNKNOWN


class StopCause(Word):
    """Reason why a motor does not obey, or the robot does not run."""

    NONE = motor_state_t.STOP_NONE
    REQUEST = motor_state_t.STOP_REQUEST
    """Asked for by stopped_by."""
    ESTOP = motor_state_t.STOP_ESTOP
    FAULT = motor_state_t.STOP_FAULT
    SILENCE = motor_state_t.STOP_SILENCE
    """Its drive was not heard."""
    GROUP = motor_state_t.STOP_GROUP
    """Its group stopped, for the motor stopped_by."""
    TIMEOUT = motor_state_t.STOP_TIMEOUT
    """The command in force was not renewed: ACTIVE, with on_timeout acting."""
    REFUSED = motor_state_t.STOP_REFUSED
    """Its drive did not confirm that it was enabled."""
    REFERENCE = motor_state_t.STOP_REFERENCE
    """Its angle has lost the reference: ACTIVE, with on_timeout acting."""
    SHUTDOWN = motor_state_t.STOP_SHUTDOWN
    INPUT = motor_state_t.STOP_INPUT
    """The e-stop input."""
    GUARD = motor_state_t.STOP_GUARD
    """rc10-guard told the drives to rest, has ended, or stands still."""
    OVERLOAD = motor_state_t.STOP_OVERLOAD
    """The ticks used nearly all of their periods."""
    UNKNOWN = -1
    """A cause that this version of the client does not know."""

    @classmethod
    def _missing_(cls, _value: object) -> StopCause:
        return cls.UNKNOWN


class Condition(WordSet):
    """Conditions of the whole robot."""

    SIMULATED = robot_state_t.CONDITION_SIMULATED
    """Some bus of it has simulated drives."""
    INPUT_OPEN = robot_state_t.CONDITION_INPUT_OPEN
    """The e-stop input is open, or cannot be read."""
    REDUCED = robot_state_t.CONDITION_REDUCED
    """The mode input is open, or cannot be read: speed and current are reduced."""
    TUNING_LOCKED = robot_state_t.CONDITION_TUNING_LOCKED
    """`tuning: locked`: nobody changes gains or the settings of drives."""


_ENUMERATIONS: Mapping[str, Callable[[int], Word | WordSet]] = {
    "status": MotorStatus,
    "limits": Limit,
    "mode": Mode,
    "command_unit": CommandUnit,
    "acting": Acting,
    "stop_cause": StopCause,
}


@dataclass(frozen=True)
class MotorState:
    """One motor, at the output shaft, counter-clockwise positive.

    NaN stands for a quantity that this drive does not report.
    """

    name: str
    status: MotorStatus
    fault: int
    """0, or the code of the latched fault."""
    fault_text: str
    limits: Limit
    mode: Mode
    """The mode in force; COAST when there is no valid target."""
    target: float
    """As it was asked for, in the unit of the mode."""
    target_shaped: float
    """As limits and slew let it act; NaN unless it acts."""
    acting: Acting
    """Source of what the shaft feels."""
    stop_cause: StopCause
    """Reason why it stopped obeying; NONE while it obeys."""
    stopped_by: str
    """The client, module or motor that stopped it, where there is one."""
    owner: str
    """The client whose target is in force, empty without one."""
    zeroed: bool
    """The angle has a known reference."""
    angle_deg: float
    """From 0 to below 360."""
    total_angle_deg: float
    """Multi-turn."""
    velocity_rpm: float
    current_a: float
    torque_nm: float
    voltage_v: float
    temperature_c: float
    command_value: float
    """Last value sent to the drive, in command_unit."""
    command_unit: CommandUnit
    feedback_age_us: int
    """Since the last feedback frame; -1: none yet."""
    feedback_age_at_use_us: int
    """Age of the feedback that the tick's frames were computed from, when they left."""
    command_age_us: int
    """Since the host received the command in force; -1: none is."""
    feedback_hz: float

    def __str__(self) -> str:
        """Returns it in a line: `wheel ACTIVE VELOCITY 60 rpm: 59.8 rpm, 151.2 deg, 0.45 A`."""
        unit = self.mode.unit
        target = f" {self.target:g}{' ' + unit if unit else ''}" if self.owner else ""
        why = self.fault_text or ("" if self.stop_cause is StopCause.NONE else str(self.stop_cause))
        measured = (
            f"{number:.{places}f} {of}"
            for number, places, of in (
                (self.velocity_rpm, 1, "rpm"),
                (self.total_angle_deg, 1, "deg"),
                (self.current_a, 2, "A"),
            )
            if not math.isnan(number)
        )
        plain = self.acting in (Acting.NOTHING, Acting.TARGET)
        does = f"{self.mode}{target}" if plain else str(self.acting)
        line = f"{self.name} {self.status} {does}: {', '.join(measured)}"
        return printable(f"{line} ({why})" if why else line)

    # Each field has the name that it has in motor_state_t.
    @classmethod
    def from_lcm(cls, message: motor_state_t) -> MotorState:
        """Makes the typed view of a decoded message."""
        values = {name: getattr(message, name) for name in _names()}
        for name, kind in _ENUMERATIONS.items():
            values[name] = kind(values[name])
        return cls(**values)


@cache
def _names() -> tuple[str, ...]:
    return tuple(part.name for part in fields(MotorState))


@dataclass(frozen=True)
class RobotState:
    """All motors at one tick of the daemon."""

    utime: int
    """Wall clock of the host in microseconds since 1970; may step."""
    mono_us: int
    """CLOCK_MONOTONIC of the host at this tick, in microseconds."""
    tick: int
    """Ticks since start."""
    status: RobotStatus
    realtime: bool
    """The real-time set-up is complete; if not, Diagnostics.notices says why."""
    stop_cause: StopCause
    """Reason why it is not in RUN."""
    stopped_by: str
    """The client or module that asked for that, where there is one."""
    stopped_mono_us: int
    """When it left RUN, as mono_us; 0 in RUN."""
    estop_count: int
    """E-stops since start."""
    conditions: Condition
    version: str
    """Version of rc10d."""
    config_hash: str
    """SHA-256 of the configuration file as rc10d read it, as sha256sum prints it."""
    motors: Mapping[str, MotorState]
    taken_at_s: float = field(compare=False)
    """When the daemon took this state, on this program's clock."""
    _now: Callable[[], float] = field(repr=False, compare=False)

    def __str__(self) -> str:
        """Returns the robot's status in a line, and each motor in one of its own."""
        why = "" if self.stop_cause is StopCause.NONE else f" {self.stop_cause} {self.stopped_by}"
        head = printable(f"{self.status}{why}".rstrip() + f", tick {self.tick}")
        return "\n".join([head, *(f"  {motor}" for motor in self.motors.values())])

    @property
    def age_s(self) -> float:
        """Seconds since the daemon took this state."""
        return self._now() - self.taken_at_s

    @property
    def simulated(self) -> bool:
        """Whether some bus of the robot has simulated drives."""
        return Condition.SIMULATED in self.conditions

    @property
    def estopped(self) -> bool:
        """Whether the latched emergency stop is in force."""
        return self.status is RobotStatus.ESTOP

    def motor(self, name: str) -> MotorState:
        """Returns the motor `name`.

        Raises:
            UnknownMotor: the robot has none of this name.
        """
        try:
            return self.motors[name]
        except KeyError:
            raise UnknownMotor(
                f"the robot has no motor '{name}'; it has: {', '.join(self.motors) or 'none'}"
                f"{did_you_mean(name, self.motors)}"
            ) from None

    @classmethod
    def from_lcm(
        cls, message: robot_state_t, taken_at_s: float, now: Callable[[], float]
    ) -> RobotState:
        """Makes the typed view of a decoded message."""
        return cls(
            utime=message.utime,
            mono_us=message.mono_us,
            tick=message.tick,
            status=RobotStatus(message.state),
            realtime=message.realtime,
            stop_cause=StopCause(message.stop_cause),
            stopped_by=message.stopped_by,
            stopped_mono_us=message.stopped_mono_us,
            estop_count=message.estop_count,
            conditions=Condition(message.conditions),
            version=message.version,
            config_hash=message.config_hash,
            motors=MappingProxyType({m.name: MotorState.from_lcm(m) for m in message.motors}),
            taken_at_s=taken_at_s,
            _now=now,
        )
