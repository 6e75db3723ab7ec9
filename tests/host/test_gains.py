"""rc10ctl gains: the gains of a motor's loops, shown, changed while it runs, and saved."""

from __future__ import annotations

import json
import subprocess
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon
from hostlib.daemon import ARM, BIN

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

MOTOR = "      - {name: wheel, model: M3508, id: 1, feedback_timeout_ms: 1000, zero: power_on%s}\n"
ELBOW = "      - {name: elbow, model: DM4310, id: 2, master_id: 18, command_divider: 4,\n"
ELBOW += "         feedback_timeout_ms: 1000}\n"
START = ", velocity_pid: {kp_a_per_rpm: 0.25}, angle_pid: {kp_rpm_per_deg: 3}"


@pytest.fixture
def tuned() -> Iterator[Daemon]:
    with Daemon(ARM + MOTOR % START + ELBOW) as daemon:
        daemon.wait_ready()
        yield daemon


def gains(daemon: Daemon, *words: str) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = json.loads(daemon.must("gains", "wheel", *words, "--json"))
    return found


def rows(text: str) -> dict[str, list[str]]:
    return {words[0]: words[1:] for words in map(str.split, text.splitlines()) if words}


def test_all_loops_and_gains_are_shown(tuned: Daemon) -> None:
    shown = rows(tuned.must("gains", "wheel"))
    assert shown["GAIN"] == ["VALUE"]
    assert shown["velocity_pid.kp_a_per_rpm"] == ["0.25"]
    assert shown["angle_pid.kp_rpm_per_deg"] == ["3"]
    assert len(shown) == 16
    assert gains(tuned)["gains"]["velocity_pid.kp_a_per_rpm"] == 0.25


def test_a_change_shows_before_and_after_while_the_motor_is_enabled(tuned: Daemon) -> None:
    tuned.must("enable", "wheel")
    told = tuned.must("gains", "wheel", "velocity.kp=0.8", "angle_pid.kp_rpm_per_deg=4.5")
    shown = rows(told)
    assert shown["GAIN"] == ["BEFORE", "AFTER"]
    assert shown["velocity_pid.kp_a_per_rpm"] == ["0.25", "0.8"]
    assert shown["angle_pid.kp_rpm_per_deg"] == ["3", "4.5"]
    assert len(shown["velocity_pid.ki_a_per_rpm_s"]) == 1
    assert "until rc10d restarts" in told
    again = gains(tuned, "velocity.kp=0.9")
    assert again["before"]["velocity_pid.kp_a_per_rpm"] == 0.8
    assert again["gains"]["velocity_pid.kp_a_per_rpm"] == 0.9


def test_saved_lines_are_accepted_in_place_of_the_old_ones(tuned: Daemon, tmp_path: Path) -> None:
    told = tuned.must("gains", "wheel", "velocity.kp=0.8", "angle.deadband=0.1", "--save")
    lines = [line for line in told.splitlines() if line.startswith(("velocity_pid:", "angle_pid:"))]
    assert tuned.must("gains", "wheel", "--save").splitlines()[1:] == lines
    pasted = tmp_path / "pasted.yaml"
    pasted.write_text(ARM + MOTOR % (", " + ", ".join(lines)))
    check = subprocess.run(
        [str(BIN / "rc10d"), "--check", str(pasted)],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    assert check.returncode == 0, check.stderr
    assert "kp 0.8" in check.stdout
    with Daemon(pasted.read_text()) as anew:
        anew.wait_ready()
        assert gains(anew)["gains"] == gains(tuned)["gains"]


@pytest.mark.parametrize(
    ("setting", "reason"),
    [
        ("velocity.kp=-1", "wheel: velocity_pid.kp_a_per_rpm: -1 is below 0 A/rpm; use 0 to"),
        ("kp_a_per_rmp=1", "did you mean velocity_pid.kp_a_per_rpm?"),
        ("current_limit_a=20", "at the start only; change it in the robot's file"),
        ("velocity.kp=nan", "not a finite number"),
    ],
)
def test_an_impossible_gain_changes_nothing_and_says_why(
    tuned: Daemon, setting: str, reason: str
) -> None:
    done = tuned.ctl("gains", "wheel", "velocity.ki=7", setting)
    assert done.returncode == 1
    assert reason in done.stderr
    assert gains(tuned)["gains"]["velocity_pid.ki_a_per_rpm_s"] != 7


def test_a_motor_of_a_drive_with_its_own_loops_says_so(tuned: Daemon) -> None:
    done = tuned.ctl("gains", "elbow")
    assert done.returncode == 1
    assert "elbow: rc10d closes no loop of the DM4310" in done.stderr


@pytest.mark.parametrize("setting", ["velocity.kp", "velocity.kp=", "=1", "velocity.kp=x"])
def test_what_is_no_setting_is_wrong_usage(tuned: Daemon, setting: str) -> None:
    assert tuned.ctl("gains", "wheel", setting).returncode == 2


def test_without_a_daemon_it_says_how_to_start_one(tuned: Daemon) -> None:
    tuned.kill()
    done = tuned.ctl("gains", "wheel")
    assert done.returncode == 3
    assert "start" in done.stderr
