"""A simulated shaft has gravity, end stops and a load that changes, and a hand turns it."""

from __future__ import annotations

import time
from collections.abc import Iterator

import pytest
from hostlib import Daemon
from hostlib.daemon import ARM, REPO, Motor
from hostlib.page import blocks_run_by, robots
from hostlib.stalls import stood_still_since

import rc10

TRIES = 5

# Hangs at -90 degrees; its lower stop lies 30 degrees away: gravity pulls with half of its 0.3 N m.
SHOULDER = (
    ARM
    + """
      - name: shoulder
        model: M3508
        id: 1
        feedback_timeout_ms: 1000
        on_disable: coast
        angle_min_deg: 0
        angle_max_deg: 100
        simulated: {gravity_nm: 0.3, hangs_at_deg: -90, stop_min_deg: -60, stop_max_deg: 120,
                    inertia_kg_m2: 0.02, initial_angle_deg: -20}
modules:
  - {name: lift, type: joint, motor: shoulder, max_velocity_deg_s: 90, max_acceleration_deg_s2: 360,
     homing: stop, homing_velocity_rpm: -10, homing_current_a: 2}
"""
)


def test_a_joint_homes_at_the_stop_of_its_simulated_shaft() -> None:
    with Daemon(SHOULDER) as daemon:
        daemon.wait_ready()
        daemon.must("enable", "shoulder")
        with daemon.drive("signal", "lift", "home=1", "--for", "60s"):
            daemon.wait_motor(
                "shoulder",
                lambda motor: motor["zeroed"] and abs(float(motor["total_angle_deg"])) < 10.0,
                "has found the stop",
            )
        with daemon.drive("signal", "lift", "angle_deg=60", "--for", "60s"):
            shoulder = daemon.wait_motor(
                "shoulder",
                lambda motor: abs(float(motor["total_angle_deg"]) - 60.0) < 1.0,
                "moves up against gravity",
            )
            assert float(shoulder["current_a"]) > 0.0
        daemon.must("disable", "shoulder")
        # It falls, and the stop catches it: where the joint found 0.
        daemon.wait_motor(
            "shoulder",
            lambda motor: abs(float(motor["total_angle_deg"])) < 1.0 and motor["velocity_rpm"] == 0,
            "lies on its stop",
        )


# The second is mounted the other way round.
WHEELS = (
    ARM
    + """
      - {name: left, model: M3508, id: 1, zero: power_on, feedback_timeout_ms: 1000}
      - {name: right, model: M3508, id: 2, direction: -1, zero: power_on, feedback_timeout_ms: 1000}
"""
)


@pytest.fixture(scope="module")
def wheels() -> Iterator[Daemon]:
    with Daemon(WHEELS) as daemon:
        daemon.wait_ready()
        yield daemon


def angle(daemon: Daemon, motor: str) -> float:
    return float(daemon.wait_motor(motor, lambda _: True, "is there")["total_angle_deg"])


def end_of_the_hand(daemon: Daemon, motor: str, *options: str | float) -> float:
    """The angle of a motor when a hand that turns it by 60 degrees is about to let go."""
    done = daemon.ctl("hand", motor, "--by", 60, *options)
    assert done.returncode == 0, done.stderr
    return float(done.stdout.split(" -> ")[1].removesuffix(" deg\n"))


@pytest.mark.parametrize("motor", ["left", "right"])
def test_a_hand_turns_a_shaft_by_the_angle_that_its_motor_reports(motor: str) -> None:
    with Daemon(WHEELS) as daemon:
        daemon.wait_ready()
        done = daemon.ctl("hand", motor, "--by", 90, "--rpm", 120)
        assert done.returncode == 0, done.stderr
        assert done.stdout.startswith(f"hand: turns {motor}\n{motor}: 0.0 deg -> ")
        assert angle(daemon, motor) == pytest.approx(90, abs=3)
        daemon.must("hand", motor, "--to", -45, "--rpm", 120)
        assert angle(daemon, motor) == pytest.approx(-45, abs=3)


def test_a_motor_that_holds_wins_against_a_weak_hand_and_loses_against_a_strong_one() -> None:
    with Daemon(WHEELS) as daemon:
        daemon.wait_ready()
        daemon.must("enable", "left")
        with daemon.drive("set", "left", "total_angle", "0", "--for", "60s"):
            daemon.wait_motor("left", lambda motor: motor["mode"] == "total_angle", "holds")
            assert abs(end_of_the_hand(daemon, "left", "--torque", 0.5)) < 10
            assert end_of_the_hand(daemon, "left", "--torque", 30) > 40


def test_a_program_turns_a_shaft_once_for_each_request() -> None:
    with Daemon(WHEELS) as daemon, rc10.connect("host") as robot:
        robot.wait_for_state()
        robot.request("hand", "left", {"by_deg": 30, "speed_rpm": 120})
        daemon.wait_motor(
            "left", lambda motor: abs(float(motor["total_angle_deg"]) - 30) < 3, "was turned"
        )
        with pytest.raises(rc10.RequestRefused, match=r"speed_rpm: 0 is out of range; use 0\.1"):
            robot.request("hand", "left", {"speed_rpm": 0})


def commands_of(page: str) -> list[list[str]]:
    """The rc10ctl lines of a page that are marked as run here."""
    lines = [
        line.removeprefix("$ ").split("#")[0]
        for block in blocks_run_by("tests/host/test_simulated_shafts.py", REPO / "docs" / page)
        for line in block.text.splitlines()
    ]
    return [line.split()[1:] for line in lines if line.startswith("rc10ctl ")]


def test_the_joint_of_modules_md_does_what_the_page_says() -> None:
    [robot] = [
        text for text in robots(REPO / "docs" / "modules.md") if text.startswith("robot: arm")
    ]
    with Daemon(robot.replace("id: 1", "id: 1\n        feedback_timeout_ms: 1000", 1)) as daemon:
        daemon.wait_ready()
        enable, home, move, disable = commands_of("modules.md")
        daemon.must(*enable)
        # A pause of the computer leaves a gap in the inputs, which ends a homing.
        for _ in range(TRIES):
            begin_s = time.monotonic()
            result = daemon.must(*home)
            if "homed = 1.000" in result or not stood_still_since(begin_s, "a homing"):
                break
        assert "homed = 1.000" in result
        assert "move = 2.000" in daemon.must(*move)
        daemon.must(*disable)
        daemon.wait_motor(
            "shoulder",
            lambda motor: abs(float(motor["total_angle_deg"])) < 1.0 and motor["velocity_rpm"] == 0,
            "has fallen onto its stop",
        )


def test_the_hand_of_rc10ctl_md_does_what_the_page_says() -> None:
    with Daemon(WHEELS.replace("left", "wheel")) as daemon:
        daemon.wait_ready()
        [words, *_] = commands_of("rc10ctl.md")
        daemon.must(*words)
        assert angle(daemon, "wheel") == pytest.approx(360, abs=3)


def test_the_loads_of_rc10ctl_md_are_answered_as_the_page_says() -> None:
    page = REPO / "docs" / "rc10ctl.md"
    shown = blocks_run_by("tests/host/test_simulated_shafts.py", page)[-1].text.splitlines()
    with Daemon(WHEELS.replace("left", "wheel")) as daemon:
        daemon.wait_ready()
        for command, answer in zip(shown[::2], shown[1::2], strict=True):
            assert daemon.must(*command.split()[2:]) == f"{answer}\n"


# Level at 0, so that a payload pulls with all of its torque: 0.5 kg at 0.2 m are 3.3 A.
LEVEL_ARM = (
    ARM
    + """
      - name: shoulder
        model: M3508
        id: 1
        zero: power_on
        feedback_timeout_ms: 1000
        simulated: {hangs_at_deg: -90, payload_at_m: 0.2, coulomb_nm: 0.1,
                    inertia_kg_m2: 0.02CHANGES}
"""
)


def current(motor: Motor) -> float:
    return float(motor["current_a"])


def test_a_motor_that_holds_carries_what_its_arm_picks_up_until_it_is_put_down() -> None:
    with Daemon(LEVEL_ARM.replace("CHANGES", "")) as daemon:
        daemon.wait_ready()
        daemon.must("enable", "shoulder")
        with daemon.drive("set", "shoulder", "total_angle", "0", "--for", "60s"):
            daemon.wait_motor("shoulder", lambda m: m["mode"] == "total_angle", "holds")
            daemon.must("load", "shoulder", "payload_kg=0.5")
            daemon.wait_motor("shoulder", lambda m: current(m) > 2.8, "carries")
            daemon.must("load", "shoulder", "--reset")
            daemon.wait_motor("shoulder", lambda m: abs(current(m)) < 0.6, "carries nothing")


def test_the_load_of_a_file_changes_by_itself() -> None:
    changes = ", changes: [{after_s: 0.5, payload_kg: 0.5}], changes_repeat_s: 1.5"
    with Daemon(LEVEL_ARM.replace("CHANGES", changes)) as daemon:
        daemon.wait_ready()
        daemon.must("enable", "shoulder")
        with daemon.drive("set", "shoulder", "total_angle", "0", "--for", "60s"):
            for _ in range(2):
                daemon.wait_motor("shoulder", lambda m: current(m) > 2.8, "carries")
                daemon.wait_motor("shoulder", lambda m: abs(current(m)) < 0.6, "carries nothing")


@pytest.mark.parametrize(
    ("words", "status", "answer"),
    [
        (["coulomb_nm=-1"], 1, "load: coulomb_nm: -1 is below 0 N m; use 0 to 100"),
        (["coulomb=1"], 1, "did you mean coulomb_nm?"),
        (["payload_kg=1"], 1, "has no arm to hang on; give payload_at_m too"),
        (["payload_kg"], 2, "payload_kg=0.5"),
        ([], 2, "load: say what changes, such as payload_kg=0.5, or --reset"),
        (["payload_kg=1", "--reset"], 2, "load: say what changes"),
    ],
)
def test_a_load_that_cannot_be_is_refused_in_words(
    wheels: Daemon, words: list[str], status: int, answer: str
) -> None:
    done = wheels.ctl("load", "left", *words)
    assert done.returncode == status
    assert answer in done.stderr
