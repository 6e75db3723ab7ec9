"""Runs fake motors on a python-can bus in real time."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Callable

from rc10.fakes.port import open_port

if TYPE_CHECKING:
    import can

    from rc10.fakes.drives import Drives

MAX_RATE_HZ = 10_000

# A flooded bus must not keep the motors from moving.
_MAX_FRAMES_PER_TICK = 256


class Runner:
    """Moves frames between a bus and its fake motors, and lets their time pass.

    Every tick is on an absolute grid of the monotonic clock. Ticks that come too late are
    skipped and counted, their feedback is not sent, and the physics makes up for the time.
    Between ticks it sleeps; it never waits in a loop.

    Attributes:
        late_ticks: ticks that were skipped.
        lost_frames: feedback frames that the interface did not take.

    Args:
        bus: where the motors are.
        drives: the motors.
        rate_hz: feedback frames of each motor in a second.
        now_ns: a monotonic clock.
        sleep: sleeps for seconds.
    """

    def __init__(
        self,
        bus: can.BusABC,
        drives: Drives,
        rate_hz: float = 1000.0,
        *,
        now_ns: Callable[[], int] = time.monotonic_ns,
        sleep: Callable[[float], None] = time.sleep,
    ) -> None:
        if not 0 < rate_hz <= MAX_RATE_HZ:
            raise ValueError(f"rate_hz = {rate_hz} is not within 0 to {MAX_RATE_HZ}")
        self.late_ticks = 0
        self.lost_frames = 0
        self._port = open_port(bus)
        self._drives = drives
        self._period_ns = round(1e9 / rate_hz)
        self._now_ns = now_ns
        self._sleep = sleep
        # Leaves other traffic, such as the feedback of real motors, to the kernel.
        bus.set_filters(drives.filters)

    def run(self, stop: Callable[[], bool], duration_s: float | None = None) -> None:
        """Runs until `stop` says so or the time is over.

        Raises:
            can.CanError: the interface is gone.
        """
        start_ns = self._now_ns()
        end = None if duration_s is None else round(duration_s * 1e9) // self._period_ns
        tick = 0
        while not stop() and (end is None or tick < end):
            due_ns = start_ns + (tick + 1) * self._period_ns
            delay_ns = due_ns - self._now_ns()
            if delay_ns > 0:
                self._sleep(delay_ns * 1e-9)
            passed = max(1, (self._now_ns() - start_ns) // self._period_ns - tick)
            self.late_ticks += passed - 1
            tick += passed
            self._tick(passed * self._period_ns * 1e-9)

    def _tick(self, dt_s: float) -> None:
        # In the order of a real drive: a command acts from when it arrives, here until the next
        # tick, and the feedback shows what came of it.
        self._receive()
        self._drives.step(dt_s)
        for message in self._drives.feedback():
            if not self._port.send(message):
                self.lost_frames += 1

    def _receive(self) -> None:
        for _ in range(_MAX_FRAMES_PER_TICK):
            message = self._port.receive()
            if message is None:
                return
            self._drives.receive(message)
