"""rc10ctl scan finds the drives, asks only what is harmless, and leaves rc10d alone."""

from __future__ import annotations

import json

from guestlib import Candump, Proc
from rig import BIN, daemon, fakes


def test_the_drives_are_found_and_nobody_is_commanded() -> None:
    with fakes(), Candump("vcan0") as bus:
        with Proc(BIN / "rc10ctl", "scan", "vcan0", "--seconds", "0.5", "--json") as scan:
            assert scan.wait(20.0) == 0
        bus.stop()
        found = {}
        for line in scan.output().splitlines():
            sighting = json.loads(line)
            found[sighting["frame_id"]] = {(g["kind"], g["id"]) for g in sighting["guesses"]}
        for number in (1, 2, 3):
            assert found[0x200 + number] == {("DJI M3508 or M2006", number)}
        # The ids of GM6020 5 and 6 are above those of C620 and C610.
        assert found[0x209] == {("DJI GM6020", 5)}
        assert found[0x20A] == {("DJI GM6020", 6)}
        asked = [frame for frame in bus.frames() if frame.id not in found]
        assert asked
        assert {frame.id >> 8 for frame in asked} == {0x11, 0xFD}


def test_an_interface_that_rc10d_drives_is_refused() -> None:
    with fakes(), daemon(), Proc(BIN / "rc10ctl", "scan", "vcan0") as scan:
        assert scan.wait(10.0) == 1
        assert "vcan0 is driven by robot 'vcan_mixed'" in scan.output()
        assert "rc10ctl stats" in scan.output()
