"""rc10-irq on a computer without CAN: its command line."""

from __future__ import annotations

import subprocess

import pytest
from hostlib.daemon import BIN


def rc10_irq(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [BIN / "rc10-irq", *words], capture_output=True, text=True, timeout=60, check=False
    )


def test_help_explains_the_exit_status() -> None:
    done = rc10_irq("--help")
    assert done.returncode == 0
    assert "Exit status" in done.stdout


@pytest.mark.parametrize("words", [["--priority", "99"], ["--priority", "high"], ["--wait"]])
def test_bad_usage_is_refused(words: list[str]) -> None:
    done = rc10_irq(*words)
    assert done.returncode == 2
    assert "--help" in done.stderr


@pytest.mark.parametrize("interface", ["nocan9", "lo", "../net/lo"])
def test_what_is_no_can_interface_is_named(interface: str) -> None:
    done = rc10_irq(interface)
    assert done.returncode == 1
    assert f"{interface}: there is no such CAN interface" in done.stderr
