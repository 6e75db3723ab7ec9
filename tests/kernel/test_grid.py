"""Ticks by the thousand: ten seconds of them, or a minute in the set all (RC10_GRID_S)."""
# run-guest: --timeout 900

from __future__ import annotations

import os

from guestlib import Candump
from rig import COMMAND_IDS, MS, commands, enabled_robot, next_diagnostics

import rc10

# candump's stamps have a resolution of a microsecond. And a tick receives before it sends, which
# takes some reads of the clock, in a guest where nothing else takes time: a tick without frames
# sends 3 us earlier.
TOLERANCE_NS = 4000
SECONDS = int(os.environ.get("RC10_GRID_S", "10"))


def test_every_command_id_leaves_exactly_once_a_millisecond() -> None:
    with enabled_robot() as (_, robot), Candump("vcan0", ids=COMMAND_IDS) as bus:
        before = next_diagnostics(robot)
        for t_s in robot.rate(50):
            if t_s >= SECONDS + 0.2:
                break
            robot.command(left=rc10.velocity_rpm(100), validity_ms=100)
        bus.stop()
        frames = bus.frames()
        for number in COMMAND_IDS:
            times = [frame.t_ns for frame in commands(frames, number)]
            assert len(times) > SECONDS * 1000
            # Each frame stands on its own grid point.
            off_grid = [t for i, t in enumerate(times) if abs(t - times[0] - i * MS) > TOLERANCE_NS]
            assert off_grid == []
        after = next_diagnostics(robot)
        assert after.missed_ticks == before.missed_ticks
        assert after.page_faults == 0
