from __future__ import annotations

import logging
import math
from dataclasses import replace

import pytest

import rc10
from fake_daemon import FakeDaemon
from rc10.inbox import STATE_QUEUE
from rc10.lcm_types import (
    bus_state_t,
    counter_t,
    diagnostics_t,
    motor_state_t,
    robot_state_t,
    setpoint_t,
)
from virtual_link import VirtualLink


def test_nothing_is_known_at_first(robot: rc10.Robot) -> None:
    with pytest.raises(rc10.NotReceived, match="wait_for_state"):
        _ = robot.state
    with pytest.raises(rc10.NotReceived, match="wait_for_state"):
        robot.motor("wheel")
    with pytest.raises(rc10.NotReceived, match="twice a second"):
        _ = robot.diagnostics
    assert robot.events() == []


def test_a_state_becomes_typed(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    message = daemon.state()
    motor = message.motors[0]
    motor.status = motor_state_t.STATUS_FAULT
    motor.fault = 12
    motor.fault_text = "too hot"
    motor.limits = motor_state_t.LIMIT_CURRENT | motor_state_t.LIMIT_STALL
    motor.mode = setpoint_t.MODE_VELOCITY
    motor.target = 120.0
    motor.command_unit = motor_state_t.UNIT_AMPERE
    daemon.link.publish(daemon.channel("state"), message.encode())

    state = robot.wait_for_state()
    assert state is robot.state
    assert state.status is rc10.RobotStatus.RUN
    assert not state.estopped
    assert list(state.motors) == ["wheel", "yaw", "left-arm"]
    wheel = robot.motor("wheel")
    assert wheel.status is rc10.MotorStatus.FAULT
    assert (wheel.fault, wheel.fault_text) == (12, "too hot")
    assert wheel.limits == rc10.Limit.CURRENT | rc10.Limit.STALL
    assert wheel.mode is rc10.Mode.VELOCITY
    assert wheel.velocity_rpm == 12.5
    assert math.isnan(wheel.voltage_v)
    assert wheel.command_unit is rc10.CommandUnit.AMPERE
    with pytest.raises(rc10.UnknownMotor, match="no motor 'whel'; it has: wheel, yaw"):
        robot.motor("whel")


def test_the_newest_state_wins(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    for _ in range(20):
        daemon.publish_state()
    robot.spin()
    assert robot.state.tick == 20


def test_an_overtaken_state_is_dropped(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    late = daemon.state().encode()
    link.pass_time(0.005)
    daemon.publish_state()
    link.publish(daemon.channel("state"), late)
    robot.spin()
    daemon.publish_state()
    robot.spin()
    link.publish(daemon.channel("state"), late)
    robot.spin()
    assert robot.state.tick == 2


def test_a_host_that_started_again_is_believed(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.publish_state()
    robot.wait_for_state()
    message = daemon.state()
    message.mono_us = 5_000_000
    link.publish(daemon.channel("state"), message.encode())
    robot.spin()
    assert robot.state.mono_us == 5_000_000
    assert robot.state.age_s == pytest.approx(0.0)


def test_a_state_tells_its_age(robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink) -> None:
    daemon.publish_state()
    state = robot.wait_for_state()
    link.pass_time(0.25)
    assert state.age_s == pytest.approx(0.25)


def test_waiting_in_the_queue_counts_as_age(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.publish_state()
    robot.wait_for_state()
    daemon.publish_state()
    link.pass_time(0.3)
    assert robot.wait_for_state().age_s == pytest.approx(0.3, abs=1e-3)


def test_after_a_long_absence_a_live_state_is_awaited(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    # A full queue: in it are the oldest of the absence, since LCM drops the newest.
    for _ in range(STATE_QUEUE):
        daemon.publish_state()
        link.pass_time(0.005)
    link.pass_time(10.0)
    link.after(0.005, daemon.publish_state)
    robot.spin()
    assert robot.state.tick == STATE_QUEUE + 1
    assert robot.state.age_s == pytest.approx(0.0)


def test_wait_for_state_wants_a_new_one(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.publish_state()
    robot.wait_for_state()
    link.after(0.4, lambda: daemon.publish_event("something else"))
    link.after(0.5, daemon.publish_state)
    assert robot.wait_for_state(timeout_s=1.0).tick == 2


def test_without_a_state_the_timeout_says_what_to_check(
    robot: rc10.Robot, link: VirtualLink
) -> None:
    before_s = link.now()
    with pytest.raises(rc10.Timeout, match=r"no state of robot 'demo' within 2 s\. Check"):
        robot.wait_for_state(timeout_s=2.0)
    assert link.now() - before_s == pytest.approx(2.0)


def test_without_its_robot_those_that_are_heard_are_listed(
    robot: rc10.Robot, link: VirtualLink
) -> None:
    for name in ("demo2", "hero"):
        FakeDaemon(name, link).publish_states()
    with pytest.raises(rc10.Timeout, match=r"heard here: demo2, hero; .* did you mean demo2\?"):
        robot.wait_for_state(timeout_s=0.5)


def test_another_robots_state_is_not_ours(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    # In a regular expression the dots of "demo.v1.state" would match these.
    for channel in ("demo2.v1.state", "demoxv1.state", "my-demo.v1.state"):
        link.publish(channel, daemon.state().encode())
    assert robot.spin() == 0


@pytest.mark.parametrize("bad", [b"", b"12345678 and more", robot_state_t().encode()[:20]])
def test_messages_with_other_definitions_are_told_about(
    robot: rc10.Robot,
    daemon: FakeDaemon,
    link: VirtualLink,
    caplog: pytest.LogCaptureFixture,
    bad: bytes,
) -> None:
    for _ in range(3):
        link.publish(daemon.channel("state"), bad)
        robot.spin()
    with pytest.raises(rc10.Timeout, match=r"other definitions arrive on demo\.v1\.state"):
        robot.wait_for_state()
    assert [record.levelno for record in caplog.records] == [logging.WARNING]


def test_an_unknown_status_is_another_definition(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    message = daemon.state()
    message.state = 99
    link.publish(daemon.channel("state"), message.encode())
    with pytest.raises(rc10.Timeout, match="other definitions"):
        robot.wait_for_state()


def test_diagnostics_become_typed(robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink) -> None:
    message = diagnostics_t()
    message.wake_latency_p99_us = 42.0
    message.missed_ticks = 3
    refusal = counter_t()
    refusal.name, refusal.count = "not_owner", 7
    message.refusals, message.refusal_count = [refusal], 1
    message.notices, message.notice_count = ["no PREEMPT_RT: install linux-image-rt"], 1
    bus = bus_state_t()
    bus.name, bus.interface_name = "chassis", "can0"
    bus.state, bus.tec = bus_state_t.STATE_BUS_OFF, -1
    message.buses, message.bus_count = [bus], 1
    link.publish(daemon.channel("diagnostics"), message.encode())
    robot.spin()

    diagnostics = robot.diagnostics
    assert diagnostics.wake_latency_p99_us == 42.0
    assert diagnostics.missed_ticks == 3
    assert diagnostics.refusals == {"not_owner": 7}
    assert diagnostics.notices == ("no PREEMPT_RT: install linux-image-rt",)
    assert diagnostics.buses["chassis"].status is rc10.BusStatus.BUS_OFF
    assert diagnostics.buses["chassis"].tec == -1


def test_events_are_taken_once(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.publish_event("first")
    daemon.publish_event("second")
    robot.spin()
    events = robot.events()
    assert [event.text for event in events] == ["first", "second"]
    assert events[0].severity is rc10.Severity.WARNING
    assert str(events[0]) == "WARNING wheel: first"
    assert (events[0].source, events[0].code) == ("wheel", 42)
    assert robot.events() == []


def test_spin_waits_no_longer_than_asked(robot: rc10.Robot, link: VirtualLink) -> None:
    before_s = link.now()
    assert robot.spin(0.25) == 0
    assert link.now() - before_s == pytest.approx(0.25)
    assert robot.spin(-1.0) == 0


def test_a_state_prints_as_a_line_for_each_motor(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.active = {"wheel"}
    daemon.publish_state()
    state = robot.wait_for_state()
    assert str(state).splitlines() == [
        "RUN, tick 1",
        "  wheel ACTIVE COAST: 12.5 rpm, 0.0 deg, 0.00 A",
        "  yaw READY COAST: 12.5 rpm, 0.0 deg, 0.00 A",
        "  left-arm READY COAST: 12.5 rpm, 0.0 deg, 0.00 A",
    ]
    turning = replace(
        state.motor("wheel"), mode=rc10.Mode.VELOCITY, target=60.0, owner="x", current_a=math.nan
    )
    assert str(turning) == "wheel ACTIVE VELOCITY 60 rpm: 12.5 rpm, 0.0 deg"
    stopped = replace(state, status=rc10.RobotStatus.ESTOP, stop_cause=rc10.StopCause.REQUEST)
    assert str(replace(stopped, stopped_by="\x1bx")).startswith("ESTOP REQUEST ?x, tick 1\n")
    held = replace(state.motor("yaw"), acting=rc10.Acting.HOLD, stop_cause=rc10.StopCause.ESTOP)
    assert str(held) == "yaw READY HOLD: 12.5 rpm, 0.0 deg, 0.00 A (ESTOP)"
