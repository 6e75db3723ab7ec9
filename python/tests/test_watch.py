"""A loop of one's own ends with its motor."""

from __future__ import annotations

import pytest

import rc10
from fake_daemon import FakeDaemon
from virtual_link import VirtualLink


@pytest.fixture
def watch(robot: rc10.Robot, daemon: FakeDaemon) -> rc10.Watch:
    daemon.active.add("wheel")
    daemon.publish_states()
    robot.wait_for_state()
    return rc10.Watch(robot, "wheel")


def turns(robot: rc10.Robot, watch: rc10.Watch, seconds: float) -> list[bool]:
    may = []
    for t_s in robot.rate(100):
        may.append(watch.may_send())
        if t_s >= seconds:
            break
    return may


def stopped(daemon: FakeDaemon, mono_us: int) -> None:
    daemon.publish_event("ACTIVE -> READY (disabled by 'panel')", code=100, mono_us=mono_us)


def test_it_lets_a_loop_go_on_whose_motor_is_active(robot: rc10.Robot, watch: rc10.Watch) -> None:
    assert all(turns(robot, watch, 1.0))


def test_what_ended_it_ends_it_for_good(
    robot: rc10.Robot, watch: rc10.Watch, daemon: FakeDaemon
) -> None:
    daemon.active.clear()
    for _ in range(2):
        with pytest.raises(rc10.MotorStopped, match="wheel is READY"):
            turns(robot, watch, 1.0)
        daemon.active.add("wheel")


def test_an_event_from_before_it_does_not_end_it(
    robot: rc10.Robot, watch: rc10.Watch, daemon: FakeDaemon
) -> None:
    stopped(daemon, robot.state.mono_us)
    assert all(turns(robot, watch, 0.1))
    stopped(daemon, robot.state.mono_us + 1)
    with pytest.raises(rc10.MotorStopped, match="disabled by 'panel'"):
        turns(robot, watch, 0.1)


def test_an_event_that_came_with_its_state_ends_it(
    robot: rc10.Robot, watch: rc10.Watch, daemon: FakeDaemon
) -> None:
    del watch
    stopped(daemon, robot.state.mono_us + 100_000)
    robot.wait_for_state()
    with pytest.raises(rc10.MotorStopped, match="disabled by 'panel'"):
        rc10.Watch(robot, "wheel").may_send()


def test_after_a_pause_it_waits_for_a_state_of_after_it(
    robot: rc10.Robot, watch: rc10.Watch, link: VirtualLink
) -> None:
    assert watch.may_send()
    link.pass_time(0.303)
    robot.spin()  # takes what came in the pause
    assert not watch.may_send()
    assert turns(robot, watch, 0.02)[-1]


def test_two_of_them_hear_each_event(
    robot: rc10.Robot, watch: rc10.Watch, daemon: FakeDaemon
) -> None:
    other = rc10.Watch(robot, "wheel")
    stopped(daemon, robot.state.mono_us + 1)
    robot.spin(0.02)
    for each in (watch, other):
        with pytest.raises(rc10.MotorStopped, match="disabled by 'panel'"):
            each.may_send()
    assert [event.source for event in robot.events()] == ["wheel"], "they are the program's, too"


def test_a_slow_loop_gives_it_a_longer_pause(robot: rc10.Robot, watch: rc10.Watch) -> None:
    def slowly() -> None:
        for _ in robot.rate(5):
            watch.may_send()

    with pytest.raises(rc10.Timeout, match="needs a longer pause_s"):
        slowly()
    patient = rc10.Watch(robot, "wheel", pause_s=0.5)
    for t_s in robot.rate(5):
        assert patient.may_send()
        if t_s > 2.0:
            break


def test_silence_ends_it(
    robot: rc10.Robot, watch: rc10.Watch, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.publish_states = lambda *_: None  # type: ignore[method-assign]
    began_s = link.now()
    with pytest.raises(rc10.Timeout, match="no state of the robot for a second"):
        turns(robot, watch, 5.0)
    assert link.now() - began_s == pytest.approx(1.0, abs=0.02)


def test_the_reference_counts_where_angles_are_commanded(
    robot: rc10.Robot, watch: rc10.Watch
) -> None:
    assert watch.may_send()
    with pytest.raises(rc10.MotorStopped, match="no reference for angles"):
        rc10.Watch(robot, "wheel", on_angle=True).may_send()
