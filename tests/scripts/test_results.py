"""`suite` and `step` of scripts/lib/results.sh: results of runners and of single commands."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]
OK = "echo '3 passed, 0 failed, 0 skipped'"


def part(*runners: str) -> tuple[str, int, str]:
    """Last line, status and whole output of a part that runs these."""
    suites = "".join(f"suite number_{i} sh -c {runner!r}\n" for i, runner in enumerate(runners))
    done = subprocess.run(
        ["bash", "-ec", f"set -uo pipefail; . '{REPO}/scripts/lib/results.sh'\n{suites}finish"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr == ""
    return done.stdout.splitlines()[-1], done.returncode, done.stdout


def test_counts_of_all_runners_are_added() -> None:
    last, status, shown = part(f"echo details; {OK}", "echo '1 passed, 0 failed, 0 skipped'")
    assert (last, status) == ("4 passed, 0 failed, 0 skipped", 0)
    assert "details" in shown


def test_a_failure_is_counted_once() -> None:
    last, status, _ = part("echo '2 passed, 1 failed, 0 skipped'; exit 1", OK)
    assert (last, status) == ("5 passed, 1 failed, 0 skipped", 1)


def test_a_skip_with_status_1_is_no_failure() -> None:
    last, status, _ = part("echo '2 passed, 0 failed, 1 skipped'; exit 1")
    assert (last, status) == ("2 passed, 0 failed, 1 skipped", 0)


@pytest.mark.parametrize(
    ("runner", "why"),
    [
        ("echo crashed; exit 139", "it ended without a result"),
        (f"{OK}; exit 1", "status 1"),
        ("echo '2 passed, 0 failed, 1 skipped'; exit 139", "status 139"),
        ("echo '0 passed, 0 failed, 0 skipped'", "it ran no test"),
    ],
)
def test_a_runner_that_does_not_end_well_is_a_failure(runner: str, why: str) -> None:
    last, status, shown = part(runner, OK)
    assert " 1 failed, " in last
    assert status == 1
    assert f"FAILED number_0: {why}" in shown


def test_a_function_fails_at_its_first_line_that_fails() -> None:
    for library, verb in (("results", "step"), ("checks", "check")):
        script = (
            f"set -euo pipefail; . '{REPO}/scripts/lib/{library}.sh'\n"
            f"breaks() {{ false; echo goes on; }}\n{verb} breaks breaks\n"
            f"holds() {{ true; }}\n{verb} holds holds\nfinish"
        )
        done = subprocess.run(
            ["bash", "-c", script],
            capture_output=True,
            text=True,
            check=False,
        )
        assert (done.returncode, done.stderr) == (1, "")
        assert "goes on" not in done.stdout
        assert done.stdout.splitlines()[-1] == "1 passed, 1 failed, 0 skipped"


def test_guests_of_another_processor_are_skipped(tmp_path: Path) -> None:
    """As on a Raspberry Pi: a skip, which is told, and no failure."""
    uname = tmp_path / "uname"
    uname.write_text("#!/bin/sh\necho aarch64\n")
    uname.chmod(0o755)
    done = subprocess.run(
        [
            "bash",
            "-ec",
            f". '{REPO}/scripts/lib/results.sh'; in_guests g false; suite s sh -c \"{OK}\"; finish",
        ],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"},
    )
    assert "SKIPPED g: its guests are computers of x86, this one is aarch64" in done.stdout
    assert done.stdout.splitlines()[-1] == "3 passed, 0 failed, 1 skipped"
