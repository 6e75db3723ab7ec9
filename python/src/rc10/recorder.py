"""Collects every state of a robot while a program receives."""

from __future__ import annotations

from array import array
from typing import TYPE_CHECKING

from rc10.errors import NotReceived
from rc10.signals import SIGNALS, value_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rc10.inbox import Inbox
    from rc10.recording import Recording
    from rc10.state import RobotState

# Times of every sample.
TIMES = ("mono_us", "utime", "tick")


class Recorder:
    """Collects states in a `with` statement, and makes a Recording of them.

        with robot.recorder() as recorder:
            for t_s in robot.rate(100):
                ...
        recording = recorder.recording()

    It takes states while the program receives, each of them: LCM queues about half a second of
    them, so receive at least twice a second.

    Args:
        robot: the name of the robot.
        inbox: gives the states.
        motors: names of the motors to record; None for all.
    """

    def __init__(self, robot: str, inbox: Inbox, motors: Iterable[str] | None) -> None:
        self.robot = robot
        self.count = 0
        """States collected."""
        self._inbox = inbox
        self._wanted = None if motors is None else tuple(motors)
        self._motors: tuple[str, ...] = ()
        # Flat, row after row: a minute of states as objects would be tens of megabytes.
        self._times = array("q")
        self._values = array("d")
        self._missing = array("d", [float("nan")] * len(SIGNALS))

    def __enter__(self) -> Recorder:
        if self._wanted is not None and self._inbox.state is not None:
            for name in self._wanted:
                self._inbox.state.motor(name)
        self._inbox.on_state.append(self.add)
        return self

    def __exit__(self, *_: object) -> None:
        self._inbox.on_state.remove(self.add)

    def add(self, state: RobotState) -> None:
        """Takes in a state."""
        if not self.count:
            self._motors = tuple(state.motors) if self._wanted is None else self._wanted
            for name in self._motors:
                state.motor(name)  # or UnknownMotor
        self._times.extend((state.mono_us, state.utime, state.tick))
        for name in self._motors:
            motor = state.motors.get(name)
            if motor is None:  # the daemon was restarted with another configuration
                self._values.extend(self._missing)
            else:
                self._values.extend(value_of(motor, signal) for signal in SIGNALS)
        self.count += 1

    def recording(self) -> Recording:
        """Returns what was collected so far, as NumPy arrays.

        Raises:
            MissingPackage: NumPy is not installed.
            NotReceived: no state was collected.
        """
        from rc10.recording import Recording

        if not self.count:
            raise NotReceived("nothing was recorded: no state came while recording")
        return Recording.from_samples(self.robot, self._motors, self._times, self._values)
