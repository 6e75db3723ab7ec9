"""The clock of a control loop that also keeps the link served."""

from __future__ import annotations

from typing import Callable


class Grid:
    """Instants that are a whole number of periods after the first, so errors do not add up.

    Grid points that were overrun are skipped and counted in `missed`, never made up for.
    """

    def __init__(self, hz: float, now: Callable[[], float]) -> None:
        if not 0 < hz <= 10_000:
            raise ValueError(f"rate: hz = {hz} is not within 0 to 10000")
        self.missed = 0
        self._period_s = 1.0 / hz
        self._now = now
        self._start_s = 0.0
        self._step = -1

    def advance(self) -> float:
        """Goes to the next grid point and returns when it is due."""
        if self._step < 0:
            self._start_s = self._now()
        self._step += 1
        late = int((self._now() - self._start_s) / self._period_s) - self._step
        if late > 0:
            self.missed += late
            self._step += late
        return self._start_s + self._step * self._period_s

    @property
    def elapsed_s(self) -> float:
        """Seconds from the first grid point to this one."""
        return self._step * self._period_s


class Rate(Grid):
    """Iterates on an absolute grid and receives while it waits.

    The first step comes at once, every later one a whole number of periods after it, so that
    errors do not add up. Grid points that the loop's body overran are skipped and counted in
    `missed`; they are never made up for. Each step yields the seconds since the first one.
    """

    def __init__(
        self, hz: float, now: Callable[[], float], pump: Callable[[float], object]
    ) -> None:
        super().__init__(hz, now)
        self._pump = pump

    def __iter__(self) -> Rate:
        return self

    def __next__(self) -> float:
        due_s = self.advance()
        # Once in any case: a loop that is always late must not become deaf.
        self._pump(0.0)
        while (left_s := due_s - self._now()) > 0:
            self._pump(left_s)
        return self.elapsed_s
