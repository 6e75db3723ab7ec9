"""Charts of pages are drawn from the tables beside them, wiring by its script."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from pages import REPO

sys.path.insert(0, str(REPO / "scripts/lib"))
from performance_charts import Chart, Group, charts, cost, families, peers, svg
from wiring_drawings import drawings


@pytest.mark.parametrize("path", charts(), ids=lambda path: path.name)
def test_a_chart_shows_its_table_as_it_is_now(path: Path) -> None:
    assert path.read_text(encoding="utf-8") == charts()[path], (
        "draw it anew: scripts/lib/performance_charts.py"
    )


@pytest.mark.parametrize("path", drawings(), ids=lambda path: path.name)
def test_a_wiring_drawing_is_what_its_script_draws(path: Path) -> None:
    assert path.read_text(encoding="utf-8") == drawings()[path], (
        "draw it anew: scripts/lib/wiring_drawings.py"
    )


def test_tables_are_read_with_what_they_lack() -> None:
    text = "| drives at 1 kHz | kernel | a | `b` |\n|---|---|---|---|\n| 4 X | RT | 12.5 | none |\n"
    assert cost(text).series == ["a", "b"]
    assert cost(text).groups == [Group("4 X, RT", [12.5, None])]
    text = (
        "| robot | motors | frames | tick |\n|---|---|---|---|\n| DJI | 4 | 4.0, 1.0 | 1.1 µs |\n"
    )
    assert families(text).groups == [Group("DJI, 4 motors", [1.1])]
    text = "| drives | program | CPU |\n|---|---|---|\n| 4 X | a | 38 µs |\n| 4 X | b | none |\n"
    assert peers(text).groups == [Group("4 X, a", [38.0])]


def test_a_bar_is_as_long_as_its_value_says() -> None:
    drawn = svg(Chart("t", "k", ["one", "two"], [Group("g", [50.0, 100.0])]))
    assert 'width="250.0"' in drawn
    assert 'width="500.0"' in drawn
