"""The window of rc10.plot, without a window."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

import rc10
from fake_daemon import FakeDaemon
from rc10.plot.live import LivePlot, show
from rc10.signals import Signal
from virtual_link import VirtualLink


def test_it_shows_the_last_seconds_of_every_state(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.publish_states()
    state = robot.wait_for_state()
    figure = Figure()
    names = ("wheel.velocity_rpm", "yaw.velocity_rpm", "wheel.current_a")
    plot = LivePlot(figure, [Signal.parse(name) for name in names], state, window_s=0.5)
    with robot.states_to(plot.add):
        link.pass_time(0.2)
        robot.spin()
        plot.redraw()
        speed, current = figure.axes
        assert [line.get_label() for line in speed.lines] == list(names[:2])
        assert len(np.asarray(speed.lines[0].get_xdata())) == 40
        for _ in range(10):
            link.pass_time(0.1)
            robot.spin()
        plot.redraw()
    times = np.asarray(current.lines[0].get_xdata())
    assert times[-1] - times[0] == pytest.approx(0.5, abs=0.01)
    assert speed.get_ylabel() == "velocity (rpm)"
    assert current.get_xlim()[1] == pytest.approx(times[-1])


def test_without_a_display_it_says_what_to_do(
    robot: rc10.Robot, daemon: FakeDaemon, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    monkeypatch.setattr("matplotlib.get_backend", lambda: "agg")
    daemon.publish_state()
    robot.wait_for_state()
    with pytest.raises(rc10.Rc10Error, match="--png FILE --seconds N"):
        show(robot, [Signal("wheel", "velocity_rpm")], 10)
