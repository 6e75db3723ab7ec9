"""Start and stop of rc10d, and a second one on its interfaces."""

from __future__ import annotations

import contextlib
import os
import pty
import re
import signal
import subprocess
from pathlib import Path

import pytest
from hostlib import Daemon, Program, eventually
from hostlib.daemon import BIN
from hostlib.program import PATIENCE_S

import rc10

SUMMARY = re.compile(r"(\d+) ticks, (\d+) missed; wake latency .* max (\d+) us")


@pytest.mark.parametrize(
    "number",
    [
        signal.SIGTERM,
        signal.SIGINT,
        signal.SIGHUP,
        signal.SIGQUIT,
        signal.SIGTSTP,
        signal.SIGUSR1,
        signal.SIGALRM,
        signal.SIGXCPU,
        signal.SIGRTMIN,
    ],
)
def test_a_signal_ends_it_soon_and_well(daemon: Daemon, number: signal.Signals) -> None:
    daemon.must("enable")
    with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s"):
        daemon.wait_motor("wheel", lambda m: m["velocity_rpm"] > 50, "turns")
        daemon.program.signal(number)
        assert daemon.program.wait() == 0
    summary = SUMMARY.search(daemon.program.output)
    assert summary, daemon.program.output
    assert int(summary[1]) > 0
    assert daemon.processes() == {}
    assert not (daemon.run_dir / "host.sock").exists()


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGQUIT, signal.SIGTSTP])
def test_what_a_terminal_sends_to_all_ends_the_gateway_too(
    daemon: Daemon, number: signal.Signals
) -> None:
    os.killpg(daemon.program.pid, number)
    assert daemon.program.wait() == 0
    assert daemon.processes() == {}


@pytest.mark.parametrize("number", [signal.SIGXFSZ, signal.SIGTTIN, signal.SIGTTOU])
def test_a_signal_about_a_file_or_terminal_is_told_and_ends_nothing(
    daemon: Daemon, number: signal.Signals
) -> None:
    daemon.must("enable", "wheel")
    daemon.program.signal(number)
    daemon.program.wait_line(rf"warning {number.name} \(.*\): ignored")
    tick = daemon.state()["tick"]
    state = daemon.wait_state(lambda s: s["tick"] > tick + 20, "ticks on")
    assert state["motors"][0]["status"] == "ACTIVE"


@pytest.mark.parametrize("number", [signal.SIGXFSZ, signal.SIGTTIN, signal.SIGTTOU])
def test_a_signal_about_a_file_or_terminal_leaves_the_gateway_at_work(
    daemon: Daemon, number: signal.Signals
) -> None:
    """As of a line of its own, with `ulimit -f` or `stty tostop`."""
    before = daemon.processes()
    with rc10.connect("host", client="test") as robot:
        robot.wait_for_state()
        os.killpg(daemon.program.pid, number)
        robot.enable("wheel")
    assert daemon.processes() == before


def test_a_terminal_that_hangs_holds_up_neither_the_log_nor_the_end() -> None:
    master, terminal = pty.openpty()
    os.set_blocking(terminal, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(terminal, b"x" * 1024)
    os.set_blocking(terminal, True)
    os.read(master, 4096)  # room for some lines
    with Daemon() as daemon:
        daemon.program.stop()
        program = subprocess.Popen(
            [BIN / "rc10d", "-c", daemon.config],
            env={**os.environ, **daemon.env},
            stderr=terminal,
            start_new_session=True,
        )
        log = daemon.run_dir / "host.log"

        def fills() -> bool:
            program.send_signal(signal.SIGXFSZ)  # a line
            return log.read_text().count("SIGXFSZ") > 100

        try:
            eventually(lambda: daemon.ctl("list").returncode == 0, "it runs")
            eventually(fills, "more lines than have room")
            program.terminate()
            assert program.wait(PATIENCE_S) == 0
        finally:
            program.kill()
            program.wait()
    os.close(master)
    os.close(terminal)


def test_nohup_lets_it_outlive_its_terminal(daemon: Daemon) -> None:
    daemon.program.stop()
    with Program(BIN / "rc10d", "-c", daemon.config, env=daemon.env, prefix=["nohup"]) as program:
        program.wait_line("LCM on")
        program.signal(signal.SIGHUP)
        tick = daemon.state()["tick"]
        daemon.wait_state(lambda s: s["tick"] > tick + 20, "ticks on")
        program.signal(signal.SIGTERM)
        assert program.wait() == 0


def test_it_ticks_at_its_rate(daemon: Daemon) -> None:
    first = daemon.state()
    last = daemon.wait_state(lambda s: s["tick"] >= first["tick"] + 2000, "2000 ticks")
    elapsed_ms = (last["mono_us"] - first["mono_us"]) / 1000
    missed = daemon.stats()["missed_ticks"]
    # Ticks lie on a grid: the missed ones are skipped, never made up for.
    assert last["tick"] - first["tick"] <= elapsed_ms + 1
    assert last["tick"] - first["tick"] >= elapsed_ms - missed - 1


def test_a_second_one_for_the_same_robot_is_refused(daemon: Daemon) -> None:
    daemon.must("enable", "wheel")
    tick = daemon.state()["tick"]
    with Program(BIN / "rc10d", "-c", daemon.config, env=daemon.env) as second:
        assert second.wait() == 1
        assert f"pid {daemon.pid}" in second.output
    # The first is undisturbed.
    state = daemon.wait_state(lambda s: s["tick"] > tick + 100, "ticks on")
    assert state["motors"][0]["status"] == "ACTIVE"
    assert (daemon.run_dir / "host.sock").exists()


def test_it_starts_again_after_it_was_killed(daemon: Daemon) -> None:
    daemon.must("enable", "wheel")
    daemon.kill()
    eventually(lambda: daemon.processes() == {}, "its gateway ended too")
    daemon.start()
    state = daemon.wait_ready()
    assert all(motor["status"] == "READY" for motor in state["motors"])
    daemon.program.wait_line("LCM")


def test_an_unwritable_run_folder_is_named(tmp_path: Path) -> None:
    file = tmp_path / "file"
    file.touch()
    config = tmp_path / "robot.yaml"
    with Daemon() as daemon:
        config.write_text(daemon.config.read_text())
    env = {"RC10_RUN_DIR": str(file / "run")}
    with Program(BIN / "rc10d", "-c", config, env=env) as rc10d:
        assert rc10d.wait() == 1
        assert str(file) in rc10d.output


def test_rc10ctl_says_when_no_daemon_runs(tmp_path: Path) -> None:
    with Program(BIN / "rc10ctl", "list", env={"RC10_RUN_DIR": str(tmp_path)}) as ctl:
        assert ctl.wait() == 3
        assert "rc10d is not running" in ctl.output
