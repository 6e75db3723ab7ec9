"""Time is cut into equal pieces that are short enough."""

from __future__ import annotations

import math

import pytest

from rc10.fakes.pieces import pieces


@pytest.mark.parametrize(
    ("dt_s", "count"), [(0.0001, 1), (0.0005, 1), (0.0006, 2), (0.001, 2), (0.0101, 21), (1e-15, 1)]
)
def test_they_are_equal_fill_the_time_and_are_no_more_than_it_takes(
    dt_s: float, count: int
) -> None:
    parts = pieces(dt_s, 0.0005)
    assert len(parts) == count
    assert len(set(parts)) == 1
    assert math.isclose(sum(parts), dt_s)


@pytest.mark.parametrize("dt_s", [0.0, -0.001, math.nan])
def test_time_that_does_not_pass_is_refused(dt_s: float) -> None:
    with pytest.raises(ValueError, match="must be positive"):
        pieces(dt_s, 0.001)
