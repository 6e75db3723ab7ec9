"""VOFA+'s JustFloat: little-endian 32 bit floats, then a tail that no float of ours can be."""

from __future__ import annotations

import math
import struct
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

JUSTFLOAT_TAIL = b"\x00\x00\x80\x7f"
"""Infinity as a float: it ends a frame, so no value may be infinite."""

_LARGEST = 3.4028234663852886e38


def justfloat(values: Sequence[float]) -> bytes:
    """Returns one frame: a sample of every channel. What is too large becomes the largest."""
    within = [v if math.isnan(v) else max(-_LARGEST, min(_LARGEST, v)) for v in values]
    return struct.pack(f"<{len(within)}f", *within) + JUSTFLOAT_TAIL
