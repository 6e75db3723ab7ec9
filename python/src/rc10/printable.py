"""Text of a stranger for a terminal: names on LCM and words of messages are anybody's to choose."""

from __future__ import annotations

import re

# As in rc10d's own log: control characters, with which escape sequences begin, the marks that turn
# the direction of writing, separators of lines, and what is no UTF-8.
_ACTS = re.compile("[\x00-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ud800-\udfff]")


def printable(text: object) -> str:
    """Returns the text with `?` for each character that acts; one line stays one line."""
    return _ACTS.sub("?", str(text))
