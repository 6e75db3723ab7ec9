"""The tools of the Python package, as users run them (docs/tuning.md), against the whole rc10d."""

from __future__ import annotations

import csv
import re
import signal
import socket
import struct
import sys
from pathlib import Path

import pytest
from hostlib import Daemon, Program, eventually
from hostlib.daemon import REPO
from mcap.reader import make_reader

# Most turn the yaw, which has no gear: while this machine pauses, the encoder before a gear turns
# too far unseen, which is a fault.

# These import NumPy and matplotlib, on a machine that may be busy.
PATIENCE_S = 60.0


def tool(name: str, *words: str | Path) -> Program:
    return Program(sys.executable, "-m", f"rc10.{name}", *words)


def assert_done(program: Program) -> str:
    assert program.wait(PATIENCE_S) == 0, program.output
    return program.output


def columns(path: Path) -> dict[str, list[str]]:
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return {name: [row[name] for row in rows] for name in rows[0]}


def at_rest(daemon: Daemon, name: str) -> None:
    """It is disabled, and nobody holds it."""
    motor = daemon.wait_motor(name, lambda m: m["status"] == "READY", "is disabled")
    assert motor["mode"] == "coast"


def test_a_step_is_run_judged_and_drawn(daemon: Daemon, tmp_path: Path) -> None:
    png, table = tmp_path / "step.png", tmp_path / "step.csv"
    words = ("yaw", "velocity", "100", "--enable", "--seconds", "1", "--png", png, "--csv", table)
    with tool("step", *words) as step:
        output = assert_done(step)
    assert "host, yaw: velocity from 0 to 100 rpm" in output
    assert "overshoot" in output
    assert png.read_bytes().startswith(b"\x89PNG")
    recorded = columns(table)
    # Not the last one: a pause of this machine may let a command expire.
    assert max(float(rpm) for rpm in recorded["yaw.velocity_rpm"]) > 50
    assert float(recorded["time_s"][0]) < 0 < float(recorded["time_s"][-1])
    at_rest(daemon, "yaw")


def test_a_step_that_rc10d_would_cut_is_refused(daemon: Daemon) -> None:
    with tool("step", "wheel", "velocity", "100000", "--enable") as step:
        assert step.wait(PATIENCE_S) == 1, step.output
        assert "rc10d limits the target 100000 rpm" in step.output
    at_rest(daemon, "wheel")
    with tool("step", "wheel", "velocity", "100", "--robot", "host") as step:
        assert step.wait(PATIENCE_S) == 1, step.output
        assert "wheel is READY: enable it first (--enable does it)" in step.output


def test_ctrl_c_in_a_step_lets_go(daemon: Daemon) -> None:
    with tool("step", "yaw", "velocity", "60", "--enable", "--seconds", "60") as step:
        daemon.wait_motor("yaw", lambda m: m["velocity_rpm"] > 30, "turns")
        step.signal(signal.SIGINT)
        assert step.wait(PATIENCE_S) == 130, step.output
        assert "interrupted" in step.output
    at_rest(daemon, "yaw")


@pytest.mark.usefixtures("daemon")
def test_a_wrong_name_says_what_there_is() -> None:
    with tool("plot", "--png", "x.png", "whel.velocity_rpm") as plot:
        assert plot.wait(PATIENCE_S) == 1
        assert "plot: the robot has no motor 'whel'; it has: wheel, other, yaw" in plot.output


@pytest.mark.usefixtures("daemon")
def test_vofa_receives_a_frame_for_each_state() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vofa:
        vofa.bind(("127.0.0.1", 0))
        vofa.settimeout(PATIENCE_S)
        url = f"udp://127.0.0.1:{vofa.getsockname()[1]}"
        with tool("stream", "--vofa", url, "wheel.status", "yaw.angle_deg") as stream:
            stream.wait_line("I0 wheel.status, I1 yaw.angle_deg -> udp://", PATIENCE_S)
            for _ in range(20):
                status, angle_deg, tail = struct.unpack("<ffI", vofa.recv(64))
                assert (status, tail) == (1.0, 0x7F800000)
                assert 0 <= angle_deg < 360
            stream.signal(signal.SIGINT)
            assert stream.wait(PATIENCE_S) == 130


def test_a_log_of_lcm_logger_becomes_mcap_and_a_table(daemon: Daemon, tmp_path: Path) -> None:
    log = tmp_path / "match.lcmlog"
    with Program("lcm-logger", r"--channel=host\.v1\..*", log) as logger:
        daemon.must("enable", "yaw")
        daemon.must("set", "yaw", "velocity", 60, "--for", "500ms")
        eventually(lambda: log.exists() and log.stat().st_size > 10_000, "states were logged")
        logger.interrupt()
        logger.wait()
    with tool("export", log) as export:
        output = assert_done(export)
    assert re.search(r"match.lcmlog.csv: \d+ states of robot 'host'", output)
    assert len(columns(tmp_path / "match.lcmlog.csv")["wheel.velocity_rpm"]) > 5
    with (tmp_path / "match.lcmlog.mcap").open("rb") as file:
        topics = {channel.topic for _, channel, _ in make_reader(file).iter_messages()}
    assert topics >= {"/host/state", "/host/motor/wheel", "/host/motor/yaw"}


def example(name: str, *words: str | Path) -> Program:
    return Program(sys.executable, REPO / "python" / "examples" / f"{name}.py", *words)


def test_the_tuning_measures_the_motor_and_suggests_gains(daemon: Daemon) -> None:
    with example("pid_tuning", "host", "wheel", "--tries", "2", "--seconds", "0.3") as tuning:
        output = assert_done(tuning)
    assert re.search(r"wheel accelerates by \d+ rpm/s for each ampere", output)
    assert re.search(r"suggested: velocity_pid: \{kp_a_per_rpm: [\d.]+, ki_a", output)
    best = re.search(r"for the configuration:\n(velocity_pid: .*)\n", output, re.IGNORECASE)
    assert best
    assert best[1] in daemon.must("gains", "wheel", "--save"), "and it is in force"
    at_rest(daemon, "wheel")
