"""Figures of recordings; they need no display."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rc10.errors import MissingPackage
from rc10.setpoints import Mode
from rc10.signals import Signal, measured_by, unit_of
from rc10.state import CommandUnit

try:
    import numpy as np
    from matplotlib.figure import Figure
except ImportError as error:
    raise MissingPackage("plotting", "matplotlib", "plot") from error

if TYPE_CHECKING:
    import os
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from rc10.recording import MotorRecording, Recording

# Colours that differ in brightness too, for those who see them differently and for print:
# matplotlib's own first ones, darker.
COLOURS = ("#1b5fa8", "#d4570a", "#2a7f3b", "#a61c3c", "#6a4c93", "#7a5230", "#c2448f", "#4d4d4d")

_WIDTH_IN = 8.0
_PANEL_HEIGHT_IN = 2.4
_DPI = 110


@dataclass(frozen=True)
class Panel:
    """Signals of one unit, which share axes."""

    unit: str
    signals: tuple[Signal, ...]

    @property
    def label(self) -> str:
        """Label of its axis, with the unit: "velocity (rpm)"."""
        names = dict.fromkeys(_quantity(signal.name) for signal in self.signals)
        # The target of a velocity is a velocity.
        names = {name: None for name in names if name != "target"} or names
        text = ", ".join(names)
        return f"{text} ({self.unit})" if self.unit else text


def panels_of(signals: Sequence[tuple[Signal, str]]) -> list[Panel]:
    """Puts signals of the same unit into one panel each, in the order of their first."""
    by_unit: dict[str, list[Signal]] = {}
    for signal, unit in signals:
        # Numbers without a unit have nothing in common.
        by_unit.setdefault(unit or f" {signal.name}", []).append(signal)
    return [Panel(unit.strip() if unit[0] != " " else "", tuple(s)) for unit, s in by_unit.items()]


def style_axes(axes: Axes, label: str) -> None:
    """Gives axes the look that all of rc10's have."""
    axes.set_ylabel(label)
    axes.grid(visible=True, color="#dddddd", linewidth=0.7)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def figure_with(count: int, title: str) -> tuple[Figure, list[Axes]]:
    """Returns a figure with so many axes above each other, which share their time."""
    figure = Figure(figsize=(_WIDTH_IN, 0.9 + _PANEL_HEIGHT_IN * count), layout="constrained")
    axes = figure.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    if title:
        figure.suptitle(title, fontsize="medium")
    axes[-1].set_xlabel("time (s)")
    return figure, list(axes)


def save_png(figure: Figure, path: str | os.PathLike[str]) -> None:
    """Writes a figure to a PNG file."""
    # Without it the version of matplotlib is in every file.
    figure.savefig(path, format="png", dpi=_DPI, metadata={"Software": None})


def figure_of(recording: Recording, signals: Sequence[str], title: str = "") -> Figure:
    """Returns a figure of a recording; see Recording.plot()."""
    chosen = [Signal.parse(name) for name in signals] or _followed(recording)
    panels = panels_of([(s, _unit(recording.motor(s.motor), s.name)) for s in chosen])
    figure, all_axes = figure_with(len(panels), title or f"robot {recording.robot}")
    motors = list(dict.fromkeys(signal.motor for signal in chosen))
    for axes, panel in zip(all_axes, panels):
        for number, signal in enumerate(panel.signals):
            values = _shown(recording.motor(signal.motor), signal.name)
            target = signal.name == "target"
            # One colour for each motor where that tells them apart.
            alike = len({s.name for s in panel.signals} - {"target"}) <= 1
            colour = COLOURS[(motors.index(signal.motor) if alike else number) % len(COLOURS)]
            axes.plot(
                recording.time_s,
                values,
                label=str(signal),
                color=colour,
                linewidth=1.1 if target else 1.5,
                linestyle="--" if target else "-",
                drawstyle="steps-post" if target else "default",
            )
        style_axes(axes, panel.label)
        axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False, fontsize="small")
    return figure


def _followed(recording: Recording) -> list[Signal]:
    chosen = []
    for name, motor in recording.motors.items():
        measured = measured_by(_usual_mode(motor))
        if measured is not None:
            chosen += [Signal(name, "target"), Signal(name, measured)]
    # Nobody commanded anything: how they turn.
    return chosen or [Signal(name, "velocity_rpm") for name in recording.motors]


def _usual_mode(motor: MotorRecording) -> Mode:
    modes = motor.mode[np.isfinite(motor.mode) & (motor.mode != Mode.COAST)].astype(int)
    return Mode(int(np.bincount(modes).argmax())) if len(modes) else Mode.COAST


def _unit(motor: MotorRecording, name: str) -> str:
    if name == "target":
        return _usual_mode(motor).unit
    if name == "command_value":
        last = motor.command_unit[-1]
        return {CommandUnit.AMPERE: "A", CommandUnit.VOLT: "V"}.get(
            CommandUnit(int(last)), _usual_mode(motor).unit if last else ""
        )
    return unit_of(name)


def _shown(motor: MotorRecording, name: str) -> NDArray[np.float64]:
    values = motor.signal(name)
    if name == "target":
        # Without a target the state says 0, which nobody asked for.
        return np.where(motor.mode == Mode.COAST, np.nan, values)
    return values


def _quantity(name: str) -> str:
    stem, _, unit = name.rpartition("_")
    return (stem if unit_of(name) and stem else name or unit).replace("_", " ")
