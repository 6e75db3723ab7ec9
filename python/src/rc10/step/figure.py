"""A step as a figure."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rc10.plot.figure import COLOURS, figure_with, style_axes
from rc10.signals import unit_of
from rc10.step.table import rounded, title_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from rc10.step.run import StepResult

# Signals shown beneath the response.
_BENEATH = {
    "velocity_rpm": ("current_a",),
    "total_angle_deg": ("velocity_rpm", "current_a"),
    "current_a": ("velocity_rpm",),
}


def figure_of(result: StepResult) -> Figure:
    """Returns a figure: the response with its tolerance, and what it took."""
    beneath = _BENEATH[result.signal]
    motor = result.recording.motor(result.plan.motor)
    time_s = result.recording.time_s
    figure, (main, *others) = figure_with(
        1 + len(beneath), f"{title_of(result)}\n{_verdict(result)}"
    )
    figure.set_figheight(figure.get_figheight() + 0.8)
    _draw_response(main, result)
    for number, (axes, name) in enumerate(zip(others, beneath)):
        axes.plot(time_s, motor.signal(name), color=COLOURS[2 + number], linewidth=1.2)
        unit = unit_of(name)
        style_axes(axes, f"{name.rpartition('_')[0]} ({unit})")
    for axes in (main, *others):
        axes.axvline(0.0, color="#888888", linewidth=0.8)
        axes.set_xlim(time_s[0], time_s[-1])
    return figure


def _verdict(result: StepResult) -> str:
    metrics = result.metrics
    parts = [f"overshoot {metrics.overshoot_percent:.1f} %"]
    if not math.isnan(metrics.rise_time_s):
        parts.insert(0, f"rise {metrics.rise_time_s:.3f} s")
    if not math.isnan(metrics.settling_time_s):
        parts.append(f"settled after {metrics.settling_time_s:.3f} s")
    parts.append(f"steady error {rounded(metrics.steady_error)} {unit_of(result.signal)}")
    return ", ".join(parts)


def _draw_response(axes: Axes, result: StepResult) -> None:
    metrics, unit = result.metrics, unit_of(result.signal)
    time_s = result.recording.time_s
    values = result.recording.motor(result.plan.motor).signal(result.signal)
    band = metrics.tolerance * abs(metrics.target - metrics.start)
    axes.axhspan(
        metrics.target - band,
        metrics.target + band,
        color=COLOURS[1],
        alpha=0.15,
        linewidth=0,
        label=f"±{metrics.tolerance * 100:g} %",
    )
    axes.step(
        [time_s[0], 0.0, time_s[-1]],
        [metrics.start, metrics.target, metrics.target],
        where="post",
        color=COLOURS[1],
        linestyle="--",
        linewidth=1.2,
        label="target",
    )
    axes.plot(time_s, values, color=COLOURS[0], linewidth=1.6, label="measured")
    if not math.isnan(metrics.settling_time_s):
        axes.axvline(
            metrics.settling_time_s, color=COLOURS[0], linestyle=":", linewidth=1.2, label="settled"
        )
    style_axes(axes, f"{result.signal.rpartition('_')[0].replace('_', ' ')} ({unit})")
    axes.legend(loc="center right", frameon=True, framealpha=0.9, fontsize="small")
