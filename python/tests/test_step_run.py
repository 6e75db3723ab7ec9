"""A step on a robot: what it sends, what it refuses, and how it leaves."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import pytest

import rc10
from fake_daemon import FakeDaemon, setpoints
from rc10.lcm_types import command_t, event_t, motor_state_t, robot_state_t, setpoint_t
from rc10.plot.figure import save_png
from rc10.step.figure import figure_of
from rc10.step.plan import StepPlan
from rc10.step.run import StepFailed, StepResult, run_step
from rc10.step.table import text_of
from virtual_link import VirtualLink

TAU_S = 0.05


class LaggingDaemon(FakeDaemon):
    """Its wheel follows every target with a delay of the first order."""

    owner = ""
    zeroed = True
    limits = 0
    fault = False
    # Commands that are not in force any more.
    lapsed = 0
    stop_cause = motor_state_t.STOP_NONE
    # The values stay when the target is gone: nothing turns it back.
    velocity_rpm = 0.0
    total_angle_deg = 370.0
    current_a = 0.0

    def target(self) -> tuple[int, float]:
        if len(self.commands) <= self.lapsed or "wheel" not in self.active:
            return 0, 0.0
        return setpoints(self.commands[-1])["wheel"]

    def state(self) -> robot_state_t:
        message = super().state()
        wheel = message.motors[0]
        wheel.mode, wheel.target = self.target()
        wheel.owner = self.owner or (
            self.commands[-1].client if wheel.mode != setpoint_t.MODE_COAST else ""
        )
        self.follow(wheel.mode, wheel.target)
        wheel.velocity_rpm = self.velocity_rpm
        wheel.total_angle_deg = self.total_angle_deg
        wheel.angle_deg = self.total_angle_deg % 360
        wheel.current_a = self.current_a
        wheel.zeroed = self.zeroed
        wheel.limits = self.limits
        wheel.stop_cause = self.stop_cause if wheel.mode == setpoint_t.MODE_COAST else 0
        if self.fault:
            wheel.status, wheel.fault_text = motor_state_t.STATUS_FAULT, "stalled"
        return message

    def follow(self, mode: int, target: float) -> None:
        share = 1 - math.exp(-0.005 / TAU_S)
        if mode == setpoint_t.MODE_VELOCITY:
            self.velocity_rpm += share * (target - self.velocity_rpm)
        elif mode == setpoint_t.MODE_TOTAL_ANGLE:
            self.total_angle_deg += share * (target - self.total_angle_deg)
        elif mode == setpoint_t.MODE_ANGLE:
            way = (target - self.total_angle_deg + 180) % 360 - 180
            self.total_angle_deg += share * way
        elif mode == setpoint_t.MODE_CURRENT:
            self.current_a += share * (target - self.current_a)


@pytest.fixture
def daemon(link: VirtualLink) -> LaggingDaemon:
    daemon = LaggingDaemon("demo", link)
    daemon.publish_states()
    return daemon


def plan(mode: rc10.Mode = rc10.Mode.VELOCITY, value: float = 100, **more: object) -> StepPlan:
    return StepPlan("wheel", mode, value, **{"enable": True, **more})  # type: ignore[arg-type]


def values(commands: list[command_t]) -> list[float]:
    """The targets in their order, each once."""
    found: list[float] = []
    for command in commands:
        value = setpoints(command)["wheel"][1]
        if not found or found[-1] != value:
            found.append(value)
    return found


def test_a_step_of_the_velocity_is_measured_there_and_goes_back(
    robot: rc10.Robot, daemon: LaggingDaemon
) -> None:
    result = run_step(robot, plan())
    assert result.signal == "velocity_rpm"
    assert result.metrics.rise_time_s == pytest.approx(TAU_S * math.log(9), rel=0.02)
    assert result.metrics.settling_time_s == pytest.approx(TAU_S * math.log(50), abs=0.006)
    assert result.metrics.steady_error == pytest.approx(0, abs=0.01)
    assert result.missing == 0
    # There and back.
    assert values(daemon.commands) == [0, 100, 0]
    assert daemon.velocity_rpm < 10


@pytest.mark.usefixtures("daemon")
def test_the_time_is_zero_where_the_target_acts(robot: rc10.Robot) -> None:
    recording = run_step(robot, plan()).recording
    acts = recording["wheel.target"] == 100
    assert recording.time_s[acts.argmax()] == 0
    assert recording.time_s[0] < -0.2


def test_leaving_disables_what_it_enabled(link: VirtualLink, daemon: LaggingDaemon) -> None:
    with rc10.Robot("demo", link, client="tester", at_end="disable") as robot:
        run_step(robot, plan())
    assert daemon.operations() == ["enable wheel", "disable wheel"]


def test_ctrl_c_lets_go_at_once(link: VirtualLink, daemon: LaggingDaemon) -> None:
    def interrupt() -> None:
        raise KeyboardInterrupt

    link.after(0.5, interrupt)
    with (
        pytest.raises(KeyboardInterrupt),
        rc10.Robot("demo", link, client="tester", at_end="disable") as robot,
    ):
        run_step(robot, plan())
    assert daemon.operations() == ["enable wheel", "disable wheel"]
    assert values(daemon.commands)[:2] == [0, 100]


def test_a_motor_that_was_active_stays_so(link: VirtualLink, daemon: LaggingDaemon) -> None:
    daemon.active.add("wheel")
    with rc10.Robot("demo", link, client="tester") as robot:
        run_step(robot, plan(enable=False))
    assert daemon.operations() == []


def test_an_angle_goes_the_shortest_way(robot: rc10.Robot, daemon: LaggingDaemon) -> None:
    # It stands at 10 degrees, one turn on.
    result = run_step(robot, plan(rc10.Mode.ANGLE, 340))
    assert result.signal == "total_angle_deg"
    assert result.metrics.start == 370
    assert result.metrics.target == pytest.approx(340)
    assert result.metrics.rise_time_s == pytest.approx(TAU_S * math.log(9), rel=0.02)
    assert values(daemon.commands) == [10, 340, 10]


def test_an_angle_relative_to_where_it_stands(robot: rc10.Robot, daemon: LaggingDaemon) -> None:
    result = run_step(robot, plan(rc10.Mode.TOTAL_ANGLE, -90, relative=True))
    assert (result.metrics.start, result.metrics.target) == (370, 280)
    assert values(daemon.commands) == [370, 280, 370]


def test_a_current_steps_from_its_base(robot: rc10.Robot, daemon: LaggingDaemon) -> None:
    result = run_step(robot, plan(rc10.Mode.CURRENT, -1.5, base=0.5))
    assert result.signal == "current_a"
    assert values(daemon.commands) == [0.5, -1.5, 0.5]


@pytest.mark.parametrize(
    ("changes", "more", "message"),
    [
        ({}, {"enable": False}, r"wheel is READY: enable it first \(--enable does it\)"),
        ({"estopped": True}, {}, "ESTOP"),
        ({"fault": True}, {}, r"wheel is in FAULT \(stalled\)"),
        ({"owner": "remote"}, {}, "held by the client 'remote'"),
        ({"zeroed": False}, {"mode": rc10.Mode.ANGLE}, "no reference for angles"),
        ({}, {"mode": rc10.Mode.TOTAL_ANGLE, "value": 370.05}, "that is no step"),
        ({}, {"value": 0}, "from 0 to 0 is no step"),
        ({}, {"relative": True}, "a relative step is one of an angle"),
    ],
)
def test_it_refuses_before_anything_moves(
    robot: rc10.Robot,
    daemon: LaggingDaemon,
    changes: dict[str, object],
    more: dict[str, object],
    message: str,
) -> None:
    for name, value in changes.items():
        setattr(daemon, name, value)
    with pytest.raises(StepFailed, match=message):
        run_step(robot, plan(**more))  # type: ignore[arg-type]
    assert not daemon.commands


@pytest.mark.parametrize(
    ("attribute", "value", "message"),
    [
        ("limits", motor_state_t.LIMIT_VELOCITY, "limits the target 100 rpm: .*velocity_limit_rpm"),
        ("limits", motor_state_t.LIMIT_ANGLE, "a soft limit of the angle acts"),
        ("fault", True, "in FAULT"),
        ("estopped", True, "ESTOP"),
        ("owner", "remote", "held by the client 'remote'"),
    ],
)
def test_it_ends_when_something_happens(
    robot: rc10.Robot,
    daemon: LaggingDaemon,
    link: VirtualLink,
    attribute: str,
    value: object,
    message: str,
) -> None:
    link.after(0.5, lambda: setattr(daemon, attribute, value))
    with pytest.raises(StepFailed, match=message):
        run_step(robot, plan())


@pytest.mark.parametrize("after_s", [0.1, 0.5, 0.82])
def test_a_motor_that_was_stopped_and_enabled_between_two_states_is_not_driven_on(
    robot: rc10.Robot, daemon: LaggingDaemon, link: VirtualLink, after_s: float
) -> None:
    sent: list[int] = []

    def stop() -> None:
        sent.append(len(daemon.commands))
        daemon.publish_event(
            "ACTIVE -> READY (disabled by 'panel')", code=100, mono_us=round(link.now() * 1e6)
        )

    link.after(after_s, stop)
    with pytest.raises(StepFailed, match=r"wheel: ACTIVE -> READY \(disabled by 'panel'\)"):
        run_step(robot, plan(seconds=0.5))
    link.pump(0.0)
    # Before the step, in it, and on the way back.
    assert values(daemon.commands) == {0.1: [0], 0.5: [0, 100], 0.82: [0, 100, 0]}[after_s]
    assert [len(daemon.commands)] == sent


def stand(daemon: LaggingDaemon, link: VirtualLink, cause: int) -> None:
    """The program stands still for longer than its last target holds."""
    daemon.lapsed, daemon.stop_cause = len(daemon.commands), cause
    link.pass_time(2.0)


@pytest.mark.parametrize("after_s", [0.1, 0.5, 0.82])
def test_a_motor_that_was_enabled_anew_while_the_program_stood_is_not_driven_on(
    robot: rc10.Robot, daemon: LaggingDaemon, link: VirtualLink, after_s: float
) -> None:
    link.after(after_s, lambda: stand(daemon, link, motor_state_t.STOP_NONE))
    with pytest.raises(StepFailed, match="wheel was enabled anew while this program stood still"):
        run_step(robot, plan(seconds=0.5))
    link.pump(0.0)
    assert len(daemon.commands) == daemon.lapsed


def test_a_pause_in_which_nobody_stopped_the_motor_does_not_end_the_step(
    robot: rc10.Robot, daemon: LaggingDaemon, link: VirtualLink
) -> None:
    link.after(0.5, lambda: stand(daemon, link, motor_state_t.STOP_TIMEOUT))
    assert run_step(robot, plan(seconds=4.0)).missing > 0
    assert values(daemon.commands) == [0, 100, 0]


def test_another_client_ends_it_before_the_target_has_acted(
    robot: rc10.Robot, daemon: LaggingDaemon, link: VirtualLink
) -> None:
    daemon.target = lambda: (0, 0.0)  # type: ignore[method-assign]
    sent: list[int] = []

    def take() -> None:
        daemon.owner = "remote"
        sent.append(len(daemon.commands))

    link.after(0.1, take)
    with pytest.raises(StepFailed, match="held by the client 'remote'"):
        run_step(robot, plan())
    link.pump(0.0)
    assert [len(daemon.commands)] == sent


def test_a_lost_reference_ends_it_in_words(
    robot: rc10.Robot, daemon: LaggingDaemon, link: VirtualLink
) -> None:
    link.after(0.5, lambda: setattr(daemon, "zeroed", False))
    with pytest.raises(StepFailed, match="no reference for angles"):
        run_step(robot, plan(rc10.Mode.TOTAL_ANGLE, 90, relative=True))


def test_a_reference_is_of_angles_alone(
    robot: rc10.Robot, daemon: LaggingDaemon, link: VirtualLink
) -> None:
    link.after(0.5, lambda: setattr(daemon, "zeroed", False))
    assert run_step(robot, plan()).missing == 0


@pytest.mark.parametrize("tolerance", [0.0, -0.02, 1.0, math.nan])
def test_a_tolerance_that_is_none_is_refused_before_anything_moves(tolerance: float) -> None:
    with pytest.raises(ValueError, match="is not between 0 and 100 %"):
        plan(tolerance=tolerance)


def step_tool(*words: str) -> subprocess.CompletedProcess[str]:
    """The tool itself, with a provider that nobody hears."""
    return subprocess.run(
        [sys.executable, "-m", "rc10.step", "wheel", "velocity", "100", "--url", "memq://", *words],
        capture_output=True,
        text=True,
        check=False,
    )


def test_the_tool_refuses_a_tolerance_as_bad_usage() -> None:
    done = step_tool("--settle-percent", "0")
    assert done.returncode == 2
    assert "0 % is not between 0 and 100 %" in done.stderr


@pytest.mark.parametrize("option", ["--csv", "--png"])
def test_a_file_that_cannot_be_written_is_refused_before_the_robot_is_looked_for(
    tmp_path: Path, option: str
) -> None:
    for file, reason in ((tmp_path / "no" / "step", "no such folder"), (tmp_path, "directory")):
        done = step_tool(option, str(file))
        assert done.returncode == 1
        assert reason in done.stderr
    assert not list(tmp_path.iterdir())


def test_what_rc10d_says_about_a_target_is_told(
    robot: rc10.Robot, daemon: LaggingDaemon, link: VirtualLink
) -> None:
    def skip() -> None:
        daemon.owner = ""
        daemon.commands.clear()
        message = event_t()
        message.code, message.source = 103, "wheel"
        message.text = "first target too far away"
        link.publish(daemon.channel("event"), message.encode())

    for tenth in range(1, 30):
        link.after(tenth * 0.01, skip)
    daemon.target = lambda: (0, 0.0)  # type: ignore[method-assign]
    with pytest.raises(StepFailed, match="did not take the target: first target too far away"):
        run_step(robot, plan())


def test_silence_ends_it(robot: rc10.Robot, daemon: LaggingDaemon, link: VirtualLink) -> None:
    def fall_silent() -> None:
        daemon.publish_states = lambda *_: None  # type: ignore[method-assign]

    link.after(0.5, fall_silent)
    with pytest.raises(rc10.Timeout, match="no state of the robot for a second"):
        run_step(robot, plan())


@pytest.mark.parametrize(
    ("more", "message"),
    [
        ({"mode": rc10.Mode.DUTY}, "duty: no step of this mode; there are: velocity, angle"),
        ({"seconds": 0.0}, "0.05 to 60 s"),
    ],
)
def test_a_plan_that_makes_no_sense(more: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        plan(**more)  # type: ignore[arg-type]


@pytest.fixture
def result(robot: rc10.Robot, daemon: LaggingDaemon) -> StepResult:
    daemon.limits = motor_state_t.LIMIT_CURRENT
    return run_step(robot, plan())


def test_the_table_has_figures_and_limits(result: StepResult) -> None:
    text = text_of(result)
    assert text.startswith("demo, wheel: velocity from 0 to 100 rpm\n")
    assert "  rise time (10-90 %)   0.11" in text
    assert "  limits that acted     current (100% of the time)" in text


def test_the_figure_has_velocity_and_current(result: StepResult, tmp_path: Path) -> None:
    figure = figure_of(result)
    assert [axes.get_ylabel() for axes in figure.axes] == ["velocity (rpm)", "current (A)"]
    save_png(figure, tmp_path / "step.png")
    assert (tmp_path / "step.png").stat().st_size > 5000
