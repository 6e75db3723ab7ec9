"""examples/languages (docs/lcm.md): the message definitions in four languages, each against it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from hostlib import Daemon, Program
from hostlib.daemon import REPO
from hostlib.page import blocks_run_by

LANGUAGES = REPO / "examples" / "languages"
NEEDED = {"c": "gcc", "cpp": "g++", "python": "lcm-gen", "java": "javac"}

# A Java machine starts, on a machine that may be busy.
PATIENCE_S = 60.0


@pytest.fixture
def program(language: str, tmp_path: Path) -> Path:
    """Its hello_motor."""
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


@pytest.mark.parametrize("language", list(NEEDED))
def test_a_program_enables_turns_prints_and_lets_go(
    language: str, program: Path, daemon: Daemon
) -> None:
    env = {"PYTHON": sys.executable}
    # Not a geared motor: what its encoder turns while this machine pauses is a fault.
    with Program(program, "host", "yaw", "60", env=env) as hello:
        # It follows; not how well, since a pause of this machine may let a command expire.
        line = rf"yaw status 3 owner 'hello-{language}' target 60(\.0)? measured [1-9]"
        hello.wait_line(line, PATIENCE_S)
        assert hello.wait(PATIENCE_S) == 0, hello.output
    yaw = daemon.wait_motor("yaw", lambda m: m["status"] == "READY", "is disabled")
    assert yaw["mode"] == "coast"

    # It runs for a second. One that has ended before the signal came tells nothing about signals.
    status = 0
    while status == 0:
        with Program(program, "host", "yaw", "60", env=env) as hello:
            hello.wait_line("yaw status 3", PATIENCE_S)
            hello.interrupt()
            status = hello.wait(PATIENCE_S)
    assert status == 130, hello.output
    daemon.wait_motor("yaw", lambda m: m["status"] == "READY", "is disabled by Ctrl-C")

    with Program(program, "host", "jaw", "60", env=env) as hello:
        assert hello.wait(PATIENCE_S) == 1, hello.output
        assert "there is no motor 'jaw'" in hello.output


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
