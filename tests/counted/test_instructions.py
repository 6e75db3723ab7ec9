"""Instructions of one tick, counted by valgrind: they are the same on a busy machine.

The goals of docs/performance.md, 10 k for 8 M3508 and 160 k for 128 motors, are those of packages,
which are optimised at link time. The limits are that page's figures of the preset `dev` and 3 %.
"""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from instructions import instructions_per_tick

REPO = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("RC10_BUILD", REPO / "build" / "dev"))
ROOM = 1.03
PAGE = (REPO / "docs" / "performance.md").read_text()


@pytest.mark.parametrize(("fleet", "dev_figure"), [("dji_8", 11_948), ("wide_4x32", 172_626)])
def test_a_tick_takes_no_more_instructions_than_when_its_goal_was_met(
    fleet: str, dev_figure: int
) -> None:
    count = instructions_per_tick(BUILD / "bin" / "tick_bench", fleet)
    assert count <= ROOM * dev_figure
    assert f"{dev_figure:,} for" in PAGE, "the page has another figure"


def test_a_tick_at_its_bounds_takes_no_more_than_the_page_says() -> None:
    """512 frames of each bus, 1,024 setpoints: more of either waits for the next tick."""
    count = instructions_per_tick(BUILD / "bin" / "tick_bench", "wide_4x32", "full")
    assert count <= ROOM * 1_045_137
    assert "take 1,045,137 instructions" in PAGE
