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
            if "frame_id" not in sighting:  # the last one: about the bus
                continue
            assert sighting["advice"] is None
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


def test_a_bus_on_which_nothing_is_heard_is_told_in_json_too() -> None:
    with Proc(BIN / "rc10ctl", "scan", "vcan1", "--seconds", "0.5", "--json") as scan:
        assert scan.wait(20.0) == 0
        (line,) = scan.output().splitlines()
    told = json.loads(line)
    assert told["interface"] == "vcan1"
    assert told["frame_ids"] == 0
    assert told["advice"][0].startswith("nothing was heard: check the drives' power")


def test_an_interface_that_is_not_there_is_an_error_in_json_too() -> None:
    with Proc(BIN / "rc10ctl", "scan", "can7", "--json") as scan:
        assert scan.wait(10.0) == 1
        assert "can7" in json.loads(scan.output().splitlines()[0])["error"]
