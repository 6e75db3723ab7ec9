"""Notices that the program stood still, and waits for news of after that."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rc10.state import RobotState

PAUSE_S = 0.1
"""Time between two turns of a loop that shows a pause: a signal, a busy computer."""


class CatchUp:
    """After a pause of this program what it knows is old: a motor may have been enabled anew.

    Then nothing is sent before a state of after the pause was judged.

    Attributes:
        resumed_s: end of the last pause; before the first, minus infinity.
    """

    def __init__(self, now_s: float, pause_s: float = PAUSE_S) -> None:
        self.resumed_s = -math.inf
        self._pause_s = pause_s
        self._last_s = now_s

    def done(self, now_s: float, newest: RobotState | None) -> bool:
        """In each turn, after receiving: whether `newest` may be believed."""
        if now_s - self._last_s > self._pause_s:
            self.resumed_s = now_s
        self._last_s = now_s
        return newest is not None and newest.taken_at_s >= self.resumed_s
