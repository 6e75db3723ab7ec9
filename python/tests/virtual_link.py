"""An in-process link whose time passes only while the client waits for nothing."""

from __future__ import annotations

import heapq
import itertools
from typing import Callable

from rc10.link import LcmLink


class VirtualLink(LcmLink):
    def __init__(self) -> None:
        super().__init__("memq://")
        self.time_s = 1000.0
        self._order = itertools.count()
        self._due: list[tuple[float, int, Callable[[], None]]] = []

    def now(self) -> float:
        return self.time_s

    def after(self, delay_s: float, action: Callable[[], None]) -> None:
        """Calls `action` once, when so much time has passed."""
        heapq.heappush(self._due, (self.time_s + delay_s, next(self._order), action))

    def pass_time(self, seconds: float) -> None:
        """Lets time pass while the client does something else than receive."""
        self._pass_until(self.time_s + seconds, lambda: False)

    def _sleep(self, timeout_s: float) -> bool:
        if not self._readable(0.0):
            self._pass_until(self.time_s + timeout_s, lambda: self._readable(0.0))
        return self._readable(0.0)

    def _pass_until(self, end_s: float, enough: Callable[[], bool]) -> None:
        while self._due and self._due[0][0] <= end_s:
            self.time_s, _, action = heapq.heappop(self._due)
            action()
            if enough():
                return
        self.time_s = end_s
