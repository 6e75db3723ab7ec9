"""The place of ticks, and of the drains before them, in each millisecond of a clock."""

from __future__ import annotations

import struct
import threading
import time
from pathlib import Path

import pytest
from guestlib import Candump, can_frame, can_socket
from rig import C6XX_COMMAND, CONFIG, MS, client, commands, daemon

US = 1000
# A wake-up, and the part of a tick before it sends, in a guest where nothing else takes time.
TICK_US = 50
LEFT_FEEDBACK = 0x201


def configured(settings: str) -> Path:
    config = Path("/tmp/phase.yaml")
    config.write_text(CONFIG.read_text() + settings)
    return config


@pytest.mark.parametrize(("settings", "phase_us"), [("", 300), ("scheduler: {phase: 0.75}\n", 750)])
def test_ticks_lie_at_their_phase(settings: str, phase_us: int) -> None:
    with daemon(configured(settings)), client() as robot:
        times_us = []
        for t_s in robot.rate(100):
            if t_s >= 0.5:
                break
            times_us.append(robot.wait_for_state(1.0).mono_us)
        assert max((t - phase_us) % 1000 for t in times_us) < TICK_US


def test_on_the_wall_clock_ticks_lie_at_their_phase_until_that_is_stepped() -> None:
    # Away from the other clock, on which they would lie otherwise.
    ahead_ns = time.time_ns() - time.monotonic_ns()
    step_ns = (457 * US - ahead_ns) % MS
    time.clock_settime_ns(time.CLOCK_REALTIME, time.time_ns() + step_ns)
    settings = "scheduler: {phase: 0.3, phase_clock: realtime}\n"
    with daemon(configured(settings)) as process, client() as robot:
        with Candump("vcan0", ids=(C6XX_COMMAND,)) as bus:
            time.sleep(0.1)
            bus.stop()
        times_ns = [frame.t_ns for frame in commands(bus.frames(), C6XX_COMMAND)]
        assert len(times_ns) > 50
        assert max((t - 300 * US) % MS for t in times_ns) < TICK_US * US
        assert "wall clock" not in process.output()
        time.clock_settime_ns(time.CLOCK_REALTIME, time.time_ns() + 500 * US)
        process.wait_line(r"scheduler: the wall clock was stepped: ticks lie at 0\.80 of its", 5.0)
        for _ in range(20):
            robot.wait_for_state(1.0)
        assert 205 in [event.code for event in robot.events()]


@pytest.mark.parametrize(
    ("settings", "age_us"),
    [
        ("receive: thread\nrx: {lead_us: 200}\n", 1150),
        ("receive: thread\nrx: {lead_us: 50}\n", 150),
        ("receive: tick\n", 150),
    ],
)
def test_buses_are_drained_by_the_lead_before_each_tick(settings: str, age_us: int) -> None:
    """Feedback that comes 150 us before the tick, less the slack of this program's timer."""
    feedback = can_frame(LEFT_FEEDBACK, struct.pack(">3hBx", 0, 0, 0, 25))

    def send() -> None:
        next_ns = time.monotonic_ns() // MS * MS + 150 * US
        for _ in range(300):
            next_ns += MS
            time.sleep(max(0.0, (next_ns - time.monotonic_ns()) / 1e9))
            drive.send(feedback)

    with daemon(configured(settings)), client() as robot, can_socket("vcan0") as drive:
        sender = threading.Thread(target=send)
        sender.start()
        time.sleep(0.1)
        ages_us = [robot.wait_for_state(1.0).motors["left"].feedback_age_us for _ in range(20)]
        sender.join()
        assert age_us - 70 <= min(ages_us[5:])
        assert max(ages_us[5:]) <= age_us + 10
