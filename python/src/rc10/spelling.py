"""The word that was meant."""

from __future__ import annotations

from difflib import get_close_matches
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable


def did_you_mean(typed: str, known: Iterable[str]) -> str:
    """Returns "; did you mean NAME?", or nothing if none of `known` is near."""
    by_plain = {_plain(name): name for name in known}
    near = get_close_matches(_plain(typed), list(by_plain), n=1)
    return f"; did you mean {by_plain[near[0]]}?" if near else ""


def _plain(name: str) -> str:
    """Capitals and hyphens are not what makes a name another one."""
    return name.lower().replace("-", "_")


def not_one_of(text: str, word: str, known: Iterable[str]) -> str:
    """Says that a word of `text` is none of those that are known."""
    names = list(known)
    return f"{text!r}: {word!r} is not one of {', '.join(names)}{did_you_mean(word, names)}"


def meant(robot: str, heard: Iterable[str]) -> str:
    """Says that the robot is none of those that are heard, and which it may be."""
    return f"'{robot}' is none of them" + (did_you_mean(robot, heard) or ".")
