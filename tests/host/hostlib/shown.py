"""What a page shows of a command's output, against what the command printed."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hostlib.reader import Command

NUMBER = re.compile(r"-?\d+(\.\d+)?")
CLEAR_LINE = "\x1b[K"


def lines_of(text: str) -> list[str]:
    """Without what differs from run to run: numbers, and the columns that they widen."""
    lines = text.replace(CLEAR_LINE, "").splitlines()
    return [" ".join(NUMBER.sub("#", line).split()) for line in lines if line.strip()]


def assert_shown(command: Command, said: str) -> None:
    """Every line of the page stands there; "..." is what the page leaves out."""
    assert_lines(command.output, said)


def assert_lines(shown: str, said: str) -> None:
    """The same for a block that shows an output alone."""
    printed = lines_of(said)
    for line in lines_of(shown):
        start, left_out, _ = line.partition("...")
        if left_out:
            assert any(other.startswith(start) for other in printed), f"{line}\n{said}"
        else:
            assert line in printed, f"{line}\n{said}"
