"""Validity of commands: how long they act without being sent again."""

from __future__ import annotations

DEFAULT_VALIDITY_MS = 50
"""Given by rc10d to a message that says 0."""
MAX_VALIDITY_MS = 1000
"""rc10d refuses a longer one."""
ENDED_MS = 1
"""The shortest: what was sent before, said again with it, ends in the next ticks."""


def lapses_at(now_s: float, validity_ms: int) -> float:
    """When a command ends that is sent now."""
    return now_s + (validity_ms or DEFAULT_VALIDITY_MS) / 1000


def check_validity(validity_ms: int) -> None:
    """Raises a ValueError unless rc10d takes this validity; 0 stands for its default."""
    if not 0 <= validity_ms <= MAX_VALIDITY_MS:
        raise ValueError(
            f"validity_ms = {validity_ms} is out of range; use 1 to {MAX_VALIDITY_MS}, "
            f"or 0 for {DEFAULT_VALIDITY_MS}: a command that acts for longer is sent again"
        )
