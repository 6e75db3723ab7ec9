"""Every robot that a page shows is one that rc10d accepts."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from hostlib.daemon import BIN, REPO
from hostlib.page import robots

PAGES = sorted([*REPO.glob("*.md"), *REPO.glob("docs/**/*.md")])
SHOWN = [(str(page.relative_to(REPO)), robot) for page in PAGES for robot in robots(page)]


def test_pages_show_robots() -> None:
    assert len(SHOWN) >= 10


@pytest.mark.parametrize(("page", "robot"), SHOWN, ids=[page for page, _ in SHOWN])
def test_a_robot_is_accepted(page: str, robot: str, tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(robot, encoding="utf-8")
    done = subprocess.run(
        [BIN / "rc10d", "--check", file], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{page}\n{done.stderr}"
