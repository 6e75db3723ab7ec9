"""rc10ctl --json: every verb answers in JSON, or says that it does not."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

import pytest
from hostlib import Daemon
from hostlib.command_help import help_of, verbs
from hostlib.daemon import CONFIG, REPO

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

LIFT = """
modules:
  - {name: lift, type: synchronised_pair, left: wheel, right: other, velocity_limit_rpm: 60}
"""
# Arguments that a verb needs. All that the help names are called: a new one has to come here.
WORDS: dict[str, list[str | Path]] = {
    "list": [],
    "watch": ["--once"],
    "stats": [],
    "enable": ["yaw"],
    "disable": [],
    "estop": [],
    "clear": [],
    "zero": ["yaw"],
    "modules": [],
    "signal": ["lift", "velocity_rpm=0", "--for", "50ms"],
    "gains": ["wheel"],
    "configure-drive": ["wheel", "--list"],
    "hand": ["wheel", "--by", "5"],
    "load": ["wheel", "coulomb_nm=0.1"],
    "check": [REPO / "config" / "demo.yaml"],
    "convert-gains": ["--speed", "18", "0.015", "0", "--angle", "30", "0", "1.1"],
    "blackbox": [],
    "doctor": ["--config", REPO / "config" / "demo.yaml", "--latency-seconds", "0"],
    "set": ["wheel", "coast"],
    "jog": ["wheel"],
    "commission": ["wheel"],
}
# Verbs that have to fail here.
FAILS: dict[str, list[str | Path]] = {
    "scan": ["nocan0"],
    # Not enabled.
    "test-motion": ["other", "step", "5", "--max-current", "5"],
    "web": ["--port", "1"],
    # There is no root helper.
    "config": ["check", REPO / "config" / "demo.yaml"],
}


@pytest.fixture(scope="module")
def lift() -> Iterator[Daemon]:
    with Daemon(CONFIG.format(realtime="preferred") + LIFT) as daemon:
        daemon.wait_ready()
        yield daemon


def objects(text: str) -> list[dict[str, Any]]:
    found = [json.loads(line) for line in text.splitlines()]
    assert all(isinstance(one, dict) for one in found)
    return found


def without_json() -> set[str]:
    """The verbs that the help of --json leaves out."""
    named = re.search(r"--json +.*?; not ([a-z, \n]+?)\n *\n", help_of(), re.DOTALL)
    assert named
    return set(re.findall(r"[a-z]+", named[1]))


def test_only_what_moves_a_motor_before_the_eyes_of_a_person_has_no_json() -> None:
    assert without_json() == {"set", "jog", "commission"}


@pytest.mark.parametrize("verb", verbs())
def test_every_verb_answers_in_json_or_refuses_it(lift: Daemon, verb: str) -> None:
    if verb == "signal":
        lift.must("clear")
        lift.must("enable", "wheel", "other")
    done = lift.ctl(verb, *{**WORDS, **FAILS}[verb], "--json")
    if verb == "signal":
        lift.must("disable", "wheel", "other")
    told = objects(done.stdout)
    assert told, done.stderr
    if verb in without_json():
        assert done.returncode == 2
        assert "leave out --json" in done.stderr
    elif verb in FAILS:
        assert done.returncode == 1
    elif verb != "doctor":  # this computer may be no good for a robot
        assert done.returncode == 0, done.stderr
    failed = bool(done.returncode) and verb != "doctor"
    assert ["error" in one for one in told] == [failed] * len(told)


def test_a_failure_is_on_stdout_in_json_and_on_stderr_in_words(lift: Daemon) -> None:
    done = lift.ctl("gains", "nobody", "--json")
    assert done.returncode == 1
    (told,) = objects(done.stdout)
    assert done.stderr == f"rc10ctl: {told['error']}\n"


@pytest.mark.parametrize(
    "words", [["blackbox", "--candump"], ["watch", "--spark", "wheel.velocity"]]
)
def test_an_option_for_people_is_refused_beside_json(lift: Daemon, words: list[str]) -> None:
    done = lift.ctl(*words, "--json")
    assert done.returncode == 2
    assert "leave out --json" in done.stderr


def test_a_configuration_is_told_with_its_motors(lift: Daemon) -> None:
    (told,) = objects(lift.must("check", lift.config, "--json"))
    assert (told["ok"], told["errors"]) == (True, [])
    robot = told["robot"]
    assert robot["name"] == "host"
    assert [bus["name"] for bus in robot["buses"]] == ["chassis", "gimbal"]
    wheel = robot["buses"][0]["motors"][0]
    assert (wheel["name"], wheel["model"], wheel["id"]) == ("wheel", "M3508", 1)
    assert wheel["feedback_timeout_ms"] == 1000
    assert "angle" in wheel["modes"]
    assert [module["type"] for module in robot["modules"]] == ["synchronised_pair"]


def test_what_is_wrong_with_a_configuration_is_told_by_its_places(
    lift: Daemon, tmp_path: Path
) -> None:
    file = tmp_path / "bad.yaml"
    file.write_text("robot: host\nrate_hz: x\nbuses: []\n")
    done = lift.ctl("check", file, "--json")
    assert done.returncode == 1
    (told,) = objects(done.stdout)
    assert (told["ok"], told["robot"]) == (False, None)
    assert 2 in [error["line"] for error in told["errors"]]
    assert all(error["text"] for error in told["errors"])


def test_gains_are_converted_to_the_keys_of_a_configuration(lift: Daemon) -> None:
    words = ("convert-gains", "--speed", "18", "0.015", "0", "0", "0", "15000", "5")
    (told,) = objects(lift.must(*words, "--json"))
    assert told["current_limit_a"] == 15
    assert told["velocity_pid"] == {
        "type": "incremental",
        "kp_a_per_rpm": 0.018,
        "ki_a_per_rpm_s": 0.015,
        "kd_a_s_per_rpm": 0,
        "deadband_rpm": 5,
    }
    assert told["notes"] == []


def test_both_files_of_a_black_box_are_named(lift: Daemon, tmp_path: Path) -> None:
    (told,) = objects(lift.must("blackbox", "--out", tmp_path, "--json"))
    assert told == {"files": [f"{tmp_path}/host.log", f"{tmp_path}/host.jsonl"]}
