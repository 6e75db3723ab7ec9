"""Above 1 kHz: each tick has its command and the answer to the one before, on buses with room."""
# run-guest: --timeout 900

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest
from family_rig import ROBOT, rc10ctl, running, wire_seconds, write_config
from guestlib import Candump, Proc
from rig import BIN, client, drive

import rc10

if TYPE_CHECKING:
    from pathlib import Path

    from guestlib import Frame

FD_BUS = "bitrate: 1000000\ndata_bitrate: 5000000"
SECONDS = 2
SPEED_RPM = 30.0
# As tests/kernel/test_grid.py: candump's resolution, and some reads of the clock in a tick.
TOLERANCE_NS = 5000


class Wire(NamedTuple):
    """Drives of one kind on an FD bus, at a rate that it has room for."""

    name: str
    rate_hz: int
    drives: int
    load: float  # without stuff bits
    fake: str
    keys: str
    divider: int = 1

    @property
    def period_ns(self) -> int:
        """Spacing of the commands to a drive."""
        return self.divider * 1_000_000_000 // self.rate_hz

    def write(self, folder: Path) -> Path:
        """Writes the robot."""
        motors = [
            f"name: m{i}, command_divider: {self.divider}, {self.keys.format(i, 16 + i)}"
            for i in range(1, self.drives + 1)
        ]
        return write_config(folder, *motors, bus=FD_BUS, rate_hz=self.rate_hz)

    def fakes(self) -> list[str]:
        """The drives on the other end."""
        return [self.fake.format(i, 16 + i) for i in range(1, self.drives + 1)]


MOTEUS = ("moteus:{0}", "model: moteus, id: {0}, motor_kv_rpm_per_v: 304")
DAMIAO = ("DM4310:{0}:{1}:fd", "model: DM4310, id: {0}, master_id: {1}, can_fd: true")
WIRES = (
    Wire("a moteus at 2000 Hz", 2000, 1, 0.44, *MOTEUS),
    Wire("a moteus told in every other of 4000 ticks", 4000, 1, 0.44, *MOTEUS, divider=2),
    Wire("an arm of three DM4310 at 2000 Hz", 2000, 3, 0.58, *DAMIAO),
    Wire("a DM4310 at 4000 Hz", 4000, 1, 0.39, *DAMIAO),
)


def stats() -> dict[str, Any]:
    return dict(json.loads(rc10ctl("stats", "--json")))


def command_times_ns(frames: list[Frame], drive_id: int, *, moteus: bool) -> list[int]:
    """Times of the frames to a drive."""
    command_id = 0x8000 | drive_id if moteus else drive_id
    return [frame.t_ns for frame in frames if frame.id == command_id]


@pytest.mark.parametrize("wire", WIRES, ids=lambda wire: wire.name)
def test_every_command_leaves_on_its_grid_and_is_answered_before_the_next(
    wire: Wire, tmp_path: Path
) -> None:
    targets = {f"m{i}": rc10.velocity_rpm(SPEED_RPM) for i in range(1, wire.drives + 1)}
    config = wire.write(tmp_path)
    with (
        running(config, *wire.fakes(), rate_hz=wire.rate_hz),
        client(robot_name=ROBOT) as robot,
        Candump("vcan0") as bus,
    ):
        robot.enable()
        drive(robot, 1.5, **targets)
        since_ns = time.time_ns()
        state = drive(robot, SECONDS, **targets)[-1]
        figures = stats()
        bus.stop()

    until_ns = since_ns + SECONDS * 1_000_000_000
    frames = [frame for frame in bus.frames() if since_ns <= frame.t_ns < until_ns]
    for number in range(1, wire.drives + 1):
        times = command_times_ns(frames, number, moteus=wire.fake == MOTEUS[0])
        assert len(times) == pytest.approx(SECONDS * wire.rate_hz / wire.divider, abs=1)
        grid = range(times[0], times[0] + len(times) * wire.period_ns, wire.period_ns)
        off_grid = [t for t, due in zip(times, grid, strict=True) if abs(t - due) > TOLERANCE_NS]
        assert off_grid == [], number
    # An answer to each command; at most one for each drive is on its way at either end.
    both = 2 * SECONDS * wire.drives * wire.rate_hz / wire.divider
    assert len(frames) == pytest.approx(both, abs=4 * wire.drives)
    assert all(frame.fd for frame in frames)
    for motor in state.motors.values():
        assert motor.status is rc10.MotorStatus.ACTIVE
        assert motor.velocity_rpm == pytest.approx(SPEED_RPM, abs=3)

    assert figures["missed_ticks"] == 0
    (wire_stats,) = figures["buses"]
    for trouble in ("rx_malformed", "rx_unmatched", "rx_foreign", "rx_dropped", "tx_dropped"):
        assert wire_stats[trouble] == 0, trouble
    age_us = figures["durations_us"]["feedback at use, bus wire"]
    assert age_us["p99"] <= wire.period_ns / 1000 + 50
    for load in (wire_seconds(frames) / SECONDS, wire_stats["measured_load"]):
        assert load == pytest.approx(wire.load, abs=0.02)
    assert wire_stats["predicted_load"] == pytest.approx(wire.load, abs=0.01)


def test_a_bus_without_room_for_the_rate_is_told_with_the_divider_that_fits(
    tmp_path: Path,
) -> None:
    _, moteus, arm, damiao = WIRES
    crowded = (moteus._replace(divider=1), arm._replace(drives=4), damiao._replace(drives=2))
    for wire in WIRES + crowded:
        with Proc(BIN / "rc10d", "--check", wire.write(tmp_path)) as check:
            check.wait(10.0)
        warning = "makes frames wait; command_divider: 2 or more"
        assert (warning in check.output()) is (wire in crowded), wire
