"""Errors of rc10ctl say what to do next."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon
from hostlib.daemon import CONFIG

if TYPE_CHECKING:
    from pathlib import Path

TOO_MANY = [f"v{i}=1" for i in range(200)]


@pytest.mark.parametrize(
    ("words", "status", "told"),
    [
        (["signal", "lift", *TOO_MANY], 2, "`rc10ctl modules` names them"),
        (["set", "wheel", "velocity", "nan"], 2, "such as `rc10ctl set wheel velocity 10`"),
        (["enabel"], 2, "there is no verb 'enabel'; did you mean enable?"),
        ([], 2, "rc10ctl: say what to do, such as `rc10ctl list`; `rc10ctl --help` has all"),
        (["zero"], 2, "rc10ctl: motor is required; usage: `rc10ctl zero MOTOR [DEG]`"),
        (["set", "wheel"], 2, "mode is required; usage: `rc10ctl set MOTOR MODE [VALUE]`"),
        (
            ["set", "wheel", "total_angle", "360deg"],
            2,
            "value: '360deg' is no number; units are not written; usage: `rc10ctl set",
        ),
        (["list", "wheel"], 2, "one word too many: wheel; usage: `rc10ctl list`"),
        (
            ["test-motion", "wheel", "step", "5"],
            2,
            "--max-current is required; usage: `rc10ctl test-motion MOTOR KIND AMPLITUDE",
        ),
        (["watch", "--onec"], 2, "there is no option '--onec'; did you mean --once?"),
        (["set", "wheel", "velocty", "1"], 2, "did you mean velocity?"),
        (["set", "whel", "velocity", "1"], 1, "did you mean wheel?"),
        (["enable", "whel"], 1, "did you mean wheel?"),
        (["watch", "--once", "--spark", "wheel.velocty"], 2, "did you mean velocity?"),
        (["set", "wheel", "velocity", "1", "--then", "coats"], 2, "did you mean coast?"),
        (["--robot", "hots", "list"], 3, "robots that run here: host; did you mean host?"),
        (["gains", "wheel", "velocty.kp=1"], 1, "did you mean velocity?"),
        (["gains", "wheel", "velocity.kpp=1"], 1, "did you mean kp_a_per_rpm?"),
        (["signal", "lift", "velocity_rpm=1"], 1, "there is no module 'lift'"),
        (
            ["set", "wheel", "current", "500"],
            1,
            "500 A is beyond the current_limit_a of wheel, 20 A: give amperes, 20 at most",
        ),
        (["hand", "whel", "--by", "90"], 1, "did you mean wheel?"),
        (["load", "whel", "coulomb_nm=1"], 1, "did you mean wheel?"),
        (["set", "wheel", "impedance", "10"], 2, "impedance without --stiffness, --damping or"),
        (["set", "wheel", "velocity", "9", "--velocity-ff", "1"], 2, "--velocity-ff is for angle"),
        (["set", "wheel", "brake", "--torque-ff", "1"], 2, "--torque-ff is not for brake"),
        (["set", "wheel", "angle", "9", "--stiffness", "1"], 2, "--stiffness and --damping are"),
        (["jog", "whel"], 1, "did you mean wheel?"),
        (["zero", "whel"], 1, "did you mean wheel?"),
        (["commission", "whel"], 1, "did you mean wheel?"),
        (["configure-drive", "whel", "--list"], 1, "did you mean wheel?"),
        (["convert-gains", "--speed", "1", "2", "3", "--td-ratio", "x"], 2, "--td-ratio: 'x'"),
        (["blackbox", "--out", "/dev/null/out"], 1, "name another folder with --out"),
    ],
)
def test_a_failure_names_the_next_step(
    daemon: Daemon, words: list[str], status: int, told: str
) -> None:
    done = daemon.ctl(*words)
    assert done.returncode == status, done.stderr
    assert told in done.stderr


PAIR = """
modules:
  - {name: lift, type: synchronised_pair, left: wheel, right: other, velocity_limit_rpm: 60}
  - {name: rc, type: remote, port: /dev/nothing, protocol: sbus}
"""


def test_a_signal_that_moves_nothing_fails_and_names_what_is_missing() -> None:
    words = ("signal", "lift", "velocity_rpm=5", "--for", "100ms")
    with Daemon(CONFIG.format(realtime="preferred") + PAIR) as daemon:
        daemon.wait_ready()
        done = daemon.ctl(*words)
        assert done.returncode == 1
        at_rest = "module 'lift' takes its inputs and moves nothing: "
        assert at_rest + "not enabled: `rc10ctl enable wheel other`" in done.stderr
        daemon.must("enable", "wheel", "other")
        assert daemon.ctl(*words).returncode == 0
        daemon.must("estop")
        done = daemon.ctl(*words)
        assert done.returncode == 1
        remedy = "the robot is in ESTOP: `rc10ctl clear`, then `rc10ctl enable wheel other`"
        assert at_rest + remedy in done.stderr
        done = daemon.ctl("signal", "rc", "ch1=1")
        assert done.returncode == 1
        assert "module 'rc' has no input 'ch1'; it has none" in done.stderr


def test_a_file_that_cannot_be_written_is_named_with_the_cause(
    daemon: Daemon, tmp_path: Path
) -> None:
    (tmp_path / "host.log").mkdir()
    done = daemon.ctl("blackbox", "--out", tmp_path)
    assert done.returncode == 1
    assert f"{tmp_path}/host.log cannot be written: Is a directory: name another" in done.stderr


def test_when_rc10d_ends_the_place_of_its_log_is_told(daemon: Daemon) -> None:
    with daemon.drive("watch", "--json", "--hz", "100") as watch:
        watch.wait_line("^{")
        daemon.program.signal(signal.SIGTERM)
        assert watch.wait() == 1
        assert "rc10ctl: rc10d has ended: see its log: `journalctl -eu 'rc10d*'`" in watch.output
