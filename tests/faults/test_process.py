"""The daemon's process: signals, stalls, clocks, files."""
# run-guest: --timeout 1200

from __future__ import annotations

import contextlib
import os
import re
import signal
import socket
import subprocess
import time
from pathlib import Path

import pytest
from faultrig import (
    CONFIG,
    FRONT,
    REAR,
    TICK_NS,
    client,
    ctl,
    drive,
    drives,
    proven,
    robot_under_test,
    witness,
)
from guestlib import Proc, run, wait_for
from rig import BIN, BUILD, currents, wait_status

import rc10

SOCKET = "/run/rc10d/faults.sock"


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (signal.SIGTERM, "SIGTERM"),
        (signal.SIGHUP, "SIGHUP: its terminal is closed"),
        (signal.SIGTSTP, "SIGTSTP: Ctrl-Z"),
        (signal.SIGQUIT, "SIGQUIT: Ctrl-\\"),
        (signal.SIGUSR1, "SIGUSR1 of a script that means another program"),
        (signal.SIGXCPU, "SIGXCPU: a limit of CPU time"),
        (signal.SIGALRM, "SIGALRM, as every other signal that would end the process"),
    ],
)
def test_a_signal_is_the_orderly_stop(number: signal.Signals, words: str) -> None:
    with robot_under_test() as (process, robot, log):
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
        asked_ns = time.time_ns()
        assert process.stop(number) == 0
        ended_ns = time.time_ns()
        for interface in (FRONT, REAR):
            assert [currents(f) for f in log.frames(interface)[-3:]] == [(0, 0, 0, 0)] * 3
        log.check()
        proven(
            words,
            "rest until echoed, last on the wire; exit 0",
            asked_ns,
            log.last_torque_ns("left"),
            2,
        )
        assert ended_ns - asked_ns < 2_000_000_000


@pytest.mark.parametrize(
    ("number", "words"),
    [
        (signal.SIGTTIN, "SIGTTIN: in the background of its terminal"),
        (signal.SIGTTOU, "SIGTTOU: its log in the background of its terminal"),
        (signal.SIGXFSZ, "SIGXFSZ: a limit of file size"),
        (signal.SIGPIPE, "SIGPIPE: nobody reads its log"),
    ],
)
def test_a_signal_that_ends_nothing(number: signal.Signals, words: str) -> None:
    with robot_under_test() as (process, robot, log):
        start_ns = time.time_ns()
        for t_s in robot.rate(100):
            if t_s >= 0.6:
                break
            robot.command(left=rc10.velocity_rpm(60), validity_ms=40)
            if abs(t_s - 0.3) < 0.005:
                process.signal(number)
                sent_ns = time.time_ns()
        last_ns = time.time_ns()
        log.driven(start_ns, last_ns, "left")
        assert all(currents(f)[0] for f in log.frames(FRONT, sent_ns) if f.t_ns < last_ns)
        assert robot.motor("left").status is rc10.MotorStatus.ACTIVE
        log.check(other_bus=FRONT)
        log.check()
        proven(words, "the motors go on", None, None, 0)


def test_a_hangup_that_nohup_ignores() -> None:
    config = str(CONFIG)
    with drives(), witness() as log, Proc("nohup", BIN / "rc10d", "-c", config) as process:
        process.wait_line("robot '.*' runs", 10.0)
        with client() as robot:
            wait_status(robot, rc10.MotorStatus.READY)
            robot.enable()
            drive(robot, log, 0.2, left=rc10.velocity_rpm(60))
            process.signal(signal.SIGHUP)
            last_ns = drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
            assert log.last_torque_ns("left") >= last_ns - 2 * TICK_NS
            log.check()
        assert process.stop() == 0
    proven("SIGHUP of a daemon that nohup started", "the motors go on", None, None, 0)


def limit_descriptors(pid: int) -> None:
    """From now on the process has no descriptor more than it has."""
    used = 1 + max(int(number.name) for number in Path(f"/proc/{pid}/fd").iterdir())
    run("prlimit", f"--pid={pid}", f"--nofile={used}:{used}")


def test_the_daemon_has_no_descriptors_left() -> None:
    with robot_under_test() as (process, robot, log):
        drive(robot, log, 0.2, left=rc10.velocity_rpm(60))
        limit_descriptors(process.pid)
        # Sixteen, for there may be gaps among its numbers.
        with contextlib.ExitStack() as guests:
            for _ in range(16):
                link = guests.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET))
                link.connect(SOCKET)
            last_ns = drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
            assert log.last_torque_ns("left") >= last_ns - 2 * TICK_NS
            assert "no file descriptors left: a client was sent away" in process.output()
            start_ns = time.time_ns()
            robot.command(left=rc10.velocity_rpm(60), validity_ms=500)
            time.sleep(0.05)
            asked_ns = time.time_ns()
            done = ctl("estop")
            # By the datagram; a client that could confirm it is sent away.
            assert done.returncode == 3, done.stderr
            assert "the e-stop was sent and is not confirmed" in done.stderr
            time.sleep(0.05)
        assert robot.wait_for_state(5.0).estopped
        log.driven(start_ns, asked_ns, "left", validity_ms=500)
        last_ns = log.last_torque_ns("left")
        log.check()
        proven(
            "rc10d has no file descriptors left",
            "new clients are sent away in words; the motors go on; an e-stop gets in, unconfirmed",
            asked_ns,
            last_ns,
            30,
        )


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSEGV, signal.SIGABRT])
def test_the_daemon_dies_and_its_guard_follows(number: signal.Signals) -> None:
    with robot_under_test() as (process, robot, log):
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
        process.signal(number)
        killed_ns = time.time_ns()
        process.wait(5.0)
        process.wait_line("the rest frames are on the wire", 5.0)
        for interface in (FRONT, REAR):
            rest = log.frames(interface, killed_ns + 2 * TICK_NS)
            assert [currents(f) for f in log.frames(interface)[-2:]] == [(0, 0, 0, 0)] * 2
            assert rest[-1].t_ns - killed_ns < 25 * TICK_NS
        log.check(other_bus=None)
        proven(
            f"{number.name} of the daemon",
            "rc10-guard sends rest to every drive until echoed",
            killed_ns,
            log.last_torque_ns("left"),
            2,
        )


def test_the_guard_dies() -> None:
    with robot_under_test() as (_, robot, log):
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
        run("pkill", "-KILL", "-x", "rc10-guard")
        killed_ns = time.time_ns()
        wait_for(lambda: robot.wait_for_state(5.0).stop_cause is rc10.StopCause.GUARD, 5.0)
        time.sleep(0.1)
        log.check(other_bus=None)
        proven(
            "rc10-guard is killed",
            "e-stop; another guard is started",
            killed_ns,
            log.last_torque_ns("left"),
            3,
        )


def test_the_guard_stands_still() -> None:
    with robot_under_test() as (process, robot, log):
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
        run("pkill", "-STOP", "-x", "rc10-guard")
        stopped_ns = time.time_ns()
        drive(robot, log, 1.4, left=rc10.velocity_rpm(60))
        assert robot.wait_for_state(5.0).stop_cause is rc10.StopCause.GUARD
        run("pkill", "-CONT", "-x", "rc10-guard")
        process.wait_line("rc10-guard goes on, and watches again", 5.0)
        log.check(other_bus=None)
        proven(
            "SIGSTOP of rc10-guard",
            "e-stop after 1 s",
            stopped_ns,
            log.last_torque_ns("left"),
            1200,
        )


def test_the_daemon_stands_still_for_long() -> None:
    with robot_under_test() as (process, robot, log):
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
        process.signal(signal.SIGSTOP)
        stopped_ns = time.time_ns()
        process.wait_line("the rest frames are on the wire", 5.0)
        rested_ns = time.time_ns()
        for interface in (FRONT, REAR):
            assert [currents(f) for f in log.frames(interface)[-3:]] == [(0, 0, 0, 0)] * 3
        assert rested_ns - stopped_ns < 130 * TICK_NS
        process.signal(signal.SIGCONT)
        wait_for(lambda: robot.wait_for_state(5.0).stop_cause is rc10.StopCause.GUARD, 5.0)
        time.sleep(0.1)
        assert not any(any(currents(f)) for f in log.frames(FRONT, rested_ns)[2:])
        proven(
            "SIGSTOP of the daemon, `realtime: preferred`",
            "rc10-guard sends rest after 100 ms; e-stop when it goes on",
            stopped_ns,
            rested_ns,
            130,
        )


@pytest.mark.parametrize("stall_ms", [30, 80])
def test_the_daemon_stalls(stall_ms: int) -> None:
    with robot_under_test() as (process, robot, log):
        start_ns = time.time_ns()
        for t_s in robot.rate(100):
            if t_s >= 0.3:
                break
            robot.command(left=rc10.velocity_rpm(60), validity_ms=20)
        last_ns = time.time_ns()
        process.signal(signal.SIGSTOP)
        time.sleep(stall_ms / 1000)
        process.signal(signal.SIGCONT)
        going_ns = time.time_ns()
        time.sleep(0.2)
        log.driven(start_ns, last_ns, "left", validity_ms=20)
        after = log.frames(FRONT, going_ns)
        assert after, "it goes on"
        assert all(currents(f)[0] == 0 for f in after), "computed before the stall"
        log.check(other_bus=None)
        proven(
            f"the daemon stalls for {stall_ms} ms",
            "missed ticks are counted, not replayed; nothing old is sent",
            None,
            None,
            0,
        )


def with_busy_ticks(config: Path, busy: Path, busy_us: int) -> Proc:
    """A rc10d that computes for so long a bus in each tick, while the file `busy` exists."""
    library = BUILD / "tests" / "librc10_busy_ticks.so"
    preload = {
        "LD_PRELOAD": str(library),
        "RC10_BUSY_TICKS": str(busy),
        "RC10_BUSY_US": str(busy_us),
    }
    return Proc(BIN / "rc10d", "-c", config, env=preload)


def test_ticks_that_compute_for_longer_than_their_period(tmp_path: Path) -> None:
    busy = tmp_path / "busy"
    daemon = with_busy_ticks(CONFIG, busy, 12_000)
    with drives(), witness() as log, daemon, client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
        # Nobody else gets the one CPU of this guest: a shorter one would lapse.
        robot.command(left=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60), validity_ms=500)
        begun_ns = time.time_ns()
        log.driven(begun_ns, begun_ns, "left", "other", validity_ms=500)
        busy.touch()
        time.sleep(0.2)
        busy.unlink()
        state = robot.wait_for_state(5.0)
        assert state.estopped
        assert state.stop_cause is rc10.StopCause.OVERLOAD
        last_ns = max(log.last_torque_ns("left"), log.last_torque_ns("other"))
        wait_for(lambda: len(log.frames(FRONT, last_ns)) > 50, 5.0)
        log.check(other_bus=None)
        proven(
            "ticks that each compute for 24 ms",
            "e-stop (`overload`) once they have used `scheduler.overload_ms`",
            begun_ns,
            last_ns,
            200,
        )


def test_ticks_that_compute_for_most_of_their_period(tmp_path: Path) -> None:
    busy, config = tmp_path / "busy", tmp_path / "robot.yaml"
    # Ticks of 10 ms: shorter than a count of the guest's kernel, their CPU time would not show.
    config.write_text(CONFIG.read_text() + "scheduler: {rate_hz: 100, overload_ms: 20}\n")
    daemon = with_busy_ticks(config, busy, 4_000)
    with drives(), witness() as log, daemon, client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        busy.touch()
        begun_ns = time.time_ns()
        last_ns = drive(robot, log, 0.2, left=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
        busy.unlink()
        front, rear = (log.frames(bus, begun_ns + 20 * TICK_NS) for bus in (FRONT, REAR))
        apart_ns = [b.t_ns - a.t_ns for a, b in zip(front, rear, strict=False)]
        assert min(apart_ns[:10]) > 3.9 * TICK_NS, "they were busy"
        assert log.last_torque_ns("left") > last_ns - 20 * TICK_NS, "and drove on"
        assert not robot.wait_for_state(5.0).estopped
        log.check(other_bus=None)
        proven(
            "ticks that compute for 80 % of their period, for ten times `overload_ms`",
            "no stop",
            None,
            None,
            0,
        )


def test_the_wall_clock_is_set_back_an_hour() -> None:
    with robot_under_test() as (_, robot, log):
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
        log.check()
        time.clock_settime(time.CLOCK_REALTIME, time.time() - 3600)
        start_ns = time.time_ns()
        for t_s in robot.rate(100):
            if t_s >= 0.5:
                break
            robot.command(left=rc10.velocity_rpm(60), validity_ms=40)
        seen = [f for f in log.dump.frames()[-400:] if f.iface == FRONT and f.id == 0x200]
        assert all(f.t_ns >= start_ns - 500 * TICK_NS for f in seen)
        assert all(currents(f)[0] != 0 for f in seen[:60])
        assert robot.motor("left").status is rc10.MotorStatus.ACTIVE
        proven("wall clock set back an hour", "nothing changes", None, None, 0)


def test_a_second_daemon_on_the_interface_is_refused() -> None:
    with robot_under_test() as (_, robot, log):
        other = Path("/tmp/second.yaml")
        other.write_text(CONFIG.read_text().replace("robot: faults", "robot: second"))
        start_ns = time.time_ns()
        second = subprocess.run(
            [str(BIN / "rc10d"), "-c", str(other)],
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
        )
        assert second.returncode != 0
        assert "vcan0" in second.stdout + second.stderr
        drive(robot, log, 0.2, left=rc10.velocity_rpm(60))
        log.check(other_bus=FRONT)
        log.check()
        assert len(log.frames(FRONT, start_ns)) > 190
        proven(
            "a second rc10d on an interface",
            "it refuses to start; the first misses no tick",
            None,
            None,
            0,
        )


@pytest.mark.parametrize("way", ["another run folder", "another name of the interface"])
def test_a_second_daemon_by_another_way(way: str, tmp_path: Path) -> None:
    with robot_under_test() as (_, robot, log):
        other = tmp_path / "second.yaml"
        text = CONFIG.read_text().replace("robot: faults", "robot: second")
        environment = dict(os.environ)
        if way == "another run folder":
            environment["RC10_RUN_DIR"] = str(tmp_path / "run")
        else:
            run("ip", "link", "property", "add", "dev", FRONT, "altname", "front0")
            text = text.replace(FRONT, "front0")
        other.write_text(text)
        start_ns = time.time_ns()
        second = subprocess.run(
            [str(BIN / "rc10d"), "-c", str(other)],
            capture_output=True,
            text=True,
            check=False,
            timeout=60,
            env=environment,
        )
        assert second.returncode == 1
        assert "is driven by robot 'faults'" in second.stdout + second.stderr
        drive(robot, log, 0.2, left=rc10.velocity_rpm(60))
        log.check(other_bus=FRONT)
        log.check()
        assert len(log.frames(FRONT, start_ns)) > 190
        proven(
            f"a second rc10d on an interface, by {way}",
            "it refuses to start; the first misses no tick",
            None,
            None,
            0,
        )


def mistakes(count: int) -> str:
    """A robot with so many different mistakes."""
    motors = []
    for number in range(count):
        bad = [
            f"{{name: m{number}, model: M3508, id: {number + 9}}}",
            f"{{name: m{number}, model: M{number}, id: 1}}",
            f"{{name: 'm {number}', model: M2006, id: 1}}",
            f"{{name: m{number}, model: M3508, id: 1, key{number}: 1}}",
            f"{{name: m{number}, model: M3508, id: 1, current_limit_a: {number + 21}}}",
            f"{{name: m{number}, model: M3508, id: 1, direction: {number + 2}}}",
            f"{{name: m{number}, model: M3508, id: 1, gear_ratio: -{number + 1}}}",
            f"{{name: m{number}, model: M3508, id: 0{number}}}",
        ][number % 8]
        motors.append(f"      - {bad}\n")
    return (
        f"robot: faults\nbuses:\n  - name: front\n    interface: {FRONT}\n    motors:\n"
        + "".join(motors)
    )


def test_a_configuration_with_a_hundred_mistakes(tmp_path: Path) -> None:
    path = tmp_path / "robot.yaml"
    path.write_text(mistakes(100))
    with drives(), witness() as log:
        for words in (("--check", str(path)), ("-c", str(path))):
            done = subprocess.run(
                [str(BIN / "rc10d"), *words],
                capture_output=True,
                text=True,
                check=False,
                timeout=60,
            )
            assert done.returncode == 2
            text = done.stdout + done.stderr
            places = set(re.findall(f"^{path}:(\\d+):", text, re.MULTILINE))
            assert len(places) >= 100, text
        assert log.frames(FRONT) == []
        proven(
            "a configuration with 100 mistakes",
            "all are told at once; nothing is sent",
            None,
            None,
            0,
        )
