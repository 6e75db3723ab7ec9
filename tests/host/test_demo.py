"""scripts/demo.sh, which is the first thing that a new user runs."""

from __future__ import annotations

import os
import re
import signal
import sys
from pathlib import Path

import pytest
from hostlib import Program, eventually, processes_of
from hostlib.daemon import BUILD, REPO
from hostlib.page import blocks_run_by
from hostlib.shown import missing_lines

ENV = {"RC10_BUILD": str(BUILD), "RC10_VENV": str(Path(sys.prefix))}
SUMMARY = re.compile(r"^rc10d: \d+ ticks, \d+ missed; wake latency", re.M)
MOTORS = ("front_left", "front_right", "rear_left", "rear_right", "yaw", "pitch", "feeder")


def demo(*words: str, **env: str) -> Program:
    return Program(REPO / "scripts" / "demo.sh", *words, env={**ENV, **env})


def run_dir_of(demo: Program) -> Path:
    """The folder that the hint for the second terminal names."""
    return Path(demo.wait_line(r"RC10_RUN_DIR=(\S+) \S+/rc10ctl watch$", 60.0)[1])


def assert_gone(run_dir: Path) -> None:
    eventually(lambda: not processes_of(run_dir), "no process of the demo is left")
    assert not run_dir.exists()


def process_named(run_dir: Path, name: str) -> int:
    for pid, words in processes_of(run_dir).items():
        if any(word.endswith(name) for word in words[:2]):
            return pid
    raise AssertionError(f"no {name} for {run_dir}")


def test_it_drives_for_some_seconds_and_sums_up() -> None:
    with demo("--seconds", "5") as shown:
        run_dir = run_dir_of(shown)
        # Tables, with targets that are followed.
        for _ in range(3):
            shown.wait_line(r"^MOTOR +STATUS +MODE +TARGET")
            for name in MOTORS:
                shown.wait_line(rf"^{name} +ACTIVE +\w+ +-?\d.*demo-drive")
        assert shown.wait() == 0, shown.output
        assert "followed their targets within" in shown.output
        errors = dict(re.findall(r"^  (\w+) +([\d.]+) (?:rpm|deg)$", shown.output, re.M))
        assert errors.keys() == set(MOTORS)
        assert float(errors["front_left"]) < 20
        assert SUMMARY.search(shown.output)
        (printed,) = blocks_run_by("tests/host/test_demo.py", REPO / "docs" / "quick-start.md")
        assert missing_lines(printed.text, shown.output) == []
        assert "\x1b" not in shown.output
        assert_gone(run_dir)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly(number: signal.Signals) -> None:
    with demo() as shown:
        run_dir = run_dir_of(shown)
        shown.wait_line("^feeder +ACTIVE")
        os.killpg(shown.pid, number)
        assert shown.wait() == 0, shown.output
        assert SUMMARY.search(shown.output)
        assert_gone(run_dir)


def test_a_second_terminal_can_command_it() -> None:
    with demo() as shown:
        run_dir = run_dir_of(shown)
        shown.wait_line("^feeder +ACTIVE")
        ctl = BUILD / "bin" / "rc10ctl"
        env = {"RC10_RUN_DIR": str(run_dir)}
        with Program(ctl, "estop", env=env) as estop:
            assert estop.wait() == 0, estop.output
        shown.wait_line("^demo +ESTOP")

        def done(verb: str) -> bool:
            with Program(ctl, verb, env=env) as again:
                return again.wait() == 0

        eventually(lambda: done("clear"), "cleared once every motor stands still")
        assert done("enable")
        shown.wait_line("^front_left +ACTIVE +velocity +-?\\d")
        os.killpg(shown.pid, signal.SIGINT)
        assert shown.wait() == 0, shown.output
        assert_gone(run_dir)


@pytest.mark.parametrize(
    ("victim", "complaint"),
    [("rc10d", "rc10d ended by itself"), ("demo_drive.py", "a program that drives ended")],
)
def test_it_says_what_broke(victim: str, complaint: str) -> None:
    with demo() as shown:
        run_dir = run_dir_of(shown)
        shown.wait_line("^feeder +ACTIVE")
        os.kill(process_named(run_dir, victim), signal.SIGKILL)
        assert shown.wait() == 1
        assert complaint in shown.output
        assert_gone(run_dir)


def test_without_namespaces_it_drives_through_the_link_socket(tmp_path: Path) -> None:
    refusing = tmp_path / "unshare"
    refusing.write_text("#!/bin/sh\necho 'unshare: Operation not permitted' >&2\nexit 1\n")
    refusing.chmod(0o755)
    with demo("--seconds", "3", PATH=f"{tmp_path}:{os.environ['PATH']}") as shown:
        shown.wait_line("refuses network namespaces.*Operation not permitted", 60.0)
        run_dir = run_dir_of(shown)
        shown.wait_line(r"^front_left +ACTIVE +velocity +120")
        assert shown.wait() == 0, shown.output
        assert "LCM on" not in shown.output
        assert_gone(run_dir)


def test_bad_usage_ends_with_status_2() -> None:
    with demo("--seconds", "soon") as shown:
        assert shown.wait() == 2
        assert "--seconds takes a whole number of seconds" in shown.output
    with demo("--second", "3") as shown:
        assert shown.wait() == 2
        assert "usage" in shown.output
