"""rc10ctl test-motion: steps, ramps and sines on simulated motors, and each of their ends."""

from __future__ import annotations

import csv
import json
import shlex
import signal
import sys
import time
from typing import TYPE_CHECKING, Any

import pytest
from hostlib import Daemon, Program
from hostlib.daemon import ARM, BIN, REPO
from hostlib.page import Block, blocks_run_by, robots, run
from hostlib.stalls import stood_still_since

from rc10.motion_test import MotionAborted, run_motion_test

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from hostlib import Motor

# As docs/tuning.md has it; its feedback may be as old as a busy machine makes it. No current passes
# the limit of a step, whatever a late tick demands.
ROBOT = (
    ARM
    + """
      - {name: wheel, model: M3508, id: 1, zero: power_on, feedback_timeout_ms: 1000,
         current_limit_a: 10, simulated: {inertia_kg_m2: 0.01}}
      - {name: lift, model: M3508, id: 2, zero: power_on, feedback_timeout_ms: 1000,
         on_timeout: hold, current_limit_a: 10, simulated: {inertia_kg_m2: 0.01}}
  - name: joint
    type: sim
    motors:
      - {name: elbow, model: DM4310, id: 2, master_id: 18, feedback_timeout_ms: 1000,
         watchdog_ms: 2000,
         simulated: {inertia_kg_m2: 0.01}}
"""
)
# A pause of the machine is no old feedback.
PATIENT = ("--max-feedback-age", "2s", "--dead-man-ms", 1000)
# While rc10d stands still, the drive obeys its last command.
ROOM = ("--max-speed", 1000, *PATIENT)
STEP = ("step", 60, "--max-current", 12, *ROOM)
LONG = (*STEP, "--for", "60s")
TIMES = 5


@pytest.fixture(autouse=True)
def _enabled(robot: Daemon) -> None:
    stand_still(robot)
    robot.must("clear")
    robot.must("enable", "wheel", "lift", "elbow")


def stand_still(robot: Daemon) -> None:
    # An e-stop is not cleared before, and a wheel that still turns is not moved by a test.
    robot.wait_motors(lambda motor: abs(float(motor["velocity_rpm"])) < 1.0, "all stand still")


def result_of(robot: Daemon, *words: str | float | Path) -> dict[str, Any]:
    """The result of a test that must reach its end: a standing machine makes it begin anew."""
    for _ in range(TIMES):
        begin_s = time.monotonic()
        done = robot.ctl("test-motion", *words, "--json")
        if done.returncode == 0:
            break
        assert "too busy to renew it" in done.stderr, done.stdout + done.stderr
        assert stood_still_since(begin_s, "a test of motion"), done.stderr
        stand_still(robot)
    result: dict[str, Any] = json.loads(done.stdout)
    assert result["abort"] is None
    return result


def aborted(robot: Daemon, *words: str | float) -> tuple[dict[str, Any], str]:
    """The abort of a test that must fail, and the words on stderr."""
    done = robot.ctl("test-motion", *words, "--json")
    assert done.returncode == 1, done.stdout
    result = json.loads(done.stdout)
    assert done.stderr == f"rc10ctl: {result['error']}\n"
    return result["abort"], done.stderr


def without_torque(motor: Motor) -> bool:
    return {"owner": "", "acting": "nothing", "command_value": 0}.items() <= motor.items()


def test_a_step_of_a_dji_motor_has_its_numbers_and_its_curve(robot: Daemon, tmp_path: Path) -> None:
    table = tmp_path / "step.csv"
    step = result_of(robot, "wheel", *STEP, "--csv", table)
    numbers = step["step"]
    # Their quality depends on the machine here; tests/client has systems with known answers.
    assert numbers["rise_s"] > 0.0
    assert numbers["overshoot_percent"] == pytest.approx(
        100.0 * max(0.0, numbers["peak"] / 60.0 - 1.0)
    )
    assert "current" in step["limits"]
    with table.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == step["ticks"] > 1000
    assert float(rows[-1]["target"]) == 60.0
    after = [float(row["velocity_rpm"]) for row in rows if float(row["target"]) == 60.0]
    assert max(after) == pytest.approx(numbers["peak"], rel=1e-6)
    robot.wait_motor("wheel", without_torque, "coasts")


def test_an_angle_of_a_damiao_joint_steps_from_where_it_stands(robot: Daemon) -> None:
    words = ("--mode", "total_angle", "--max-current", 100, "--max-angle", 90, "--min-angle", -90)
    for _ in range(2):
        step = result_of(robot, "elbow", "step", 20, *words, *ROOM)
        assert step["step"]["peak"] == pytest.approx(step["origin"] + 20.0, abs=10.0)
        assert step["unit"] == "deg"


def test_a_ramp_is_followed_with_an_error(robot: Daemon) -> None:
    words = ("ramp", -60, "--rate", 60, "--for", "2s", "--max-current", 12, *ROOM)
    ramp = result_of(robot, "wheel", *words)
    assert ramp["step"] is None
    assert 0.0 < ramp["following_error"]["rms"] < ramp["following_error"]["max"]


@pytest.mark.parametrize("kind", ["sweep", "multisine"])
def test_sines_give_the_bandwidth_and_a_bode_table(
    robot: Daemon, tmp_path: Path, kind: str
) -> None:
    table = tmp_path / "bode.csv"
    sines = ("--base", 60, "--max-current", 12, "--bode", table, *ROOM)
    found = result_of(robot, "wheel", kind, 20, *sines)
    points = found["response"]
    frequencies = [point["frequency_hz"] for point in points]
    assert frequencies[0] == pytest.approx(1.0)
    # A busy computer leaves ticks out, and with them the last frequencies.
    assert 10.0 < frequencies[-1] < 20.1
    assert 10 < len(points) <= (20 if kind == "multisine" else 39)
    assert all(0.0 <= point["coherence"] <= 1.0 + 1e-9 for point in points)
    assert {"bandwidth_hz", "phase_margin_deg", "gain_margin_db"} <= found.keys()
    assert len(table.read_text().splitlines()) == len(points) + 1


def test_the_numbers_are_printed_for_a_person(robot: Daemon) -> None:
    told = robot.must("test-motion", "wheel", *STEP)
    assert told.startswith("wheel: velocity, step of 60.00 rpm\n")
    for name in ("rise (10 to 90 %)", "overshoot", "settling (to 2 %)", "following error"):
        assert f"\n{name} " in told
    assert told.endswith("wheel coasts\n")


@pytest.mark.parametrize(
    ("words", "criterion", "limit", "remedy"),
    [
        (("--max-angle", 20), "angle", 20, "wider corridor"),
        (("--max-speed", 60.5), "velocity", 60.5, "higher limit of the speed"),
        (("--max-current", 2), "current", 2, "higher limit of the current"),
        (("--stop-at-limits",), "limit", None, "(current): a smaller amplitude"),
    ],
)
def test_each_bound_ends_the_test_and_lets_the_motor_go(
    robot: Daemon, words: tuple[str | float, ...], criterion: str, limit: float, remedy: str
) -> None:
    room = {"--max-current": 12, "--max-speed": 1000}
    rest = [word for name, most in room.items() if name not in words for word in (name, most)]
    abort, told = aborted(robot, "wheel", "step", 60, *PATIENT, *rest, *words)
    assert abort["criterion"] == criterion
    assert abort["limit"] == limit
    if limit is not None:
        assert abort["value"] > limit
    assert f"test of wheel ended by {criterion} after " in told
    assert remedy in told
    assert "; wheel coasts" in told
    robot.wait_motor("wheel", without_torque, "coasts")


def test_the_end_is_the_on_timeout_of_the_motor(robot: Daemon) -> None:
    _, told = aborted(robot, "lift", "step", 60, *ROOM, "--max-current", 2)
    assert "; lift holds its place (on_timeout)" in told
    robot.wait_motor(
        "lift", lambda motor: motor["acting"] == "hold" and motor["owner"] == "", "is held"
    )


def ended_by(
    robot: Daemon, disturb: Callable[[Program], object], patience: tuple[str | float, ...] = ROOM
) -> str:
    """The output of test-motion when this is done while the wheel turns."""
    words: tuple[str | float, ...] = ("step", 60, "--max-current", 12, "--for", "60s", *patience)
    with robot.drive("test-motion", "wheel", *words) as test:
        robot.wait_motor("wheel", lambda motor: float(motor["velocity_rpm"]) > 50.0, "turns")
        disturb(test)
        assert test.wait() == 1
        return test.output


def test_another_client_that_takes_the_motor_is_named(robot: Daemon) -> None:
    def take_over(_: Program) -> None:
        robot.must("set", "wheel", "velocity", 30, "--for", "1s", "--priority", 1)

    told = ended_by(robot, take_over)
    assert "ended by ownership after " in told


def test_an_estop_in_the_first_instants_of_a_test_is_told_as_one(robot: Daemon) -> None:
    for _ in range(3):
        robot.must("enable", "wheel")
        with robot.drive("test-motion", "wheel", *STEP) as test:
            robot.must("estop")
            assert test.wait() == 1
            assert "ended by status" in test.output
            assert "the robot is in ESTOP" in test.output
        robot.must("clear")


def test_a_motor_that_is_disabled_ends_the_test(robot: Daemon) -> None:
    told = ended_by(robot, lambda _: robot.must("disable", "wheel"))
    assert "ended by status after " in told
    assert "motor 'wheel' is READY: `rc10ctl enable wheel`" in told


def test_an_estop_ends_the_test(robot: Daemon) -> None:
    told = ended_by(robot, lambda _: robot.must("estop"))
    assert "ended by status after " in told
    assert "the robot is in ESTOP" in told
    # Not cleared before.
    robot.wait_motor("wheel", lambda motor: motor["velocity_rpm"] == 0, "stands")


def test_ctrl_c_ends_the_test_and_lets_the_motor_go(robot: Daemon) -> None:
    told = ended_by(robot, lambda test: test.signal(signal.SIGINT))
    assert "ended by interrupted after " in told
    robot.wait_motor("wheel", without_torque, "coasts")


def test_a_test_that_is_killed_leaves_no_torque(robot: Daemon) -> None:
    with robot.drive("test-motion", "wheel", *(str(word) for word in LONG)) as test:
        robot.wait_motor("wheel", lambda motor: float(motor["velocity_rpm"]) > 50.0, "turns")
        test.signal(signal.SIGKILL)
        test.wait()
    robot.wait_motor("wheel", without_torque, "coasts")


def test_a_test_whose_stdin_is_closed_does_not_begin(robot: Daemon) -> None:
    abort, told = aborted(robot, "wheel", *LONG, "--end-with-stdin")
    assert abort["criterion"] == "interrupted"
    assert "the program that runs it has ended (--end-with-stdin)" in told
    assert robot.state()["motors"][0]["owner"] == ""


def test_feedback_that_grows_old_ends_the_test(robot: Daemon) -> None:
    try:
        told = ended_by(
            robot,
            lambda _: robot.program.signal(signal.SIGSTOP),
            ("--max-speed", 1000, "--max-feedback-age", "500ms", "--dead-man-ms", 1000),
        )
    finally:
        robot.program.signal(signal.SIGCONT)
    assert "ended by feedback_age after " in told
    assert "ms beyond 500.00 ms: check the wiring" in told
    robot.wait_motor("wheel", without_torque, "coasts")


def test_the_end_of_rc10d_ends_the_test() -> None:
    with Daemon(ROBOT) as daemon:
        daemon.wait_ready()
        daemon.must("enable", "wheel")
        told = ended_by(daemon, lambda _: daemon.kill())
        assert "ended by connection after " in told
        assert "rc10d has ended" in told


def test_a_motor_that_is_not_active_is_not_moved(robot: Daemon) -> None:
    robot.must("disable", "wheel")
    abort, told = aborted(robot, "wheel", *STEP)
    assert abort["criterion"] == "status"
    assert "`rc10ctl enable wheel`" in told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("wheel", "step", 60), "--max-current"),
        (("wheel", "step", 60, "--max-current", 0), "current has no limit"),
        (("wheel", "step", 60, "--max-current", 2, "--max-speed", 30), "beyond its limits"),
        (("wheel", "step", 1, "--max-current", 2, "--mode", "current"), "needs --max-speed"),
        (("wheel", "step", 1, "--max-current", 2, "--mode", "duty"), "--mode"),
        (("wheel", "ramp", 60, "--max-current", 2), "needs a rate"),
        (("wheel", "step", 60, "--max-current", 2, "--rate", 5), "is for a ramp"),
        (("wheel", "sweep", 20, "--max-current", 2, "--to", 90), "0.05 to 50 Hz"),
        (("wheel", "wave", 20, "--max-current", 2), "step"),
    ],
)
def test_a_test_without_sense_is_refused_before_anything_moves(
    robot: Daemon, words: tuple[str | float, ...], told: str
) -> None:
    done = robot.ctl("test-motion", *words)
    assert done.returncode == 2
    assert told in done.stderr


def test_a_file_that_cannot_be_written_is_named_before_anything_moves(robot: Daemon) -> None:
    done = robot.ctl("test-motion", "wheel", *STEP, "--csv", "/nowhere/step.csv")
    assert done.returncode == 1
    assert "/nowhere/step.csv cannot be written" in done.stderr
    assert robot.state()["motors"][0]["owner"] == ""


def patient_blocks(page: str) -> list[Block]:
    """The words of a page, for a machine that pauses."""
    found = blocks_run_by("tests/host/test_motion.py", REPO / "docs" / page)
    for bound, patience in (
        (
            "--max-current",
            "--dead-man-ms 1000 --max-feedback-age 2s --max-speed 1000 --max-current",
        ),
        (
            "max_current_a",
            "dead_man_ms=1000, max_feedback_age_s=2, max_speed_rpm=1000, max_current_a",
        ),
    ):
        found = [block._replace(text=block.text.replace(bound, patience)) for block in found]
    return found


def test_the_pages_show_what_runs(robot: Daemon, tmp_path: Path) -> None:
    for block in patient_blocks("python.md"):
        run(block, robot, tmp_path)
    (block,) = patient_blocks("rc10ctl.md")
    command, *shown = block.text.removeprefix("$ ").splitlines()
    told = robot.must(*shlex.split(command)[1:-1], tmp_path / "step.csv")
    assert [line[:22] for line in told.splitlines()] == [line[:22] for line in shown]


@pytest.mark.parametrize("page", ["tuning.md", "tuning.zh-CN.md"])
def test_the_page_on_tuning_shows_what_runs(page: str, tmp_path: Path) -> None:
    (config,) = robots(REPO / "docs" / page)
    with Daemon(config) as daemon:
        daemon.wait_ready()
        for block in patient_blocks(page):
            run(block, daemon, tmp_path)
    assert (tmp_path / "bode.csv").exists()


@pytest.fixture
def program(robot: Daemon, monkeypatch: pytest.MonkeyPatch) -> str:
    """Path of rc10ctl, in the robot's environment."""
    for name, value in robot.env.items():
        monkeypatch.setenv(name, value)
    return str(BIN / "rc10ctl")


def test_python_runs_the_same_test(program: str) -> None:
    result = run_motion_test(
        "wheel",
        "step",
        60,
        max_current_a=12,
        max_feedback_age_s=2,
        dead_man_ms=1000,
        program=program,
    )
    assert result.step is not None
    assert result.step.peak > 50.0
    assert result.following_error_rms > 0.0
    assert len(result.curve["time_s"]) == result.ticks


def test_python_raises_the_criterion(program: str) -> None:
    with pytest.raises(MotionAborted, match="higher limit of the current") as raised:
        run_motion_test(
            "wheel",
            "step",
            60,
            max_current_a=2,
            max_feedback_age_s=2,
            dead_man_ms=1000,
            program=program,
        )
    assert raised.value.criterion == "current"
    assert raised.value.value > raised.value.limit == 2.0


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_python_program_that_is_killed_ends_its_test_of_motion(
    robot: Daemon, program: str, number: signal.Signals
) -> None:
    code = (
        "from rc10.motion_test import run_motion_test\n"
        "run_motion_test('wheel', 'step', 60, max_current_a=12, max_speed_rpm=1000, seconds=60,"
        f" max_feedback_age_s=2, dead_man_ms=1000, program={program!r})"
    )
    with Program(sys.executable, "-c", code) as caller:
        robot.wait_motor("wheel", lambda motor: float(motor["velocity_rpm"]) > 50.0, "turns")
        caller.signal(number)  # to it alone, not to its group
        robot.wait_motor("wheel", without_torque, "coasts")
