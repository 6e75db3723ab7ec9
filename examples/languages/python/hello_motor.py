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

from rc10 import command_t, named_value_t, request_t, response_t, robot_state_t, setpoint_t

CLIENT = "hello-python"


class Program:
    """The known state of one motor."""

    def __init__(self, robot: str, motor: str) -> None:
        self.lcm = lcm.LCM()
        self.robot = robot
        self.motor = motor
        self.session = secrets.randbelow(2**62)  # of this run; a later run has another
        self.seq = 0  # grows with every message of ours
        self.answer = None
        self.printed_us = 0
        self.interrupted = False
        self.lcm.subscribe(f"{robot}.v1.state", self.on_state)
        self.lcm.subscribe(f"{robot}.v1.response", self.on_response)

    def on_interrupt(self, number: int, _: object) -> None:
        """Remembers it."""
        self.interrupted = True
        signal.signal(number, signal.SIG_DFL)

    def receive(self, timeout_s: float) -> None:
        """Waits for a message; not in LCM, to which a signal meanwhile is an error."""
        if select.select([self.lcm.fileno()], [], [], timeout_s)[0]:
            self.lcm.handle()

    def on_state(self, _: str, data: bytes) -> None:
        """Prints the motor ten times a second."""
        state = robot_state_t.decode(data)
        if state.mono_us < self.printed_us + 100_000:
            return
        for motor in state.motors:
            if motor.name == self.motor:
                self.printed_us = state.mono_us
                print(
                    f"{motor.name} status {motor.status} owner '{motor.owner}' target "
                    f"{motor.target:.1f} measured {motor.velocity_rpm:.1f} rpm "
                    f"{motor.current_a:.2f} A",
                    flush=True,
                )

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


def main() -> int:
    """Runs the program."""
    robot, motor, rpm = sys.argv[1], sys.argv[2], float(sys.argv[3])  # before anything is enabled
    program = Program(robot, motor)
    # Ctrl-C ends the loop below, and the motor is disabled as ever; a second one ends at once. Not
    # by KeyboardInterrupt, which LCM cannot bear while it calls on_state().
    signal.signal(signal.SIGINT, program.on_interrupt)
    signal.signal(signal.SIGTERM, program.on_interrupt)
    disabled = False
    enabled = program.request("enable")
    try:
        for _ in range(50 if enabled else 0):
            if program.interrupted:
                break
            program.command(setpoint_t.MODE_VELOCITY, rpm)
            end_s = time.monotonic() + 0.02
            while time.monotonic() < end_s:
                program.receive(0.005)
    finally:
        program.command(setpoint_t.MODE_COAST, 0.0)
        # With our end: what an e-stop holds meanwhile stays held.
        disabled = program.request("disable", {"at_end": 1.0})
    if program.interrupted:
        return 130
    return 0 if enabled and disabled else 1


if __name__ == "__main__":
    sys.exit(main())
