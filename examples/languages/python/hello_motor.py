"""Enables one motor, turns it for a second and prints its state; Ctrl-C lets go of it.

Python, with nothing but LCM.

    hello_motor.py ROBOT MOTOR RPM

Robot programs in Python are shorter with the package rc10 (docs/python.md), whose name the
generated types have too: here they come first on PYTHONPATH.
"""

import math
import secrets
import select
import signal
import sys
import time

import lcm

from rc10 import (
    command_t,
    event_t,
    motor_state_t,
    named_value_t,
    request_t,
    response_t,
    robot_state_t,
    setpoint_t,
)

CLIENT = "hello-python"
MOTOR_STATUS = 100  # code of the events "ACTIVE -> READY (…)"
PAUSE_US = 100_000  # between two commands: Ctrl-Z, a busy computer
PATIENCE_US = 1_000_000  # for a state of after it


class Program:
    """The known state of one motor."""

    def __init__(self, robot: str, motor: str) -> None:
        self.lcm = lcm.LCM()
        self.robot = robot
        self.motor = motor
        self.session = secrets.randbelow(2**62)  # of this run; a later run has another
        self.seq = 0  # grows with every message of ours
        self.answer = None
        self.state = motor_state_t()
        self.state_us = 0
        self.enabled = False  # by us
        self.printed_us = 0
        self.commanded_us = 0
        self.stopped = ""  # by whom or by what
        self.interrupted = False
        self.lcm.subscribe(f"{robot}.v1.state", self.on_state)
        self.lcm.subscribe(f"{robot}.v1.event", self.on_event)
        self.lcm.subscribe(f"{robot}.v1.response", self.on_response)

    def on_interrupt(self, number: int, _: object) -> None:
        """Remembers it."""
        self.interrupted = True
        signal.signal(number, signal.SIG_DFL)

    def receive(self, timeout_s: float) -> bool:
        """Waits for a message; not in LCM, to which a signal meanwhile is an error."""
        came = bool(select.select([self.lcm.fileno()], [], [], timeout_s)[0])
        if came:
            self.lcm.handle()
        return came

    def on_state(self, _: str, data: bytes) -> None:
        """Keeps the motor, and prints it ten times a second."""
        state = robot_state_t.decode(data)
        self.state_us = state.mono_us
        for motor in state.motors:
            if motor.name != self.motor:
                continue
            self.state = motor
            if state.mono_us >= self.printed_us + 100_000:
                self.printed_us = state.mono_us
                print(
                    f"{motor.name} status {motor.status} owner '{motor.owner}' target "
                    f"{motor.target:.1f} measured {motor.velocity_rpm:.1f} rpm "
                    f"{motor.current_a:.2f} A",
                    flush=True,
                )

    def on_event(self, _: str, data: bytes) -> None:
        """Keeps that the motor was stopped: enabled by somebody, it is not driven on."""
        event = event_t.decode(data)
        of_motor = event.code == MOTOR_STATUS and event.source == self.motor
        if self.enabled and of_motor and event.text.startswith("ACTIVE -> "):
            self.stopped = event.text

    def on_response(self, _: str, data: bytes) -> None:
        """Keeps the answer to our request; all clients hear all answers."""
        response = response_t.decode(data)
        if (response.session, response.seq) == (self.session, self.seq):
            self.answer = response

    def request(self, operation: str, values: dict[str, float] | None = None) -> bool:
        """Sends a request under one number until it is answered: it is carried out once."""
        message = request_t()
        message.client, message.session = CLIENT, self.session
        self.seq += 1
        message.seq = self.seq
        message.operation, message.target = operation, self.motor
        for name, number in (values or {}).items():
            value = named_value_t()
            value.name, value.value = name, number
            message.values.append(value)
        message.value_count = len(message.values)
        self.answer = None
        for _ in range(50):
            self.lcm.publish(f"{self.robot}.v1.request", message.encode())
            end_s = time.monotonic() + 0.1
            while self.answer is None and time.monotonic() < end_s:
                self.receive(0.01)
            if self.answer is not None:
                if self.answer.status != response_t.STATUS_OK:
                    print(f"hello_motor: {self.answer.message}", file=sys.stderr)
                return self.answer.status == response_t.STATUS_OK
        print(f"hello_motor: no answer to '{operation}': is rc10d running?", file=sys.stderr)
        return False

    def may_go_on(self) -> bool:
        """Whether the motor may have its next target: it was not stopped, nor in a pause of ours.

        Events of a pause may be lost. A state of after it shows what has become of the target.
        """
        resumed_us = now_us = time.monotonic_ns() // 1000
        while self.receive(0.0):
            pass  # all that waits
        if self.commanded_us and now_us > self.commanded_us + PAUSE_US:
            while self.state_us < resumed_us and now_us < resumed_us + PATIENCE_US:
                self.receive(0.01)
                now_us = time.monotonic_ns() // 1000
            lapsed = self.state.owner == "" and self.state.stop_cause == motor_state_t.STOP_TIMEOUT
            if self.state_us < resumed_us or not (lapsed or self.state.owner == CLIENT):
                self.stopped = self.stopped or "in a pause of this program"
        return not self.stopped

    def command(self, mode: int, value: float) -> None:
        """Sends one setpoint, which acts for 100 ms."""
        setpoint = setpoint_t()
        setpoint.motor, setpoint.mode, setpoint.value = self.motor, mode, value
        setpoint.stiffness_nm_per_rad = setpoint.damping_nms_per_rad = math.nan
        message = command_t()
        message.client, message.session = CLIENT, self.session
        self.seq += 1
        message.seq = self.seq
        message.validity_ms = 100
        message.setpoint_count, message.setpoints = 1, [setpoint]
        self.lcm.publish(f"{self.robot}.v1.command", message.encode())
        self.commanded_us = time.monotonic_ns() // 1000


def main() -> int:
    """Runs the program."""
    robot, motor, rpm = sys.argv[1], sys.argv[2], float(sys.argv[3])  # before anything is enabled
    program = Program(robot, motor)
    # Ctrl-C ends the loop below, and the motor is disabled as ever; a second one ends at once. Not
    # by KeyboardInterrupt, which LCM cannot bear while it calls on_state().
    signal.signal(signal.SIGINT, program.on_interrupt)
    signal.signal(signal.SIGTERM, program.on_interrupt)
    disabled = False
    program.enabled = program.request("enable")
    try:
        for _ in range(50 if program.enabled else 0):
            if program.interrupted or not program.may_go_on():
                break
            program.command(setpoint_t.MODE_VELOCITY, rpm)
            end_s = time.monotonic() + 0.02
            while time.monotonic() < end_s:
                program.receive(0.005)
    finally:
        if program.may_go_on():
            program.command(setpoint_t.MODE_COAST, 0.0)
            # With our end: what an e-stop holds meanwhile stays held.
            disabled = program.request("disable", {"at_end": 1.0})
        else:  # and, if it is enabled again, in the hands of another
            print(f"hello_motor: {motor} was stopped: {program.stopped}", file=sys.stderr)
    if program.interrupted:
        return 130
    return 0 if program.enabled and disabled else 1


if __name__ == "__main__":
    sys.exit(main())
