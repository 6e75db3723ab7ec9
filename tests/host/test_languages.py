"""examples/languages (docs/lcm.md): the message definitions in four languages, each against it."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon, Program
from hostlib.daemon import CONFIG, REPO, motor_of
from hostlib.page import blocks_run_by

if TYPE_CHECKING:
    from collections.abc import Iterator

LANGUAGES = REPO / "examples" / "languages"
NEEDED = {"c": "gcc", "cpp": "g++", "python": "lcm-gen", "java": "javac"}

# Its state comes once a second: until then its events alone show what becomes of a motor.
SELDOM = CONFIG.format(realtime="preferred").replace("state_hz: 100", "state_hz: 1")
PYTHON = {"PYTHON": sys.executable}

# A Java machine starts, on a machine that may be busy.
PATIENCE_S = 60.0
TRIES = 5


@pytest.fixture(scope="module", params=list(NEEDED))
def language(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture(scope="module")
def program(language: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Its hello_motor."""
    tmp_path = tmp_path_factory.mktemp(language)
    if shutil.which(NEEDED[language]) is None:
        pytest.skip(f"no {NEEDED[language]}: scripts/install-deps.sh languages")
    built = subprocess.run(
        ["make", "-C", LANGUAGES, f"BUILD={tmp_path}", "LCM_GEN=/usr/bin/lcm-gen", language],
        env={**os.environ, "CFLAGS": "-O1 -Wall -Wextra -Werror", "CXXFLAGS": "-Wall -Werror"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert built.returncode == 0, built.stdout + built.stderr
    return tmp_path / language / "hello_motor"


@pytest.fixture
def seldom() -> Iterator[Daemon]:
    with Daemon(SELDOM) as daemon:
        daemon.wait_ready()
        yield daemon


def stop_and_enable(daemon: Daemon) -> None:
    daemon.must("disable", "yaw")
    daemon.must("enable", "yaw")


def was_left(hello: Program, daemon: Daemon) -> bool:
    """Ends, with the motor moved by nobody, as another has it; False: it had ended by itself."""
    stopped = hello.wait(PATIENCE_S) != 0
    if stopped:
        assert "yaw was stopped: " in hello.output
        yaw = motor_of(daemon.state(), "yaw")
        seen = (yaw["status"], yaw["mode"], yaw["command_value"], yaw["owner"])
        assert seen == ("ACTIVE", "coast", 0, ""), hello.output
    daemon.must("disable", "yaw")
    return stopped


def test_a_program_enables_turns_prints_and_lets_go(
    language: str, program: Path, daemon: Daemon
) -> None:
    # Not a geared motor: what its encoder turns while this machine pauses is a fault.
    with Program(program, "host", "yaw", "60", env=PYTHON) as hello:
        # It follows; not how well, since a pause of this machine may let a command expire.
        line = rf"yaw status 3 owner 'hello-{language}' target 60(\.0)? measured [1-9]"
        hello.wait_line(line, PATIENCE_S)
        assert hello.wait(PATIENCE_S) == 0, hello.output
    yaw = daemon.wait_motor("yaw", lambda m: m["status"] == "READY", "is disabled")
    assert yaw["mode"] == "coast"

    # It runs for a second. One that has ended before the signal came tells nothing about signals.
    status = 0
    while status == 0:
        with Program(program, "host", "yaw", "60", env=PYTHON) as hello:
            hello.wait_line("yaw status 3", PATIENCE_S)
            hello.interrupt()
            status = hello.wait(PATIENCE_S)
    assert status == 130, hello.output
    daemon.wait_motor("yaw", lambda m: m["status"] == "READY", "is disabled by Ctrl-C")

    with Program(program, "host", "jaw", "60", env=PYTHON) as hello:
        assert hello.wait(PATIENCE_S) == 1, hello.output
        assert "there is no motor 'jaw'" in hello.output


def test_a_program_that_stood_leaves_a_motor_that_was_stopped_and_enabled_meanwhile(
    program: Path, daemon: Daemon
) -> None:
    with Program(program, "host", "yaw", "60", env=PYTHON) as hello:
        hello.wait_line("yaw status 3 owner 'hello-", PATIENCE_S)
        hello.signal(signal.SIGSTOP)
        since = daemon.state()["tick"]
        daemon.wait_state(lambda state: state["tick"] > since + 200, "a pause that it has to see")
        stop_and_enable(daemon)
        hello.signal(signal.SIGCONT)
        assert was_left(hello, daemon), hello.output


def test_a_program_leaves_a_motor_that_was_stopped_and_enabled_before_its_first_state(
    program: Path, seldom: Daemon
) -> None:
    # It runs for a second, on a machine that may be busy.
    for _ in range(TRIES):
        with Program(program, "host", "yaw", "60", env=PYTHON) as hello:
            seldom.program.wait_line("yaw: ENABLING -> ACTIVE")
            turns = hello.running
            stop_and_enable(seldom)
            left = was_left(hello, seldom)
        if turns:
            break
    assert turns, "it had ended each time before the motor was stopped"
    assert left, hello.output


def test_what_the_page_shows_turns_a_motor(tmp_path: Path) -> None:
    missing = [tool for tool in NEEDED.values() if shutil.which(tool) is None]
    if missing:
        pytest.skip(f"no {', '.join(missing)}: scripts/install-deps.sh languages")
    (block,) = blocks_run_by("tests/host/test_languages.py", REPO / "docs" / "lcm.md")
    with Daemon((REPO / "config" / "demo.yaml").read_text()) as daemon:
        daemon.wait_ready()
        done = subprocess.run(
            ["bash", "-ec", block.text.replace("/tmp/languages", str(tmp_path))],
            cwd=REPO,
            env={**os.environ, "PYTHON": sys.executable, "LCM_GEN": "/usr/bin/lcm-gen"},
            capture_output=True,
            text=True,
            check=False,
        )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "front_left status 3 owner 'hello-java'" in done.stdout
