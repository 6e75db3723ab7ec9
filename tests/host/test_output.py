"""Output of a program is not lost without a word."""

from __future__ import annotations

import os
import signal
import subprocess
from pathlib import Path

import pytest
from hostlib import Daemon, eventually
from hostlib.daemon import BIN, REPO

DEMO = REPO / "config" / "demo.yaml"


@pytest.mark.parametrize(
    "words",
    [
        *([name, "--version"] for name in ("rc10d", "rc10ctl", "rc10-lcm", "rc10-guard")),
        *(
            [name, "--help"]
            for name in ("rc10-stop", "rc10-irq", "rc10-sim", "rc10-web", "rc10ctl")
        ),
        ["rc10d", "--check", str(DEMO)],
        ["rc10d", "--schema"],
        ["rc10ctl", "check", str(DEMO)],
    ],
    ids=" ".join,
)
def test_a_full_disk_is_no_success(words: list[str]) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [BIN / words[0], *words[1:]],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            check=False,
        )
    assert done.returncode == 1
    assert f"{words[0]}: the output is lost or incomplete: " in done.stderr


def test_gains_that_could_not_be_saved_are_no_success(daemon: Daemon) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [BIN / "rc10ctl", "gains", "--save", "wheel"],
            env={**os.environ, **daemon.env},
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            check=False,
        )
    assert done.returncode == 1, done.stderr
    assert "the output is lost or incomplete" in done.stderr


def test_rc10d_ends_though_nobody_reads_its_log(tmp_path: Path) -> None:
    robot = tmp_path / "robot.yaml"
    robot.write_text(DEMO.read_text())
    reading, writing = os.pipe()
    try:
        os.set_blocking(writing, False)
        try:
            while True:
                os.write(writing, bytes(4096))
        except BlockingIOError:
            os.set_blocking(writing, True)
        env = {**os.environ, "RC10_RUN_DIR": str(tmp_path), "RC10_STATE_DIR": str(tmp_path)}
        with subprocess.Popen([BIN / "rc10d", "-c", robot], stderr=writing, env=env) as process:
            eventually(lambda: (tmp_path / "demo.sock").exists(), "its socket")
            listed = [str(BIN / "rc10ctl"), "list"]
            eventually(
                lambda: (
                    subprocess.run(listed, env=env, capture_output=True, check=False).returncode
                    == 0
                ),
                "rc10ctl list",
            )
            process.send_signal(signal.SIGTERM)
            assert process.wait(60) == 0
    finally:
        os.close(reading)
        os.close(writing)
