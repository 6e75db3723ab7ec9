"""The word that was meant."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


def did_you_mean(typed: str, known: Iterable[str]) -> str:
    """Returns "; did you mean NAME?", or nothing if none of `known` is near."""
    near = get_close_matches(typed, list(known), n=1)
    return f"; did you mean {near[0]}?" if near else ""


def meant(robot: str, heard: Iterable[str]) -> str:
    """Says that the robot is none of those that are heard, and which it may be."""
    return f"'{robot}' is none of them" + (did_you_mean(robot, heard) or ".")
