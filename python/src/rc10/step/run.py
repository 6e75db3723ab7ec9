"""Runs a step on a live robot, safely, and records it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rc10.errors import MotorStopped, Rc10Error
from rc10.orders import Order, hindered, obstacle, of_another
from rc10.setpoints import Mode, Setpoint
from rc10.state import Limit, MotorState, MotorStatus, RobotState
from rc10.step.analysis import StepMetrics, analyse
from rc10.watch import Watch

if TYPE_CHECKING:
    from rc10.client import Robot
    from rc10.recording import Recording
    from rc10.step.plan import StepPlan

# Period and validity of the target: a machine that pauses must not end a step.
_COMMAND_HZ = 100.0
_VALIDITY_MS = 150
# For the first target on its way; after that a state has to show it.
_ON_ITS_WAY_S = 0.5
# Time limit and tolerance of the way back to where it was.
_RETURN_S = 2.0
_RETURNED = 0.05

_ON_ANGLES = (Mode.ANGLE, Mode.TOTAL_ANGLE)

# A flag of these says that the target itself was not accepted as it is.
_CLIPPED = {
    Mode.VELOCITY: (Limit.VELOCITY, "velocity_limit_rpm"),
    Mode.CURRENT: (Limit.CURRENT, "current_limit_a"),
}


class StepFailed(Rc10Error):
    """The step was not run, or was ended; nothing is sent to the motor any more."""


@dataclass(frozen=True)
class StepResult:
    """A step that was run."""

    plan: StepPlan
    recording: Recording
    """Recording of this motor; time 0 is the step."""
    signal: str
    """The name of what followed the target."""
    metrics: StepMetrics
    limits: dict[str, float]
    """The limits that acted, and in which part of the time after the step."""
    missing: float
    """In which part of the time after the step the target was not in force: it had expired."""


def run_step(robot: Robot, plan: StepPlan) -> StepResult:
    """Runs a step and comes back to the target from before.

    That lapses, or ends with the caller's `with rc10.connect(...)`, also after an exception or
    Ctrl-C. By the default `at_end="timeout"` the motor then does its `on_timeout` and stays ACTIVE,
    also one that the plan has enabled; `at_end="disable"` disables it.

    A motor that was stopped, in the step or on the way back, is sent nothing more, whoever enables
    it.

    Raises:
        StepFailed: refused, or the motor stopped obeying; in words.
        RequestFailed, RequestRefused: it could not be enabled.
        Timeout: it could not be enabled, or no state has come for a second.
        UnknownMotor: there is no such motor.
    """
    motor = _prepare(robot, plan)
    watch = Watch(robot, plan.motor, on_angle=plan.mode in _ON_ANGLES)
    start, base, target = _values(plan, motor)
    before = Order(plan.motor, Setpoint(plan.mode, base), robot.client)
    after = Order(plan.motor, Setpoint(plan.mode, target), robot.client)
    with robot.recorder([plan.motor]) as recorder:
        _hold(robot, watch, before, plan.before_s)
        if plan.mode not in _ON_ANGLES:
            start = base
        _hold(robot, watch, after, plan.seconds)
    _return(robot, watch, before)

    recording = recorder.recording()
    seen = recording.motor(plan.motor)
    # The first state with the target: the loop above sees the newest one only.
    acting = (seen.target == target) & (seen.mode == plan.mode)
    recording = recording.with_zero_at(float(recording.time_s[acting.argmax()]))
    signal = "total_angle_deg" if plan.mode in _ON_ANGLES else _measured(plan.mode)
    reached = start + _way(plan, base, target) if plan.mode in _ON_ANGLES else target
    try:
        metrics = analyse(
            recording.time_s,
            recording.motor(plan.motor).signal(signal),
            start,
            reached,
            plan.tolerance,
        )
    except ValueError as error:
        raise StepFailed(f"{plan.motor}: {error}") from None
    without = recording.motor(plan.motor).mode[recording.time_s >= 0] != plan.mode
    return StepResult(
        plan,
        recording,
        signal,
        metrics,
        _limits(recording, plan.motor),
        float(without.mean()),
    )


def _measured(mode: Mode) -> str:
    return {Mode.VELOCITY: "velocity_rpm", Mode.CURRENT: "current_a"}[mode]


def _prepare(robot: Robot, plan: StepPlan) -> MotorState:
    state = robot.wait_for_state()
    motor = state.motor(plan.motor)
    if taken := of_another(motor, robot.client):
        raise StepFailed(taken)
    if plan.enable and motor.status is MotorStatus.READY and not state.estopped:
        robot.enable(plan.motor)
        state = _state_after(robot)
    motor = state.motor(plan.motor)
    if hindrance := (hindered if plan.mode in _ON_ANGLES else obstacle)(state, motor):
        ready = motor.status is MotorStatus.READY and not state.estopped
        raise StepFailed(hindrance + (" (--enable does it)" if ready else ""))
    return motor


def _state_after(robot: Robot) -> RobotState:
    """A state that was taken after now: one on its way still shows what was before."""
    now_s = robot.link.now()
    while (state := robot.wait_for_state()).taken_at_s < now_s:
        pass
    return state


def _values(plan: StepPlan, motor: MotorState) -> tuple[float, float, float]:
    """Returns the multi-turn angle now, the target before the step, and that of the step."""
    if plan.mode not in _ON_ANGLES:
        if plan.relative:
            raise StepFailed("a relative step is one of an angle")
        if plan.value == plan.base:
            raise StepFailed(f"from {plan.base:g} to {plan.value:g} is no step")
        return plan.base, plan.base, plan.value
    base = motor.angle_deg if plan.mode is Mode.ANGLE else motor.total_angle_deg
    if not math.isfinite(base):
        raise StepFailed(f"{plan.motor}: the drive reports no angle")
    target = base + plan.value if plan.relative else plan.value
    if abs(_way(plan, base, target)) < 0.1:
        raise StepFailed(f"{plan.motor} stands at {base:.1f} deg already: that is no step")
    return motor.total_angle_deg, base, target


def _way(plan: StepPlan, base: float, target: float) -> float:
    if plan.mode is Mode.ANGLE:
        return (target - base + 180.0) % 360.0 - 180.0
    return target - base


def _hold(robot: Robot, watch: Watch, order: Order, seconds: float) -> None:
    """Sends a target until it has acted for so long."""
    began_us: int | None = None
    sent_s = robot.link.now()
    first_us: int | None = None
    for _ in robot.rate(_COMMAND_HZ):
        if not _may_send(watch, order):
            continue
        robot.command({order.motor: order.setpoint}, validity_ms=_VALIDITY_MS)
        state = robot.state
        motor = state.motor(order.motor)
        if state.taken_at_s < sent_s:
            continue
        first_us = first_us or state.mono_us
        if began_us is None:
            refused = order.not_obeyed(motor)
            if not refused:
                began_us = state.mono_us
            elif state.mono_us - first_us > _ON_ITS_WAY_S * 1e6:
                raise StepFailed(refused)
            continue
        _check_limits(order, motor)
        if state.mono_us - began_us >= seconds * 1e6:
            break


def _may_send(watch: Watch, order: Order) -> bool:
    try:
        may = watch.may_send()
    except MotorStopped as error:
        raise StepFailed(str(error)) from None
    for event in watch.events:
        order.on_event(event)
    return may


def _check_limits(order: Order, motor: MotorState) -> None:
    mode, value = order.setpoint.mode, order.setpoint.value
    flag, key = _CLIPPED.get(mode, (Limit(0), ""))
    if motor.limits & flag:
        raise StepFailed(
            f"{order.motor}: rc10d limits the target {value:g} {mode.unit}: it is beyond {key}; "
            "take a smaller step"
        )
    if motor.limits & Limit.ANGLE:
        raise StepFailed(
            f"{order.motor}: a soft limit of the angle acts (angle_min_deg, angle_max_deg); "
            "take a smaller step, or begin elsewhere"
        )


def _return(robot: Robot, watch: Watch, order: Order) -> None:
    """Goes back to the target from before, for some time at most; then that lapses."""
    step_at = robot.state.motor(order.motor)
    far = max(abs(_distance(order.setpoint, step_at)), 1e-6)
    for t_s in robot.rate(_COMMAND_HZ):
        if not _may_send(watch, order):
            continue
        near = abs(_distance(order.setpoint, robot.state.motor(order.motor))) < _RETURNED * far
        if near or t_s > _RETURN_S:
            break
        robot.command({order.motor: order.setpoint}, validity_ms=_VALIDITY_MS)


def _distance(setpoint: Setpoint, motor: MotorState) -> float:
    if setpoint.mode is Mode.ANGLE:
        return (setpoint.value - motor.angle_deg + 180.0) % 360.0 - 180.0
    if setpoint.mode is Mode.TOTAL_ANGLE:
        return setpoint.value - motor.total_angle_deg
    if setpoint.mode is Mode.CURRENT:
        return setpoint.value - motor.current_a
    return setpoint.value - motor.velocity_rpm


def _limits(recording: Recording, name: str) -> dict[str, float]:
    flags = recording.motor(name).limits[recording.time_s >= 0].astype(int)
    shares = {str(limit.name).lower(): float((flags & limit.value > 0).mean()) for limit in Limit}
    return {limit: share for limit, share in shares.items() if share > 0}
