"""Commands that pages show for a shell, run in their order against simulated robots.

How a page marks what cannot run here: CONTRIBUTING.md.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import pytest
from hostlib import eventually
from hostlib.daemon import REPO
from hostlib.page import blocks, robots
from hostlib.reader import Command, Reader, commands, headings
from hostlib.shown import rows_missing

DEMO = REPO / "config" / "demo.yaml"
LIFT = """
robot: lift
realtime: preferred
profiles:
  m3508: {model: M3508, feedback_timeout_ms: 1000, zero: power_on}
buses:
  - name: lift
    type: sim
    motors:
      - {name: lift_left, profile: m3508, id: 1}
      - {name: lift_right, profile: m3508, id: 2}
"""
WRONG = """robot: hero
buses:
  - name: chassis
    interface: can0
    motors:
      - {name: left, model: M3508, id: 05}
      - {name: right, model: M3508, id: 9, curent_limit_a: 10}
      - {name: yaw, model: GM6020, id: 1, current_limit_a: 20}
      - {name: roll, model: M3508, id: 5}
"""


class Scene(NamedTuple):
    """The files before a page is read."""

    robot: str = ""  # that runs already
    files: Mapping[str, str] = {}


def lift() -> str:
    module = next(b.text for b in blocks(REPO / "docs" / "modules.md") if "name: lift" in b.text)
    return LIFT + module


def ported() -> str:
    return next(text for text in robots(REPO / "docs/porting-from-stm32.md") if "lift" in text)


SCENES = {
    "README.md": Scene(robot=DEMO.read_text(), files={"bad.yaml": WRONG}),
    "docs/adding-a-motor.md": Scene(),
    "docs/blackbox.md": Scene(robot=DEMO.read_text()),
    "docs/configuration.md": Scene(files={"bad.yaml": WRONG}),
    "docs/modules.md": Scene(robot=lift()),
    "docs/porting-from-stm32.md": Scene(files={"robot.yaml": ported()}),
    "docs/quick-start.md": Scene(),
    "docs/rc10ctl.md": Scene(robot=DEMO.read_text()),
    "python/README.md": Scene(robot=DEMO.read_text()),
}
# They add the route of the multicast.
WITH_ROUTE = {"docs/quick-start.md", "python/README.md"}
# Pages that a test of their own reads.
READ_ELSEWHERE = {"docs/first-motor.md", "docs/python.md", "docs/tuning.md"}
SHELL = {"sh", "console"}
# Whose Python is a program beside the commands.
WITH_PROGRAMS = {"README.md", "python/README.md"}
# The translations show what their originals show: tests/docs.
PAGES = [
    page
    for page in sorted(
        [
            *REPO.glob("*.md"),
            *REPO.glob("docs/**/*.md"),
            *REPO.glob("examples/**/*.md"),
            REPO / "python" / "README.md",
            *REPO.glob("tests/*/README.md"),
        ]
    )
    if not page.name.endswith(".zh-CN.md")
]


def test_every_page_that_shows_commands_is_read() -> None:
    shown = {
        str(page.relative_to(REPO))
        for page in PAGES
        if any(block.kind in SHELL for block in blocks(page))
    }
    assert shown == SCENES.keys() | READ_ELSEWHERE


def await_rows(reader: Reader, shown: str) -> None:
    """Waits for the output that a page shows of the block before: a server may go on printing."""
    eventually(lambda: not rows_missing(shown, reader.printed), f"printed: {shown}")


def read(name: str, folder: Path) -> None:
    scene = SCENES[name]
    with Reader(folder) as reader:
        for file, text in scene.files.items():
            (folder / file).write_text(text)
        if scene.robot:
            (folder / "robot.yaml").write_text(scene.robot)
            reader.serve("rc10d -c robot.yaml")
        if name == "docs/blackbox.md":
            reader.run(Command("rc10ctl estop", ""))
            copies = eventually(lambda: list(reader.run_dir.glob("*-estop.blackbox")), "a copy")
            reader.replace |= {"FILE": str(copies[0]), "DIR": "out"}
        for block in blocks(REPO / name):
            if block.kind in SHELL:
                reader.read(block)
            elif block.kind == "text":
                await_rows(reader, block.text)
            elif block.kind == "python" and name in WITH_PROGRAMS:
                (folder / "program.py").write_text(block.text)
                reader.run(Command("python program.py", ""))


# Some programs, on a machine that may be busy.
@pytest.mark.timeout(300)
@pytest.mark.parametrize("name", sorted(SCENES.keys() - WITH_ROUTE))
def test_what_a_page_shows_works(name: str, tmp_path: Path) -> None:
    read(name, tmp_path)


@pytest.mark.timeout(300)
@pytest.mark.usefixtures("no_route")
def test_the_quick_start_leads_to_a_motor_that_turns_and_a_picture_of_its_step(
    tmp_path: Path,
) -> None:
    read("docs/quick-start.md", tmp_path)
    assert (tmp_path / "step.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.timeout(300)
@pytest.mark.usefixtures("no_route")
def test_the_page_of_the_python_package_leads_to_a_program_that_runs(tmp_path: Path) -> None:
    read("python/README.md", tmp_path)


def test_a_command_that_ends_otherwise_than_shown_is_told(tmp_path: Path) -> None:
    with Reader(tmp_path) as reader:
        for text, output in (
            ("exit 1", ""),
            ("true", "rc10ctl: no"),
            ("echo rc10ctl: yes; exit 1", "rc10ctl: no\n"),
            ("printf 'BUS  LOAD\\narm  1 %%\\n'", "BUS  STATE  LOAD\n"),
            ("printf 'BUS  LOAD\\narm  1 %%\\n'", "BUS  LOAD\nleg  1 %\n"),
        ):
            with pytest.raises(AssertionError, match=re.escape(text)):
                reader.run(Command(text, output))
        reader.run(Command("printf 'BUS  LOAD\\narm  1 %%\\n'", "BUS    LOAD\narm  100 %\n"))


def test_a_shown_complaint_is_a_command_that_fails() -> None:
    page = REPO / "docs" / "rc10ctl.md"
    shown = [c for block in blocks(page) if block.kind == "console" for c in commands(block)]
    assert [c.text for c in shown if c.fails][:2] == [
        "rc10ctl set front_left velocity 120 --for 1s",
        "rc10ctl zero rear_left",
    ]


def test_titles_and_rows_of_tables_are_compared_and_figures_are_not() -> None:
    text = "robot demo  tick 4982\nTIME             P50    P99.9\nwake-up latency  30 us  1 us\n"
    text += "  predicted worst  68 %\nmissed ticks 8, page faults 0\nREADY\n"
    assert headings(text) == {"robot demo", "TIME P50 P99.9", "TIME", "wake-up latency"} | {
        "predicted worst"
    }
