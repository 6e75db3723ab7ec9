"""Every robot that a page shows is one that rc10d accepts, and so is every part of one."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from hostlib.daemon import BIN, REPO
from hostlib.page import ROBOT, blocks, robots

PAGES = sorted([*REPO.glob("*.md"), *REPO.glob("docs/**/*.md")])
SHOWN = [(str(page.relative_to(REPO)), robot) for page in PAGES for robot in robots(page)]

# Motors and modules that the shown parts need.
MOTORS = "[{name: lift_left, model: M3508, id: 1}, {name: lift_right, model: M3508, id: 2}]"
SIMULATED = f"buses: [{{name: none, type: sim, motors: {MOTORS}}}]\n"
CHASSIS = """\
  - name: base
    type: mecanum_chassis
    wheels: {front_left: fl, front_right: fr, rear_left: rl, rear_right: rr}
    wheel_radius_m: 0.076
    track_m: 0.5
    wheelbase_m: 0.4
    max_speed_m_s: 2
    max_turn_deg_s: 180
    max_acceleration_m_s2: 3
    max_turn_acceleration_deg_s2: 360
"""
WHEELS = "buses: [{name: none, type: sim, motors: [" + (
    ", ".join(
        f"{{name: {name}, model: M3508, id: {number}}}"
        for number, name in enumerate(("fl", "fr", "rl", "rr"), start=1)
    )
    + "]}]\n"
)
SERIAL_LINK = "modules:\n  - name: claw\n    type: serial_link\n    port: /dev/board\n"


def completed(part: str) -> str:
    """A robot with this part in its place."""
    if part.startswith("buses:"):
        return part if "motors:" in part else f"{part}    motors: {MOTORS}\n"
    if part.startswith("motors:"):
        indented = "".join(f"    {line}" for line in part.splitlines(keepends=True))
        return f"buses:\n  - name: bus\n    interface: can0\n{indented}"
    if part.startswith("modules:"):
        return part + SIMULATED
    if part.startswith("  - "):
        return f"modules:\n{part}{CHASSIS}{WHEELS}"
    if part.startswith("    "):
        return SERIAL_LINK + part + SIMULATED
    return part + SIMULATED


PARTS = [
    (str(page.relative_to(REPO)), completed(block.text))
    for page in PAGES
    for block in blocks(page)
    if block.kind == "yaml" and not ROBOT.match(block.text)
]


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


@pytest.mark.parametrize(("page", "robot"), PARTS, ids=[page for page, _ in PARTS])
def test_a_part_of_a_robot_is_accepted(page: str, robot: str, tmp_path: Path) -> None:
    test_a_robot_is_accepted(page, f"robot: page\n{robot}", tmp_path)
