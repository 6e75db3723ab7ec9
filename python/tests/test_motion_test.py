"""A script stands for the rc10ctl that run_motion_test() runs."""

from __future__ import annotations

import os
import select
import signal
import subprocess
import sys
from pathlib import Path

import pytest

SCRIPT = """#!/bin/sh
exec 3> "$(dirname "$0")/told"
echo "$@" >&3
cat
echo ended >&3
"""
CALLER = """
import sys
from rc10.motion_test import run_motion_test

run_motion_test("wheel", "step", 60, max_current_a=12, program=sys.argv[1])
"""


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_its_rc10ctl_hears_how_ever_the_program_ends(
    tmp_path: Path, number: signal.Signals
) -> None:
    program = tmp_path / "rc10ctl"
    program.write_text(SCRIPT)
    program.chmod(0o700)
    os.mkfifo(tmp_path / "told")
    told = os.open(tmp_path / "told", os.O_RDWR)

    def line() -> str:
        assert select.select([told], [], [], 60.0)[0]
        return os.read(told, 4096).decode()

    # Its stdin is not what ends: that is held open here.
    with subprocess.Popen(
        [sys.executable, "-c", CALLER, program], stdin=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as caller:
        words = line().split()
        assert "--end-with-stdin" in words
        assert not select.select([told], [], [], 0.0)[0]
        caller.send_signal(number)
        caller.wait()
        assert line() == "ended\n"
    os.close(told)
