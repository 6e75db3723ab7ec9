"""examples/small_robot and its README.md: one program in C++ and in Python, its remote on a pty."""

from __future__ import annotations

import contextlib
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from hostlib import Daemon, Program, eventually
from hostlib.daemon import BIN, REPO, State
from hostlib.page import Block, blocks_run_by
from hostlib.reader import Reader, commands
from hostlib.stalls import stood_still_since
from hostlib.terminal import Terminal

import rc10

EXAMPLE = REPO / "examples" / "small_robot"
PROGRAMS = {
    "cpp": (BIN / "small_robot",),
    "python": (sys.executable, EXAMPLE / "small_robot.py"),
}
# It ends by itself after its mission, which takes some seconds.
MISSION_S = 60.0


class Remote:
    """fake_remote.py; leaving the `with` statement ends it."""

    def __init__(self, port: Path) -> None:
        self._process = subprocess.Popen(
            [sys.executable, EXAMPLE / "fake_remote.py", port], stdin=subprocess.PIPE, text=True
        )
        eventually(port.exists, "the remote's port")

    def __enter__(self) -> Remote:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.communicate(timeout=20)

    def type(self, word: str) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(f"{word}\n")
        self._process.stdin.flush()


@pytest.fixture
def port(tmp_path: Path) -> Path:
    return tmp_path / "remote"


def robot(port: Path) -> str:
    """The robot of the example, with its remote at this port."""
    text = (EXAMPLE / "robot.yaml").read_text()
    example_port = "/tmp/small_robot_remote"
    assert example_port in text
    # A busy machine stops for long: neither a drive nor the remote may seem lost by that.
    patient = re.sub(r"(feedback_timeout_ms|lost_ms): 500", r"\1: 1000", text)
    return patient.replace(example_port, str(port))


@pytest.fixture
def small(port: Path) -> Iterator[Daemon]:
    """The robot of the example, all its motors READY."""
    with Daemon(robot(port)) as daemon:
        daemon.wait_ready()
        yield daemon


def program(language: str, *words: str) -> Program:
    return Program(*PROGRAMS[language], "small", *words)


def at_rest(state: State) -> bool:
    return all(m["status"] == "READY" and m["mode"] == "coast" for m in state["motors"])


def wait_heard(daemon: Daemon) -> None:
    """Waits until the remote is heard with its arm switch down."""
    words = ("connected = 1", "left_switch = -1")
    eventually(lambda: all(word in daemon.must("modules") for word in words), "the remote is heard")


def does_its_mission_also_after_the_remote_was_lost(
    small: Daemon, port: Path, language: str
) -> None:
    with Remote(port) as remote, program(language) as robot:
        # A switch that is up when it is first seen enables nothing.
        wait_heard(small)
        remote.type("up")
        robot.wait_line("^WAIT_ARMED -> DRIVE$")
        small.wait_motor("front_left", lambda m: m["owner"] == "base", "is driven by the chassis")
        remote.type("off")
        robot.wait_line("-> SAFE: the remote is lost$")
        small.wait_state(at_rest, "disabled without any program")
        robot.wait_line("^SAFE -> WAIT_ARMED$")
        remote.type("on")
        remote.type("down")
        wait_heard(small)
        remote.type("up")
        robot.wait_line("^WAIT_ARMED -> DRIVE$")
        for line in ("DRIVE -> AIM", "AIM -> FIRE", "FIRE -> DONE"):
            robot.wait_line(f"^{line}$", MISSION_S)
        assert robot.wait() == 0, robot.output
        state = small.wait_motor("feeder_wheel", lambda m: abs(m["velocity_rpm"]) < 1, "rests")
        assert state["total_angle_deg"] > 100
        small.wait_motor("yaw", lambda m: abs(m["angle_deg"] - 30) < 3, "is held by the gimbal")


@pytest.mark.parametrize("language", PROGRAMS)
def test_it_does_its_mission_also_after_the_remote_was_lost(
    small: Daemon, port: Path, language: str
) -> None:
    for _ in range(5):
        begin_s = time.monotonic()
        try:
            return does_its_mission_also_after_the_remote_was_lost(small, port, language)
        except AssertionError as failed:
            # It then waits to be armed once more, as it should.
            cut_off = "no news of rc10d" in str(failed)
            if not cut_off or not stood_still_since(begin_s, f"a mission in {language}"):
                raise
    raise AssertionError("five missions without news of rc10d")


def test_a_stick_is_held_where_it_was_typed(small: Daemon, port: Path) -> None:
    with Remote(port) as remote:
        wait_heard(small)
        remote.type("right_y=0.5")
        eventually(lambda: "right_y = 0.500" in small.must("modules"), "the stick is heard")
        remote.type("right_y=1.5")  # beyond its travel
        remote.type("left_x=-1")
        eventually(lambda: "left_x = -1.000" in small.must("modules"), "the other is heard")
        assert "right_y = 0.500" in small.must("modules")


@pytest.mark.usefixtures("no_route")
def test_what_its_page_shows_leads_to_a_mission(port: Path, tmp_path: Path) -> None:
    (block,) = blocks_run_by("tests/host/test_small_robot.py", EXAMPLE / "README.md")
    *start, remote, program = (command.text for command in commands(block))
    (tmp_path / "small.yaml").write_text(robot(port))
    with Reader(tmp_path) as reader:
        reader.replace |= {
            "$(mktemp -d)": str(reader.run_dir),
            "examples/small_robot/robot.yaml": "small.yaml",
        }
        reader.read(Block("sh", "\n".join(start)))

        def terminal(text: str) -> Terminal:
            return Terminal(["bash", "-ec", reader.script(f"exec {text}")], reader.env())

        with terminal(f"{remote} {port}") as person, terminal(program) as robot_program:
            person.see("type up, down, off, on or right_y=0.5")
            reader.wait_printed("rc10ctl modules", "left_switch = -1")
            person.type("up")
            robot_program.see("WAIT_ARMED -> DRIVE")
            person.type("off")
            robot_program.see("-> SAFE: the remote is lost")


@pytest.mark.parametrize("language", PROGRAMS)
def test_shots_that_the_feeder_forgot_are_asked_for_again(small: Daemon, language: str) -> None:
    with (
        program(language, "--no-remote") as robot,
        rc10.connect("small", client="thief", priority=1) as thief,
    ):
        feeder = thief.module("feeder")
        robot.wait_line("^AIM -> FIRE$", MISSION_S)
        # Somebody else has the feeder for a moment: what was asked of it is forgotten.
        for _ in thief.rate(50):
            feeder.send(velocity_rpm=0.0)
            with contextlib.suppress(rc10.NotReceived):
                if feeder.state.owner == "thief":
                    break
        robot.wait_line("^FIRE -> DONE$", MISSION_S)
        assert robot.wait() == 0, robot.output
    state = small.wait_motor("feeder_wheel", lambda m: abs(m["velocity_rpm"]) < 1, "rests")
    assert state["total_angle_deg"] > 100


@pytest.mark.parametrize("language", PROGRAMS)
def test_an_emergency_stop_ends_the_mission(small: Daemon, language: str) -> None:
    with program(language, "--no-remote") as robot:
        robot.wait_line("^WAIT_ARMED -> DRIVE$")
        small.must("estop")
        robot.wait_line("-> SAFE: the robot is in ESTOP$")
        assert robot.wait() == 1
