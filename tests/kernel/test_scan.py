"""rc10ctl scan finds the drives and asks only what is harmless; on its own bus rc10d asks."""

from __future__ import annotations

import json
import time
from itertools import pairwise
from typing import TYPE_CHECKING

from guestlib import Candump, Proc
from rig import BIN, MS, client, daemon, enabled_robot, fakes, wait_status

import rc10

if TYPE_CHECKING:
    from pathlib import Path


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


def test_rc10d_refuses_a_scan_while_its_motors_are_enabled() -> None:
    with enabled_robot(), Proc(BIN / "rc10ctl", "scan", "vcan0") as scan:
        assert scan.wait(10.0) == 1
        assert "scan: mixed is scanned only while its motors rest: left: ENABLING" in scan.output()


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


# Three of the fakes are not in it, and one motor of it is not there.
FEW = """
robot: few
realtime: preferred
buses:
  - name: front
    type: socketcan
    interface: vcan0
    motors:
      - {name: left, model: M3508, id: 1, zero: power_on}
      - {name: right, model: M3508, id: 2, zero: power_on}
      - {name: lost, model: M3508, id: 8, zero: power_on}
"""


def test_rc10d_scans_its_own_bus_on_request_and_asks_at_its_pace(tmp_path: Path) -> None:
    config = tmp_path / "few.yaml"
    config.write_text(FEW)
    with fakes(), daemon(config), client(robot_name="few") as robot:
        wait_status(robot, rc10.MotorStatus.READY, "left", "right")
        with Candump("vcan0") as bus:
            with Proc(BIN / "rc10ctl", "scan", "vcan0", "--seconds", "0.5", "--json") as scan:
                assert scan.wait(30.0) == 0
            bus.stop()
            *sightings, about = [json.loads(line) for line in scan.output().splitlines()]
            motors = {
                (guess["kind"], guess["id"]): guess["motor"]
                for sighting in sightings
                for guess in sighting["guesses"]
            }
            assert motors["DJI M3508 or M2006", 1] == "left"
            assert motors["DJI M3508 or M2006", 3] is None
            assert motors["DJI GM6020", 5] is None
            assert about["robot"] == "few"
            assert about["advice"][0] == "not heard, but in the file: lost"
            asked = [frame for frame in bus.frames() if frame.ext]
            assert {frame.id >> 8 for frame in asked} == {0x11, 0xFD}
            assert len({frame.id for frame in asked}) == len(asked) == 254 + 127
            # At least 2 ms apart, on the grid of the ticks.
            gaps = [later.t_ns - sooner.t_ns for sooner, later in pairwise(asked)]
            assert min(gaps) > 1.8 * MS


def test_a_motor_that_is_enabled_meanwhile_ends_the_scan_of_its_bus(tmp_path: Path) -> None:
    config = tmp_path / "few.yaml"
    config.write_text(FEW)
    with fakes(), daemon(config), client(robot_name="few") as robot:
        wait_status(robot, rc10.MotorStatus.READY, "left", "right")
        with Candump("vcan0") as bus:
            with Proc(BIN / "rc10ctl", "scan", "vcan0", "--seconds", "0.5") as scan:
                bus.wait_frame(lambda frame: frame.ext)  # the first question
                robot.enable("left")
                enabled_ns = time.time_ns()
                assert scan.wait(10.0) == 1
            assert "was not scanned to the end: left: enabled meanwhile" in scan.output()
            half_a_second_later_ns = time.time_ns() + 500 * MS
            bus.wait_frame(lambda frame: frame.t_ns > half_a_second_later_ns)
            bus.stop()
        asked = [frame.t_ns for frame in bus.frames() if frame.ext]
        assert 0 < len(asked) < 254 + 127
        assert max(asked) < enabled_ns
