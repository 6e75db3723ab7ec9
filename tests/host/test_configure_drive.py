"""rc10ctl configure-drive: what is written into a drive, and only when somebody means it."""

from __future__ import annotations

import json
import subprocess
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon
from hostlib.daemon import ARM, BIN, REPO
from hostlib.page import blocks_run_by
from hostlib.reader import commands
from hostlib.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator

MOTORS = """\
      - {name: elbow, model: DM4310, id: 2, master_id: 18, command_divider: 4,
         feedback_timeout_ms: 1000}
      - {name: hip, model: RS00, id: 3, command_divider: 4, feedback_timeout_ms: 1000}
      - {name: knee, model: RMD-X8-20, id: 4, command_divider: 4, feedback_timeout_ms: 1000}
      - {name: wheel, model: M3508, id: 1, feedback_timeout_ms: 1000}
"""


@pytest.fixture
def arm() -> Iterator[Daemon]:
    with Daemon(ARM + MOTORS) as daemon:
        daemon.wait_ready()
        yield daemon


def answering(arm: Daemon, typed: str, *words: str) -> subprocess.CompletedProcess[str]:
    """rc10ctl configure-drive with somebody at its input."""
    return subprocess.run(
        [str(BIN / "rc10ctl"), "configure-drive", *words],
        env=arm.env,
        input=typed,
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )


def test_every_drive_tells_what_can_be_written(arm: Daemon) -> None:
    assert "timeout_ms 0 to 10000\n" in arm.must("configure-drive", "elbow", "--list")
    assert "zero_range 0 to 1, whole\n" in arm.must("configure-drive", "hip", "--list")
    assert "save_turns 0 to 1, whole\n" in arm.must("configure-drive", "knee", "--list")
    assert "nothing can be written" in arm.must("configure-drive", "wheel", "--list")


def test_what_can_be_written_is_told_in_json(arm: Daemon) -> None:
    told = json.loads(arm.must("configure-drive", "hip", "--list", "--json"))
    assert told["motor"] == "hip"
    settings = {setting["name"]: setting for setting in told["settings"]}
    assert settings["zero_range"] == {"name": "zero_range", "min": 0, "max": 1, "whole": True}
    assert told["notes"][0].startswith("everything else: ")
    nothing = json.loads(arm.must("configure-drive", "wheel", "--list", "--json"))
    assert nothing["settings"] == []
    assert "nothing can be written" in nothing["notes"][0]


def test_what_was_written_is_told_in_json_and_the_question_is_asked_beside_it(arm: Daemon) -> None:
    done = answering(arm, "elbow\n", "elbow", "timeout_ms=200", "--json")
    assert done.returncode == 0, done.stderr
    assert "Type its name:" in done.stderr
    told = json.loads(done.stdout)
    assert told == {"motor": "elbow", "message": "elbow: timeout_ms = 200, stored"}


def test_flash_is_written_when_the_motor_is_named_once_more(arm: Daemon) -> None:
    done = answering(arm, "elbow\n", "elbow", "timeout_ms=200", "control_mode=2")
    assert done.returncode == 0, done.stderr
    assert (
        "write timeout_ms=200, control_mode=2 to the flash of elbow? Type its name:" in done.stdout
    )
    assert "elbow: timeout_ms = 200, control_mode = 2, stored\n" in done.stdout


def test_the_page_shows_what_stands_at_the_terminal(arm: Daemon) -> None:
    (block,) = blocks_run_by("tests/host/test_configure_drive.py", REPO / "docs" / "rc10ctl.md")
    (shown,) = commands(block)
    name = shown.text.split()[2]
    with Terminal([str(BIN / "rc10ctl"), *shown.text.split()[1:]], arm.env) as terminal:
        terminal.answer("Type its name: ", name)
        assert terminal.end() == 0, terminal.text
    assert terminal.text == shown.output


@pytest.mark.parametrize("typed", ["", "\n", "y\n", "hip\n"])
def test_anything_else_writes_nothing(arm: Daemon, typed: str) -> None:
    done = answering(arm, typed, "elbow", "timeout_ms=200")
    assert done.returncode == 1
    assert "nothing was written" in done.stderr


def test_ram_is_written_without_asking(arm: Daemon) -> None:
    told = arm.must("configure-drive", "hip", "timeout_ms=100", "--no-save")
    assert told == "hip: timeout_ms = 100, until it is without power\n"


def test_a_drive_that_stores_at_once_says_so(arm: Daemon) -> None:
    assert "stored" in arm.must("configure-drive", "knee", "timeout_ms=500", "--yes")
    done = arm.ctl("configure-drive", "knee", "timeout_ms=500", "--no-save")
    assert done.returncode == 1
    assert "stores what it is told" in done.stderr


def test_an_enabled_motor_is_left_alone(arm: Daemon) -> None:
    arm.must("enable", "elbow")
    done = arm.ctl("configure-drive", "elbow", "timeout_ms=200", "--yes")
    assert done.returncode == 1
    assert "disable it first" in done.stderr


@pytest.mark.parametrize(
    "setting", ["timeout_ms", "timeout_ms=", "timeout_ms=x", "=1", "timeout_ms=nan"]
)
def test_what_is_no_setting_is_wrong_usage(arm: Daemon, setting: str) -> None:
    assert arm.ctl("configure-drive", "elbow", setting, "--yes").returncode == 2


def test_after_that_the_motor_is_enabled_as_before(arm: Daemon) -> None:
    arm.must("configure-drive", "elbow", "timeout_ms=200", "--yes")
    arm.must("enable", "elbow")
