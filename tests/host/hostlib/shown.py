"""Output that a page shows, against what was printed."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hostlib.reader import Command

NUMBER = re.compile(r"-?\d+(\.\d+)?")
CLEAR_LINE = "\x1b[K"
# Two spaces are between the columns of a report; a colon ends a title.
ROW = re.compile(r"^ *(\S+(?: \S+)*?)(?:  +|: )\S")


def lines_of(text: str) -> list[str]:
    """Without what differs from run to run: numbers, and the columns that they widen."""
    lines = text.replace(CLEAR_LINE, "").splitlines()
    return [" ".join(NUMBER.sub("#", line).split()) for line in lines if line.strip()]


def missing_lines(shown: str, said: str) -> list[str]:
    """Lines of the page that were not printed; "..." is what the page leaves out."""
    printed = lines_of(said)
    missing = []
    for line in lines_of(shown):
        start, left_out, _ = line.partition("...")
        there = any(other.startswith(start) for other in printed) if left_out else line in printed
        if not there:
            missing.append(line)
    return missing


def assert_shown(command: Command, said: str) -> None:
    """Every line that the page shows of it was printed."""
    missing = missing_lines(command.output, said)
    assert missing == [], said


def rows_missing(shown: str, said: str) -> list[str]:
    """The same for a report, of whose rows the first cell is enough."""
    cells = {cell for line in said.splitlines() if (cell := _first_cell(line))}
    rows = [line for line in shown.splitlines() if _first_cell(line) not in cells]
    return missing_lines("\n".join(rows), said)


def _first_cell(line: str) -> str:
    """Without its numbers; empty for what is no row."""
    row = ROW.match(line)
    return NUMBER.sub("#", row[1]) if row else ""
