"""A step in words."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rc10.signals import unit_of

if TYPE_CHECKING:
    from rc10.step.run import StepResult


def text_of(result: StepResult) -> str:
    """Returns a table."""
    metrics, unit = result.metrics, unit_of(result.signal)

    def seconds(value: float, otherwise: str) -> str:
        return otherwise if math.isnan(value) else f"{value:.3f} s"

    percent = f"±{metrics.tolerance * 100:g} %"
    rows = [
        ("rise time (10-90 %)", seconds(metrics.rise_time_s, "90 % was not reached")),
        ("overshoot", f"{metrics.overshoot_percent:.1f} %"),
        ("peak", f"{metrics.peak:.2f} {unit} after {metrics.peak_time_s:.3f} s"),
        (f"settling time ({percent})", seconds(metrics.settling_time_s, "has not settled")),
        ("steady-state error", f"{rounded(metrics.steady_error)} {unit}"),
        (
            "limits that acted",
            ", ".join(f"{name} ({share:.0%} of the time)" for name, share in result.limits.items())
            or "none",
        ),
        *(
            [("target missing", f"{result.missing:.0%} of the time: this computer was too busy")]
            if result.missing
            else []
        ),
        ("states", f"{len(result.recording)}, every {_spacing_ms(result):.3g} ms"),
    ]
    width = max(len(label) for label, _ in rows)
    return "\n".join([title_of(result), *(f"  {label:{width}}  {value}" for label, value in rows)])


def rounded(value: float) -> str:
    """Returns it with two decimals, and no minus before a zero."""
    return f"{round(value, 2) + 0.0:.2f}"


def _spacing_ms(result: StepResult) -> float:
    time_s = result.recording.time_s
    return float(time_s[-1] - time_s[0]) / max(1, len(time_s) - 1) * 1e3


def title_of(result: StepResult) -> str:
    """Returns one line that tells what was done."""
    metrics, unit = result.metrics, unit_of(result.signal)
    mode = result.plan.mode.name.lower()
    return (
        f"{result.recording.robot}, {result.plan.motor}: {mode} from {metrics.start:.4g} "
        f"to {metrics.target:.4g} {unit}"
    )
