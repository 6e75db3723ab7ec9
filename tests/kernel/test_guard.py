"""rc10d dies or hangs while a motor turns: rc10-guard has the last word, within 25 ms."""

from __future__ import annotations

import contextlib
import re
import signal
import subprocess
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from guestlib import Candump, Frame, Proc, link_add, link_delete, run, wait_for
from rig import (
    BIN,
    C6XX_COMMAND,
    COMMAND_IDS,
    CONFIG,
    MS,
    client,
    commands,
    currents,
    daemon,
    drive,
    fakes,
    wait_status,
)

import rc10

if TYPE_CHECKING:
    from collections.abc import Iterator

LIMIT_MS = 25
REST = (0, 0, 0, 0)


@pytest.fixture
def required(tmp_path: Path) -> Path:
    """The robot as one is used in a match."""
    path = tmp_path / "robot.yaml"
    text = CONFIG.read_text()
    assert "realtime: preferred" in text
    path.write_text(text.replace("realtime: preferred", "realtime: required"))
    return path


@contextlib.contextmanager
def driven(config: Path) -> Iterator[tuple[Proc, rc10.Robot, Candump]]:
    """rc10d with a motor that has a current."""
    with fakes(), daemon(config) as process, Candump("vcan0") as bus, client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        drive(robot, 0.3, left=rc10.velocity_rpm(100))
        yield process, robot, bus


def go_on(robot: rc10.Robot) -> None:
    """Clears the e-stop when the motors stand still, and enables."""
    wait_for(
        lambda: abs(robot.wait_for_state(5.0).motors["left"].velocity_rpm) < 1.0, 30.0, poll_s=0.1
    )
    robot.clear()
    robot.enable()


def guards() -> list[str]:
    done = subprocess.run(
        ["pgrep", "-x", "rc10-guard"], capture_output=True, text=True, check=False
    )
    return done.stdout.split()


def told(process: Proc) -> list[str]:
    return [line for line in process.output().splitlines() if line.startswith("rc10-guard: ")]


def rests(bus: Candump, number: int, since_ns: int) -> list[Frame]:
    frames = [f for f in commands(bus.frames(), number) if f.t_ns > since_ns]
    return [f for f in frames if currents(f) == REST]


def ms_to_rest(bus: Candump, since_ns: int) -> float:
    """Until every command id has its rest frame, from the last frame before it on."""
    wait_for(lambda: all(rests(bus, number, since_ns) for number in COMMAND_IDS), 5.0)
    return max(rests(bus, number, since_ns)[0].t_ns - since_ns for number in COMMAND_IDS) / MS


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSEGV, signal.SIGABRT])
def test_a_death_ends_in_rest(required: Path, number: signal.Signals) -> None:
    with driven(required) as (process, _, bus):
        assert any(currents(commands(bus.frames(), C6XX_COMMAND)[-1]))
        since_ns = time.time_ns()
        process.signal(number)
        assert process.wait(5.0) == -number
        assert ms_to_rest(bus, since_ns) < LIMIT_MS
        wait_for(lambda: not guards(), 5.0, "the end of the guard")
        bus.stop()
        for command in COMMAND_IDS:
            after = [f for f in commands(bus.frames(), command) if f.t_ns > since_ns]
            first = next(i for i, f in enumerate(after) if currents(f) == REST)
            # The first rest of motors that had no current may be rc10d's own.
            sent = [currents(f) for f in after[first:]]
            assert sent in ([REST] * 3, [REST] * 4)
        assert any("rc10d has died" in line for line in told(process))
        assert any("the rest frames are on the wire" in line for line in told(process))


def test_a_standstill_ends_in_rest_and_latches(required: Path) -> None:
    with driven(required) as (process, robot, bus):
        process.signal(signal.SIGSTOP)
        stopped_ns = time.time_ns()
        assert ms_to_rest(bus, stopped_ns) < LIMIT_MS
        time.sleep(0.1)
        process.signal(signal.SIGCONT)
        going_ns = time.time_ns()
        wait_for(lambda: robot.wait_for_state(5.0).status is rc10.RobotStatus.ESTOP, 5.0)
        time.sleep(0.1)
        assert robot.state is not None
        assert robot.state.stop_cause is rc10.StopCause.GUARD
        # A frame packed when it stopped may still leave; nothing after it.
        late = [f for f in commands(bus.frames(), C6XX_COMMAND) if f.t_ns > going_ns]
        assert sum(any(currents(f)) for f in late) <= 1
        assert not any(currents(late[-1]))
        go_on(robot)
        drive(robot, 0.2, left=rc10.velocity_rpm(100))
        assert any(currents(commands(bus.frames(), C6XX_COMMAND)[-1]))


def test_a_computer_without_real_time_may_stand_still_a_little_longer() -> None:
    with driven(CONFIG) as (process, robot, bus):
        process.signal(signal.SIGSTOP)
        time.sleep(0.07)
        process.signal(signal.SIGCONT)
        drive(robot, 0.3, left=rc10.velocity_rpm(100))
        assert robot.wait_for_state(1.0).status is rc10.RobotStatus.RUN
        assert told(process) == []
        process.signal(signal.SIGSTOP)
        stopped_ns = time.time_ns()
        assert 90 < ms_to_rest(bus, stopped_ns) < 110
        process.signal(signal.SIGCONT)


def test_the_end_of_the_guard_is_an_estop_and_another_one_comes(required: Path) -> None:
    with driven(required) as (process, robot, bus):
        run("kill", "-KILL", *guards())
        wait_for(lambda: robot.wait_for_state(5.0).status is rc10.RobotStatus.ESTOP, 5.0)
        assert robot.state is not None
        assert robot.state.stop_cause is rc10.StopCause.GUARD
        process.wait_line("rc10-guard watches again", 5.0)
        go_on(robot)
        drive(robot, 0.2, left=rc10.velocity_rpm(100))
        since_ns = time.time_ns()
        process.signal(signal.SIGKILL)
        assert ms_to_rest(bus, since_ns) < LIMIT_MS


def test_a_guard_that_stands_still_is_an_estop(required: Path) -> None:
    with driven(required) as (process, robot, bus):
        run("kill", "-STOP", *guards())
        stopped_s = time.monotonic()
        wait_for(lambda: robot.wait_for_state(5.0).status is rc10.RobotStatus.ESTOP, 5.0)
        assert 0.9 < time.monotonic() - stopped_s < 1.3
        assert robot.state is not None
        assert robot.state.stop_cause is rc10.StopCause.GUARD
        process.wait_line(rf"rc10-guard \(pid {guards()[0]}\) stands still", 5.0)
        run("kill", "-CONT", *guards())
        process.wait_line("rc10-guard goes on, and watches again", 5.0)
        go_on(robot)
        drive(robot, 0.2, left=rc10.velocity_rpm(100))
        since_ns = time.time_ns()
        process.signal(signal.SIGKILL)
        assert ms_to_rest(bus, since_ns) < LIMIT_MS


def test_an_orderly_life_is_never_disturbed(required: Path) -> None:
    with fakes():
        for _ in range(5):
            with daemon(required) as process:
                time.sleep(0.05)
                assert guards()
                assert process.stop() == 0
                assert told(process) == []
            wait_for(lambda: not guards(), 5.0, "the end of the guard")


def test_the_next_rc10d_starts_while_the_guard_still_tries() -> None:
    with fakes(), daemon() as process, client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        run("ip", "link", "set", "vcan0", "down")
        process.signal(signal.SIGKILL)
        process.wait(5.0)
        time.sleep(0.2)
        assert guards()
        run("ip", "link", "set", "vcan0", "up")
        with daemon() as second:
            wait_status(robot, rc10.MotorStatus.READY)
            robot.enable()
            drive(robot, 0.3, left=rc10.velocity_rpm(100))
            assert robot.wait_for_state(1.0).status is rc10.RobotStatus.RUN
            assert second.stop() == 0


def test_drives_that_the_next_rc10d_has_not_still_get_their_rest(tmp_path: Path) -> None:
    other = tmp_path / "other.yaml"
    other.write_text(
        "robot: other\nrealtime: preferred\nbuses:\n  - name: turret\n    interface: vcan0\n"
        "    motors:\n      - {name: yaw, model: GM6020, id: 5}\n"
    )
    with fakes(), daemon() as process:
        process.wait_line("left: OFFLINE -> READY", 5.0)
        run("ip", "link", "set", "vcan0", "down")
        process.signal(signal.SIGKILL)
        process.wait(5.0)
        with daemon(other) as second:
            second.wait_line("vcan0 is down", 5.0)
            with Candump("vcan0") as bus:
                run("ip", "link", "set", "vcan0", "up")
                second.wait_line("yaw: OFFLINE -> READY", 5.0)
                wait_for(
                    lambda: len(commands(bus.frames(), C6XX_COMMAND)) >= 3,
                    5.0,
                    "three rest frames of the drives that it has not",
                    poll_s=0.02,
                )
                bus.stop()
            rested = commands(bus.frames(), C6XX_COMMAND)
            assert {currents(frame) for frame in rested} == {REST}
            assert "two controllers" not in second.output()
            assert second.stop() == 0


def test_an_interface_that_returns_still_gets_its_rest(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(CONFIG.read_text().replace("vcan0", "plug0"))
    link_add("plug0")
    with daemon(path) as process:
        time.sleep(0.05)
        link_delete("plug0")
        process.signal(signal.SIGKILL)
        process.wait(5.0)
        time.sleep(0.3)
        # On whatever there will be: the guard may be faster than a recorder that looks for plug0.
        with Candump("any") as bus:
            link_add("plug0")
            wait_for(lambda: not guards(), 5.0, "the end of the guard")
            bus.stop()
            told = [frame for frame in bus.frames() if frame.iface == "plug0"]
            for command in COMMAND_IDS:
                assert [currents(f) for f in commands(told, command)][-1:] == [REST]
    link_delete("plug0")


def test_one_guard_serves_all_robots_and_the_debugger_has_none(tmp_path: Path) -> None:
    off = tmp_path / "off.yaml"
    text = (
        CONFIG.read_text().replace("vcan0", "vcan1").replace("robot: vcan_mixed", "robot: second")
    )
    off.write_text(re.sub("^realtime:", "guard: off\nrealtime:", text, flags=re.MULTILINE))
    second = tmp_path / "second.yaml"
    second.write_text(text)
    run("ip", "link", "set", "vcan1", "up")
    with daemon(off):
        assert guards() == []
    with Proc(BIN / "rc10-guard", "--until-unused"):
        wait_for(guards, 5.0)
        with daemon(), daemon(second):
            assert len(guards()) == 1
    wait_for(lambda: not guards(), 5.0, "the end of the guard")


@pytest.mark.parametrize(("guard", "dumped"), [("preferred", False), ("off", True)])
def test_a_crash_writes_a_core_only_without_a_guard(
    guard: str, dumped: bool, tmp_path: Path
) -> None:
    """Writing it would come before the end that the guard sees."""
    Path("/proc/sys/kernel/core_pattern").write_text("core")
    robot = tmp_path / "robot.yaml"
    robot.write_text(CONFIG.read_text() + f"\nguard: {guard}\n")
    limited = f"ulimit -c unlimited; exec {BIN}/rc10d -c {robot}"
    with fakes(), Proc("sh", "-c", limited, cwd=tmp_path) as process:
        process.wait_line("robot '.*' runs", 10.0)
        process.signal(signal.SIGSEGV)
        process.wait(30.0)
        assert [path.name for path in tmp_path.glob("core*")] == (["core"] if dumped else [])
