"""A window that shows signals while they come."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from rc10.errors import MissingPackage, Rc10Error
from rc10.plot.figure import COLOURS, panels_of, style_axes

try:
    import matplotlib as mpl
except ImportError as error:
    raise MissingPackage("plotting", "matplotlib", "plot") from error

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    from rc10.client import Robot
    from rc10.signals import Signal
    from rc10.state import RobotState

_REDRAW_MS = 50
# More points than a window has pixels show nothing more.
_MOST_POINTS = 20_000


class LivePlot:
    """The curves of the last seconds, in a figure that somebody else shows.

    Args:
        figure: an empty one.
        signals: what to show.
        state: the newest state: it tells the units.
        window_s: how much of the past is shown.
    """

    def __init__(
        self, figure: Figure, signals: Sequence[Signal], state: RobotState, window_s: float
    ) -> None:
        self._window_s = window_s
        self._start_us = state.mono_us
        self._times: deque[float] = deque(maxlen=_MOST_POINTS)
        self._curves: list[tuple[Signal, deque[float], Line2D]] = []
        panels = panels_of([(signal, signal.unit(state)) for signal in signals])
        all_axes = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0]
        self._axes: list[Axes] = list(all_axes)
        for axes, panel in zip(self._axes, panels):
            for number, signal in enumerate(panel.signals):
                (line,) = axes.plot([], [], label=str(signal), color=COLOURS[number % len(COLOURS)])
                self._curves.append((signal, deque(maxlen=_MOST_POINTS), line))
            style_axes(axes, panel.label)
            axes.legend(loc="upper left", frameon=False, fontsize="small")
        self._axes[-1].set_xlabel("time (s)")

    def add(self, state: RobotState) -> None:
        """Takes in a state."""
        time_s = (state.mono_us - self._start_us) * 1e-6
        if self._times and time_s <= self._times[-1]:  # rc10d's computer was started again
            return
        self._times.append(time_s)
        for signal, values, _ in self._curves:
            values.append(signal.read(state))
        while self._times[0] < time_s - self._window_s:
            self._times.popleft()
            for _, values, _ in self._curves:
                values.popleft()

    def redraw(self) -> None:
        """Shows what was taken in."""
        if not self._times:
            return
        for _, values, line in self._curves:
            line.set_data(list(self._times), list(values))
        for axes in self._axes:
            axes.relim()
            axes.autoscale_view(scalex=False)
        end_s = self._times[-1]
        self._axes[-1].set_xlim(max(0.0, end_s - self._window_s), max(self._window_s, end_s))


def show(robot: Robot, signals: Sequence[Signal], window_s: float) -> None:
    """Opens a window and shows the signals until it is closed.

    Raises:
        Rc10Error: there is no display.
    """
    import matplotlib.pyplot as plt
    from matplotlib import animation

    if mpl.get_backend().lower() == "agg":
        raise Rc10Error(
            "there is no display for a window (or no toolkit: apt-get install python3-tk): "
            "write a picture with --png FILE --seconds N, or send the signals to another "
            "computer with python -m rc10.stream"
        )
    figure = plt.figure(f"robot {robot.name}", layout="constrained")
    plot = LivePlot(figure, signals, robot.state, window_s)

    def step(_: int) -> list[Line2D]:
        robot.spin()
        plot.redraw()
        return []

    with robot.states_to(plot.add):
        # It has to be kept, or it stops.
        kept = animation.FuncAnimation(
            figure, step, interval=_REDRAW_MS, blit=False, cache_frame_data=False
        )
        plt.show()
        del kept
