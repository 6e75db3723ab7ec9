"""The black box has recorded the frames of the bus, and they can be played on one again."""

from __future__ import annotations

import tempfile
from collections import defaultdict
from pathlib import Path
from typing import TYPE_CHECKING

from guestlib import Candump, Frame, run
from guestlib.candump import parse_line
from rig import BIN, COMMAND_IDS, drive, enabled_robot

import rc10

if TYPE_CHECKING:
    from collections.abc import Iterable

Sequences = dict[int, list[bytes]]


def by_id(frames: Iterable[Frame]) -> Sequences:
    """The bytes under each id, in order. Between ids the order is that of two sockets."""
    found: Sequences = defaultdict(list)
    for frame in frames:
        found[frame.id].append(frame.data)
    return found


def test_a_recording_is_what_was_on_the_bus_and_canplayer_plays_it() -> None:
    with Candump("vcan0") as witness, enabled_robot() as (_, robot):
        drive(robot, 0.5, left=rc10.velocity_rpm(120), yaw=rc10.angle_deg(90))
    seen = by_id(witness.frames())

    with tempfile.TemporaryDirectory() as folder:
        log = Path(run(str(BIN / "rc10ctl"), "blackbox", "--out", f"{folder}/out").split()[0])
        # Without the last word, whether it was received or sent.
        recorded = [parse_line(line[: line.rindex(" ")]) for line in log.read_text().splitlines()]
        name = recorded[0].iface
        with Candump("vcan0") as replay:
            run("canplayer", "-I", str(log), f"vcan0={name}")
    played = by_id(replay.frames())
    assert played == by_id(recorded)
    assert len(played) == len(COMMAND_IDS) + 5
    for number in COMMAND_IDS:
        assert len(played[number]) > 500
        assert played[number] == seen[number]
