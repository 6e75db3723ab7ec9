from __future__ import annotations

import pytest

import rc10
from fake_daemon import FakeDaemon
from virtual_link import VirtualLink


def test_the_grid_is_absolute(robot: rc10.Robot, link: VirtualLink) -> None:
    start_s = link.now()
    times = []
    for t_s, body_s in zip(robot.rate(100), (0.001, 0.009, 0.0, 0.004, 0.0)):
        times.append((t_s, link.now() - start_s))
        link.pass_time(body_s)
    expected = [0.0, 0.01, 0.02, 0.03, 0.04]
    assert [t for t, _ in times] == pytest.approx(expected)
    assert [t for _, t in times] == pytest.approx(expected)


def test_overrun_grid_points_are_skipped_and_counted(robot: rc10.Robot, link: VirtualLink) -> None:
    rate = robot.rate(100)
    start_s = link.now()
    assert next(rate) == 0.0
    link.pass_time(0.035)
    assert next(rate) == pytest.approx(0.03)
    assert rate.missed == 2
    assert link.now() - start_s == pytest.approx(0.035)
    assert next(rate) == pytest.approx(0.04)
    assert link.now() - start_s == pytest.approx(0.04)
    assert rate.missed == 2


def test_a_little_late_is_not_missed(robot: rc10.Robot, link: VirtualLink) -> None:
    rate = robot.rate(100)
    next(rate)
    link.pass_time(0.019)
    assert next(rate) == pytest.approx(0.01)
    assert rate.missed == 0


def test_it_receives_while_it_waits(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.publish_states(hz=200)
    ticks = [robot.state.tick for _, _ in zip(robot.rate(100), range(5))]
    assert ticks == [1, 3, 5, 7, 9]


def test_a_loop_that_is_always_late_still_receives(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.publish_states(hz=200)
    for _, _ in zip(robot.rate(100), range(5)):
        assert robot.state.age_s < 0.0051
        link.pass_time(0.1)


@pytest.mark.parametrize("hz", [0, -1, 1e5, float("nan")])
def test_an_impossible_rate_is_refused(robot: rc10.Robot, hz: float) -> None:
    with pytest.raises(ValueError, match="hz"):
        robot.rate(hz)
