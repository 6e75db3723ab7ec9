"""rc10ctl scan on a bus that rc10d drives: through rc10d, and only while its motors rest."""

from __future__ import annotations

import json
import signal
from collections.abc import Iterator
from typing import Any

import pytest
from hostlib import Daemon
from hostlib.daemon import ARM, REPO
from hostlib.page import blocks_run_by
from hostlib.program import eventually
from hostlib.reader import commands

import rc10

# The drive of the feeder is set to id 3, that of the knee answers the questions.
MOTORS = """\
      - {name: wheel, model: M3508, id: 1, feedback_timeout_ms: 1000}
      - {name: feeder, model: M3508, id: 2, feedback_timeout_ms: 1000, simulated: {drive_id: 3}}
      - {name: knee, model: RS00, id: 5, command_divider: 4, feedback_timeout_ms: 1000}
"""


@pytest.fixture(scope="module")
def arm() -> Iterator[Daemon]:
    with Daemon(ARM + MOTORS) as daemon:
        daemon.wait_up()
        daemon.wait_motor("wheel", lambda motor: motor["status"] == "READY", "is heard")
        daemon.wait_motor("knee", lambda motor: motor["status"] == "READY", "is heard")
        yield daemon


def heard(text: str) -> tuple[dict[tuple[str, int], str | None], dict[str, Any]]:
    """The motor of each drive in the lines of --json, and the line about the bus."""
    *sightings, bus = [json.loads(line) for line in text.splitlines()]
    return {
        (guess["kind"], guess["id"]): guess["motor"]
        for sighting in sightings
        for guess in sighting["guesses"]
        if guess["from_drive"]
    }, bus


def test_drives_are_told_with_their_motors_and_those_that_the_file_does_not_have(
    arm: Daemon,
) -> None:
    drives, bus = heard(arm.must("scan", "arm", "--seconds", "0.5", "--json"))
    assert drives["DJI M3508 or M2006", 1] == "wheel"
    assert drives["DJI M3508 or M2006", 3] is None
    assert drives["RobStride or CyberGear", 5] == "knee"
    assert bus["robot"] == "host"
    assert bus["advice"][0] == "not heard, but in the file: feeder"


def test_a_drive_that_only_answers_is_found_by_the_question() -> None:
    # Its motor has another id, so that rc10d itself never speaks to it.
    motors = MOTORS.replace(
        "id: 5, command_divider: 4, feedback_timeout_ms: 1000",
        "id: 5, command_divider: 4, feedback_timeout_ms: 1000, simulated: {drive_id: 9}",
    )
    with Daemon(ARM + motors) as daemon:
        daemon.wait_up()
        daemon.wait_motor("wheel", lambda motor: motor["status"] == "READY", "is heard")
        listened, _ = heard(
            daemon.must("scan", "arm", "--seconds", "0.5", "--listen-only", "--json")
        )
        assert ("RobStride or CyberGear", 9) not in listened
        asked, _ = heard(daemon.must("scan", "arm", "--seconds", "0.5", "--json"))
        assert asked["RobStride or CyberGear", 9] is None


def test_it_is_refused_while_a_motor_of_the_bus_is_enabled(arm: Daemon) -> None:
    arm.must("enable", "wheel")
    try:
        done = arm.ctl("scan", "arm", "--seconds", "0.5")
        assert done.returncode == 1
        assert (
            "scan: arm is scanned only while its motors rest: wheel: ENABLING or ACTIVE: disable "
            "it first" in done.stderr
        )
    finally:
        arm.must("disable", "wheel")


def test_a_motor_that_is_enabled_meanwhile_is_enabled_and_the_scan_ends(arm: Daemon) -> None:
    told = ""
    while "was not scanned to the end: wheel: enabled meanwhile" not in told:
        with arm.drive("scan", "arm", "--seconds", "60") as scan:
            arm.must("enable", "wheel")
            assert scan.wait() == 1
            told = scan.output
        arm.wait_motor("wheel", lambda motor: motor["status"] == "ACTIVE", "is enabled")
        arm.must("disable", "wheel")
        # A busy computer may have begun to scan after the motor was enabled.
        assert "enabled meanwhile" in told or "ENABLING or ACTIVE" in told


def test_a_scan_ends_with_its_client_and_leaves_the_bus_to_the_next(arm: Daemon) -> None:
    def again() -> str:
        return arm.ctl("scan", "arm", "--seconds", "0.5").stderr

    listens = False
    while not listens:  # again() may be faster than the first, which is refused then
        with arm.drive("scan", "arm", "--seconds", "60") as first:
            eventually(lambda: "another scan goes on" in again() or not first.running, "it listens")
            listens = first.running
            first.signal(signal.SIGKILL)
            eventually(lambda: again() == "", "the bus is free")


@pytest.mark.usefixtures("arm")
def test_a_program_gets_the_drives_in_words() -> None:
    with rc10.connect("host", client="program") as robot:
        robot.wait_for_state()
        answer = robot.request("scan", "arm", {"listen_s": 0.5}, timeout_s=60.0)
    assert "DJI M3508 or M2006 id 1 (wheel)" in answer.message
    assert "DJI M3508 or M2006 id 3 (not in the file)" in answer.message


@pytest.mark.usefixtures("arm")
def test_a_bus_that_there_is_not_is_told_with_those_that_there_are() -> None:
    with rc10.connect("host", client="program") as robot:
        robot.wait_for_state()
        with pytest.raises(rc10.RequestRefused, match="not 'leg'; the buses are: arm"):
            robot.request("scan", "leg")


def test_the_page_shows_what_stands_at_the_terminal(arm: Daemon) -> None:
    (block,) = blocks_run_by("tests/host/test_scan.py", REPO / "docs" / "rc10ctl.md")
    (shown,) = commands(block)
    told = arm.must(*shown.text.split()[1:], "--seconds", "0.5").splitlines()
    for line in shown.output.splitlines()[1:]:
        # Frames are counted, and stand beside their number.
        words = [word for word in line.split() if not word.isdigit() or len(word) < 3]
        assert any(all(word in each.split() for word in words) for each in told), line
