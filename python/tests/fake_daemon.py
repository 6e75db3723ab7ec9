"""rc10d as a client sees it: answers requests, takes commands, publishes its state."""

from __future__ import annotations

from dataclasses import dataclass, field

from rc10.lcm_types import (
    command_t,
    event_t,
    motor_state_t,
    named_value_t,
    request_t,
    response_t,
    robot_state_t,
)
from rc10.link import LcmLink
from virtual_link import VirtualLink


@dataclass
class FakeDaemon:
    """Its behaviour is in attributes that a test sets; what it was sent is in others."""

    robot: str
    link: LcmLink
    motors: tuple[str, ...] = ("wheel", "yaw", "left-arm")
    deaf_to_requests: int = 0
    """Number of requests lost on the way here."""
    lost_answers: int = 0
    """Number of answers lost."""
    shows_estop: bool = True
    verdicts: dict[str, tuple[int, str]] = field(default_factory=dict)
    """By operation, the status and message of the answer; OK without one."""
    values: dict[str, float] = field(default_factory=dict)
    """Come with every answer."""

    commands: list[command_t] = field(default_factory=list)
    received: list[request_t] = field(default_factory=list)
    executed: list[request_t] = field(default_factory=list)
    estopped: bool = False
    active: set[str] = field(default_factory=set)
    tick: int = 0

    def __post_init__(self) -> None:
        self._answers: dict[tuple[int, int], bytes] = {}
        for kind, handler in (("command", self._on_command), ("request", self._on_request)):
            self.link.subscribe(self.channel(kind), handler, 1000)

    def channel(self, kind: str) -> str:
        return f"{self.robot}.v1.{kind}"

    def reset(self) -> None:
        """Makes it well-behaved again, so that a test's end does not depend on its middle."""
        self.deaf_to_requests = self.lost_answers = 0
        self.verdicts.clear()

    # ---- out ---------------------------------------------------------------------------------

    def state(self) -> robot_state_t:
        message = robot_state_t()
        message.utime = 1_700_000_000_000_000
        message.mono_us = round(self.link.now() * 1e6)
        message.tick = self.tick
        message.state = robot_state_t.STATE_ESTOP if self.estopped else robot_state_t.STATE_RUN
        message.realtime = True
        for name in self.motors:
            motor = motor_state_t()
            motor.name = name
            motor.status = (
                motor_state_t.STATUS_ACTIVE if name in self.active else motor_state_t.STATUS_READY
            )
            motor.velocity_rpm = 12.5
            motor.voltage_v = float("nan")
            motor.feedback_age_us = -1
            message.motors.append(motor)
        message.motor_count = len(message.motors)
        return message

    def publish_state(self) -> None:
        self.tick += 1
        self.link.publish(self.channel("state"), self.state().encode())

    def publish_states(self, hz: float = 200.0) -> None:
        """From now on; only on a virtual link."""
        assert isinstance(self.link, VirtualLink)
        self.publish_state()
        self.link.after(1.0 / hz, lambda: self.publish_states(hz))

    def publish_event(self, text: str, code: int = 42, client: str = "", mono_us: int = 0) -> None:
        message = event_t()
        message.severity = event_t.SEVERITY_WARNING
        message.code = code
        message.source = "wheel"
        message.client = client
        message.mono_us = mono_us
        message.text = text
        self.link.publish(self.channel("event"), message.encode())

    # ---- in ----------------------------------------------------------------------------------

    def _on_command(self, data: bytes) -> None:
        self.commands.append(command_t.decode(data))

    def _on_request(self, data: bytes) -> None:
        if self.deaf_to_requests > 0:
            self.deaf_to_requests -= 1
            return
        request = request_t.decode(data)
        self.received.append(request)
        key = (request.session, request.seq)
        if key not in self._answers:
            self.executed.append(request)
            self._answers[key] = self._execute(request).encode()
        if self.lost_answers > 0:
            self.lost_answers -= 1
            return
        self.link.publish(self.channel("response"), self._answers[key])

    def _execute(self, request: request_t) -> response_t:
        status, text = self.verdicts.get(request.operation, (response_t.STATUS_OK, ""))
        names = set(request.target.split(",") if request.target else self.motors)
        if status == response_t.STATUS_OK:
            if request.operation == "estop":
                self.estopped = self.shows_estop
            elif request.operation == "enable":
                self.active |= names
            elif request.operation == "disable":
                self.active -= names
        answer = response_t()
        answer.client = request.client
        answer.session = request.session
        answer.seq = request.seq
        answer.status = status
        answer.message = text
        for name, number in self.values.items():
            value = named_value_t()
            value.name = name
            value.value = number
            answer.values.append(value)
        answer.value_count = len(answer.values)
        return answer

    # ---- for assertions ----------------------------------------------------------------------

    def operations(self) -> list[str]:
        return [f"{r.operation} {r.target}".strip() for r in self.executed]


def setpoints(command: command_t) -> dict[str, tuple[int, float]]:
    """Returns mode and value by motor."""
    return {s.motor: (s.mode, s.value) for s in command.setpoints}
