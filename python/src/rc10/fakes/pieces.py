"""Time in pieces that are short enough to integrate a motion over."""

from __future__ import annotations

import math


def pieces(dt_s: float, longest_s: float) -> list[float]:
    """Equal parts of `dt_s` seconds, each at most `longest_s`.

    Raises:
        ValueError: dt_s is not positive.
    """
    if not dt_s > 0:
        raise ValueError(f"dt_s = {dt_s} must be positive")
    count = max(1, math.ceil(dt_s / longest_s - 1e-9))
    return [dt_s / count] * count
