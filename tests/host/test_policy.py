"""The policy loop of docs/python.md drives twelve simulated joints."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from hostlib import Daemon
from hostlib.daemon import REPO
from hostlib.page import blocks_run_by, robots

PAGE = REPO / "docs" / "python.md"
# Ends the endless loop of the page after a second of its time.
POLICY = """
import numpy as np

turns = 0

def policy(observation):
    global turns
    assert observation.shape == (36,)
    turns += 1
    if turns == 50:
        raise SystemExit(0)
    return np.full(12, 0.1)
"""


def test_twelve_joints_follow_a_policy(tmp_path: Path) -> None:
    [loop] = blocks_run_by("tests/host/test_policy.py", PAGE)
    [dog] = [text for text in robots(PAGE) if text.startswith("robot: dog")]
    (tmp_path / "my_policy.py").write_text(POLICY, encoding="utf-8")
    patient = dog.replace("on_timeout: damp", "on_timeout: damp, feedback_timeout_ms: 1000")
    with Daemon(patient) as daemon:
        daemon.wait_ready()
        done = subprocess.run(
            [sys.executable, "-c", loop.text],
            cwd=tmp_path,
            env={**os.environ, **daemon.env, "PYTHONPATH": f"{os.environ.get('PYTHONPATH', '')}:."},
            capture_output=True,
            text=True,
            timeout=100,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        state = daemon.wait_motors(lambda motor: motor["acting"] == "damp", "every joint is damped")
        angles = [float(motor["total_angle_deg"]) for motor in state["motors"]]
        assert angles == pytest.approx([5.73] * 12, abs=3)  # 0.1 rad, short of it by friction
