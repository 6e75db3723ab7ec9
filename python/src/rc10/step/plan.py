"""Plan of a step."""

from __future__ import annotations

from dataclasses import dataclass

from rc10.setpoints import Mode

MODES = (Mode.VELOCITY, Mode.ANGLE, Mode.TOTAL_ANGLE, Mode.CURRENT)
"""The modes whose target is followed by something measured."""


@dataclass(frozen=True)
class StepPlan:
    """Settings of a step.

    Raises:
        ValueError: a mode without a response, or a time or a tolerance out of its range.
    """

    motor: str
    mode: Mode
    value: float
    """The target, in the unit of the mode."""
    relative: bool = False
    """The value counts from where the motor stands; angles only."""
    base: float = 0.0
    """The target before the step and after it; angles: where the motor stands."""
    before_s: float = 0.25
    seconds: float = 1.5
    """Duration of the step."""
    tolerance: float = 0.02
    """When it counts as settled, as a part of the step; between 0 and 1."""
    enable: bool = False
    """Enable the motor if it is READY; else it has to be ACTIVE. Its end is the `at_end` of the
    program's rc10.connect()."""

    def __post_init__(self) -> None:
        """Refuses before anything moves."""
        if self.mode not in MODES:
            raise ValueError(
                f"{self.mode.name.lower()}: no step of this mode; there are: "
                + ", ".join(mode.name.lower() for mode in MODES)
            )
        if not (0.05 <= self.seconds <= 60.0 and 0.0 <= self.before_s <= 10.0):
            raise ValueError("a step lasts 0.05 to 60 s, after 10 s of waiting at most")
        if not 0.0 < self.tolerance < 1.0:
            raise ValueError(
                f"a tolerance of {self.tolerance * 100.0:g} % is not between 0 and 100 %"
            )
