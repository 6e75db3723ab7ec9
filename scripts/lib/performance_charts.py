#!/usr/bin/env python3
"""Draws the charts of docs/performance.md from its tables.

usage: scripts/lib/performance_charts.py     (writes docs/images/performance-*.svg)
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import escape

REPO = Path(__file__).resolve().parents[2]
PAGE = REPO / "docs/performance.md"
IMAGES = REPO / "docs/images"

# Okabe and Ito's colours, told apart by everybody; a grey that white and dark pages bear.
COLOURS = ("#9aa4ae", "#0072b2", "#56b4e9", "#e69f00")
TEXT = "#7d8590"
LABEL_PX, BARS_PX, VALUE_PX = 240, 500, 70
BAR_PX, GAP_PX, GROUP_GAP_PX, LINE_PX = 16, 3, 10, 18


class Group(NamedTuple):
    """Bars side by side."""

    label: str
    values: list[float | None]


class Chart(NamedTuple):
    title: str
    unit: str
    series: list[str]
    groups: list[Group]


def rows_below(text: str, first_cell: str) -> list[list[str]]:
    """The table whose header begins with this cell: its rows, the header first."""
    lines = text[text.index(f"| {first_cell} |") :].splitlines()
    table = []
    for line in lines:
        if not line.startswith("|"):
            break
        table.append([cell.strip().replace("`", "") for cell in line.strip("|").split("|")])
    return [table[0], *table[2:]]


def number(cell: str) -> float | None:
    found = re.match(r"\d+(\.\d+)?", cell)
    return float(found[0]) if found else None


def cost(text: str) -> Chart:
    header, *rows = rows_below(text, "drives at 1 kHz")
    groups = [Group(f"{row[0]}, {row[1]}", [number(cell) for cell in row[2:]]) for row in rows]
    return Chart("Instructions in each millisecond, thousands", "k", header[2:], groups)


def families(text: str) -> Chart:
    _, *rows = rows_below(text, "robot")
    groups = [Group(f"{row[0]}, {row[1]} motors", [number(row[3])]) for row in rows]
    return Chart("CPU time of a tick, median", "µs", [], groups)


def peers(text: str) -> Chart:
    _, *rows = rows_below(text, "drives")
    groups = [Group(f"{row[0]}, {row[1]}", [number(row[2])]) for row in rows if number(row[2])]
    return Chart("CPU time in each millisecond, median", "µs", [], groups)


def text_at(x: float, y: float, text: str, more: str = "") -> str:
    return f'<text x="{x:.0f}" y="{y:.0f}"{more}>{escape(text)}</text>'


def bar_at(x: float, y: float, width: float, height: float, colour: str) -> str:
    return f'<rect x="{x:.0f}" y="{y:.0f}" width="{width:.1f}" height="{height}" fill="{colour}"/>'


def svg(chart: Chart) -> str:
    most = max(value for group in chart.groups for value in group.values if value is not None)
    parts = [text_at(LABEL_PX, 20, chart.title, ' font-size="14" font-weight="bold"')]
    y = 20
    for index, name in enumerate(chart.series):
        y += LINE_PX
        parts.append(bar_at(LABEL_PX, y - 10, 12, 12, COLOURS[index]))
        parts.append(text_at(LABEL_PX + 18, y, name))
    y += GROUP_GAP_PX
    for group in chart.groups:
        height = len(group.values) * (BAR_PX + GAP_PX)
        parts.append(text_at(LABEL_PX - 10, y + height / 2 + 3, group.label, ' text-anchor="end"'))
        for index, value in enumerate(group.values):
            if value is not None:
                colour = COLOURS[index] if chart.series else COLOURS[1]
                width = value / most * BARS_PX
                parts.append(bar_at(LABEL_PX, y, width, BAR_PX, colour))
                parts.append(text_at(LABEL_PX + width + 6, y + 13, f"{value:.1f} {chart.unit}"))
            y += BAR_PX + GAP_PX
        y += GROUP_GAP_PX
    box = f"0 0 {LABEL_PX + BARS_PX + VALUE_PX} {y}"
    font = f'font-family="Helvetica, Arial, sans-serif" font-size="12" fill="{TEXT}"'
    head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="{box}" role="img" {font}>'
    return "\n".join([head, f"<title>{escape(chart.title)}</title>", *parts, "</svg>\n"])


def charts() -> dict[Path, str]:
    text = PAGE.read_text(encoding="utf-8")
    return {
        IMAGES / "performance-cost.svg": svg(cost(text)),
        IMAGES / "performance-families.svg": svg(families(text)),
        IMAGES / "performance-peers.svg": svg(peers(text)),
    }


if __name__ == "__main__":
    for path, drawing in charts().items():
        path.write_text(drawing, encoding="utf-8")
