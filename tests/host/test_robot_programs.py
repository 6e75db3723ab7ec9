"""Programs as users write them, against the whole rc10d."""

from __future__ import annotations

import os
import signal
import subprocess
from typing import TYPE_CHECKING

from hostlib import Daemon, Program
from hostlib.daemon import BIN, REPO
from hostlib.page import blocks_run_by

if TYPE_CHECKING:
    from pathlib import Path


def hello_motor(*words: str) -> Program:
    """The example of docs/robot-programs.md."""
    return Program(BIN / "hello_motor", *words)


def test_a_cpp_program_enables_moves_and_lets_go(daemon: Daemon) -> None:
    with hello_motor("host", "yaw", "450") as program:
        moving = daemon.wait_motor("yaw", lambda m: m["mode"] == "total_angle", "is moved")
        assert moving["status"] == "ACTIVE"
        assert moving["owner"] == "hello-motor"
        assert moving["target"] == 450
        assert abs(float(program.wait_line(r"^yaw stands at (\S+) deg$")[1]) - 450) < 2
        assert program.wait() == 0, program.output
    yaw = daemon.wait_motor("yaw", lambda m: m["status"] == "READY", "is disabled")
    assert yaw["mode"] == "coast"


def test_a_cpp_program_that_is_killed_lets_go(daemon: Daemon) -> None:
    with hello_motor("host", "wheel") as program:
        daemon.wait_motor("wheel", lambda m: m["velocity_rpm"] > 50, "turns")
        program.signal(signal.SIGKILL)
        wheel = daemon.wait_motor("wheel", lambda m: m["mode"] == "coast", "has no target")
        assert wheel["owner"] == ""


def test_a_cpp_program_says_what_is_wrong(daemon: Daemon) -> None:
    with hello_motor("hots", "yaw") as program:
        assert program.wait() == 1
        assert "Heard here: robot 'host': is the name right?" in program.output
    with hello_motor("host", "jaw") as program:
        assert program.wait() == 1
        assert "there is no motor 'jaw'; the motors are: wheel, other, yaw" in program.output
    daemon.must("estop")
    with hello_motor("host", "yaw") as program:
        assert program.wait() == 1
        assert "yaw: the robot is in ESTOP: clear it first" in program.output


def test_the_page_s_lines_make_types_for_both_languages(tmp_path: Path) -> None:
    (block,) = blocks_run_by("tests/host/test_robot_programs.py", REPO / "docs/robot-programs.md")
    (tmp_path / "pose_t.lcm").write_text("struct pose_t { double x_m; double y_m; }\n")
    (tmp_path / "bin").mkdir()
    # Debian's: a Python environment may have one of its own.
    (tmp_path / "bin" / "lcm-gen").symlink_to("/usr/bin/lcm-gen")
    subprocess.run(
        ["bash", "-ec", block.text],
        cwd=tmp_path,
        env={**os.environ, "PATH": f"{tmp_path}/bin:{os.environ['PATH']}"},
        check=True,
    )
    assert (tmp_path / "generated" / "pose_t.hpp").is_file()
    assert (tmp_path / "generated" / "pose_t.py").is_file()
