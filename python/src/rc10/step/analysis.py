"""Rise time, overshoot, settling time and steady-state error of a step response."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rc10.errors import MissingPackage

try:
    import numpy as np
except ImportError as error:
    raise MissingPackage("the analysis of a step", "numpy", "numpy") from error

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

# Where the steady state is taken from, and how long a response has to have stayed settled: the
# last part of the time after the step.
_STEADY_PART = 0.2
_SETTLED_PART = 0.05


@dataclass(frozen=True)
class StepMetrics:
    """Figures of a step response. Everything refers to the step that was asked for.

    Values are in the unit of the response, times in seconds after the step. NaN: it never got
    there.
    """

    start: float
    """Where it was before the step."""
    target: float
    rise_time_s: float
    """From 10 % to 90 % of the step."""
    overshoot_percent: float
    """The farthest beyond the target, in percent of the step; 0: never beyond it."""
    peak: float
    """The farthest in the direction of the step."""
    peak_time_s: float
    settling_time_s: float
    """After this it stays within the tolerance of the target."""
    tolerance: float
    """Tolerance band of settling_time_s, as a part of the step: 0.02 is ±2 %."""
    steady: float
    """The mean over the last fifth of the time."""

    @property
    def steady_error(self) -> float:
        """The target less the steady value."""
        return self.target - self.steady


def analyse(
    time_s: ArrayLike,
    response: ArrayLike,
    start: float,
    target: float,
    tolerance: float = 0.02,
) -> StepMetrics:
    """Judges a step from `start` to `target` that happened at time 0.

    Args:
        time_s: strictly increasing, in seconds; what is before 0 is not looked at.
        response: the measured values; NaN ones are left out.
        start: the value before the step.
        target: what was asked for.
        tolerance: when it counts as settled, as a part of the step.

    Raises:
        ValueError: no step, or fewer than three values after it.
    """
    times = np.asarray(time_s, dtype=np.float64)
    values = np.asarray(response, dtype=np.float64)
    if times.shape != values.shape or times.ndim != 1:
        raise ValueError(f"{times.size} times for {values.size} values")
    if not (math.isfinite(start) and math.isfinite(target)) or start == target:
        raise ValueError(f"from {start:g} to {target:g} is no step")
    if not 0.0 < tolerance < 1.0:
        raise ValueError(f"tolerance = {tolerance:g} is not within 0 to 1")
    used = (times >= 0.0) & np.isfinite(values)
    times, values = times[used], values[used]
    if len(times) < 3:
        raise ValueError("fewer than three values after the step")
    # 0 at the start, 1 at the target, whatever the direction.
    part = (values - start) / (target - start)
    end_s = times[-1]

    peak = int(np.argmax(part))
    steady = times >= end_s - _STEADY_PART * (end_s - times[0])
    return StepMetrics(
        start=start,
        target=target,
        rise_time_s=_first_above(times, part, 0.9) - _first_above(times, part, 0.1),
        overshoot_percent=max(0.0, float(part[peak]) - 1.0) * 100.0,
        peak=float(values[peak]),
        peak_time_s=float(times[peak]),
        settling_time_s=_settled_after(times, np.abs(part - 1.0), tolerance),
        tolerance=tolerance,
        steady=float(np.mean(values[steady])),
    )


def _first_above(times: NDArray[np.float64], part: NDArray[np.float64], level: float) -> float:
    above = np.flatnonzero(part >= level)
    if not len(above):
        return math.nan
    at = int(above[0])
    return float(times[0]) if at == 0 else _crossing(times, part, at, level)


def _settled_after(
    times: NDArray[np.float64], distance: NDArray[np.float64], tolerance: float
) -> float:
    outside = np.flatnonzero(distance > tolerance)
    if not len(outside):
        return float(times[0])
    last = int(outside[-1])
    # To pass through the band when the time is over is not to have settled.
    if times[last] > times[-1] - _SETTLED_PART * (times[-1] - times[0]) or last + 1 >= len(times):
        return math.nan
    return _crossing(times, distance, last + 1, tolerance)


def _crossing(
    times: NDArray[np.float64], values: NDArray[np.float64], at: int, level: float
) -> float:
    """The instant between two samples at which the level is crossed."""
    before, after = float(values[at - 1]), float(values[at])
    share = (level - before) / (after - before)
    return float(times[at - 1] + share * (times[at] - times[at - 1]))
