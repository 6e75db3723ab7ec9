"""rc10-stop on a computer without CAN: its command line and its file."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest
from hostlib import Daemon
from hostlib.daemon import BIN
from hostlib.program import PATIENCE_S, full_pipe


def rc10_stop(*words: str | Path, run_dir: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [BIN / "rc10-stop", *words],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
        env={**os.environ, "RC10_RUN_DIR": str(run_dir)},
    )


def test_help_explains_the_exit_status(tmp_path: Path) -> None:
    done = rc10_stop("--help", run_dir=tmp_path)
    assert done.returncode == 0
    assert "Exit status" in done.stdout


@pytest.mark.parametrize(
    "words",
    [[], ["hero", "sentry"], ["--all", "hero"], ["--file"], ["--al"], ["../hero"], [""]],
)
def test_bad_usage_is_refused(words: list[str], tmp_path: Path) -> None:
    done = rc10_stop(*words, run_dir=tmp_path)
    assert done.returncode == 2
    assert "--help" in done.stderr


def test_what_was_meant_is_told(tmp_path: Path) -> None:
    (tmp_path / "hero").mkdir()
    (tmp_path / "hero" / "rest-frames").write_text("nocan9 200#00\n")
    done = rc10_stop("--forec", run_dir=tmp_path)
    assert "'--forec' is no robot and no option; did you mean --force?" in done.stderr
    done = rc10_stop("heor", run_dir=tmp_path)
    assert done.returncode == 2
    assert done.stderr.endswith("; robots that ran here: hero; did you mean hero?\n")
    done = rc10_stop("--file", run_dir=tmp_path)
    assert "--file needs a FILE" in done.stderr


def test_a_robot_that_never_ran_is_named(tmp_path: Path) -> None:
    done = rc10_stop("hero", run_dir=tmp_path)
    assert done.returncode == 2
    assert str(tmp_path / "hero" / "rest-frames") in done.stderr


def test_all_of_nothing_is_no_error(tmp_path: Path) -> None:
    done = rc10_stop("--all", run_dir=tmp_path / "none")
    assert (done.returncode, done.stderr) == (0, "")


def test_a_bad_line_is_named_and_nothing_of_the_file_is_sent(tmp_path: Path) -> None:
    file = tmp_path / "rest-frames"
    file.write_text("# head\nnocan9 200#00\nnocan9 200#0\n")
    done = rc10_stop("--file", file, run_dir=tmp_path)
    assert done.returncode == 2
    assert f"{file}: line 3" in done.stderr
    assert len(done.stderr.splitlines()) == 1


def test_an_interface_that_cannot_be_opened_is_named(tmp_path: Path) -> None:
    file = tmp_path / "rest-frames"
    file.write_text("nocan9 200#00\n")
    done = rc10_stop("--file", file, run_dir=tmp_path)
    assert done.returncode == 1
    assert "nocan9" in done.stderr


def test_a_robot_of_simulated_motors_has_no_rest_frames(daemon: Daemon) -> None:
    file = daemon.run_dir / "host" / "rest-frames"
    assert all(line.startswith("#") for line in file.read_text().splitlines())
    done = rc10_stop("host", run_dir=daemon.run_dir)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize("reader", ["gone", "asleep"])
def test_a_complaint_that_nobody_reads_ends_or_holds_up_nothing(
    reader: str, tmp_path: Path
) -> None:
    """Other drives still wait for their frames."""
    (tmp_path / "hero").mkdir()
    (tmp_path / "hero" / "rest-frames").write_text("no frame\n")
    with full_pipe() as full:
        read, closed = os.pipe()
        os.close(read)
        done = subprocess.run(
            [BIN / "rc10-stop", "--all"],
            stderr=closed if reader == "gone" else full,
            timeout=PATIENCE_S,
            check=False,
            env={**os.environ, "RC10_RUN_DIR": str(tmp_path)},
        )
        os.close(closed)
    assert done.returncode == 2
