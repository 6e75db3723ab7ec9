"""Errors of rc10ctl say what to do next."""

from __future__ import annotations

import signal
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

    from hostlib import Daemon

TOO_MANY = [f"v{i}=1" for i in range(200)]


@pytest.mark.parametrize(
    ("words", "status", "told"),
    [
        (["signal", "lift", *TOO_MANY], 2, "`rc10ctl modules` names them"),
        (["set", "wheel", "velocity", "nan"], 2, "such as `rc10ctl set wheel velocity 10`"),
        (["enabel"], 2, "there is no verb 'enabel'; did you mean enable?"),
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
        (["hand", "whel", "--by", "90"], 1, "did you mean wheel?"),
        (["load", "whel", "coulomb_nm=1"], 1, "did you mean wheel?"),
        (["set", "wheel", "impedance", "10"], 2, "impedance without --stiffness, --damping or"),
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
