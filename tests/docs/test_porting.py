"""Pages for those who come with programs of their own."""

from __future__ import annotations

import re

from pages import REPO


def text(page: str) -> str:
    return (REPO / "docs" / page).read_text(encoding="utf-8")


def test_every_public_name_of_the_stm32_library_is_on_the_porting_page() -> None:
    lines = (REPO / "tests/docs/stm32_names.txt").read_text(encoding="utf-8").splitlines()
    names = {name for line in lines if not line.startswith("#") for name in line.split()}
    assert len(names) > 60
    code = " ".join(re.findall(r"`([^`]+)`", text("porting-from-stm32.md")))
    missing = {name for name in names if not re.search(rf"\b{name}\b", code)}
    assert missing == set()


def test_every_header_for_robot_programs_is_named_and_no_other() -> None:
    there = {path.name for path in (REPO / "src/robot_client/rc10").glob("*.hpp")}
    named = set(re.findall(r"`rc10/(\w+\.hpp)`", text("robot-programs.md")))
    assert named == there


def test_the_line_that_makes_types_is_shown_for_both_languages() -> None:
    page = text("robot-programs.md")
    assert re.search(r"^lcm-gen -x .*\.lcm", page, re.M)
    assert re.search(r"^lcm-gen -p .*\.lcm", page, re.M)
