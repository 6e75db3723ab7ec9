from __future__ import annotations

import math

import pytest

import rc10
from fake_daemon import FakeDaemon
from rc10.lcm_types import signals_t
from virtual_link import VirtualLink


def state(owner: str, **outputs: float) -> signals_t:
    message = signals_t()
    message.client = owner
    message.count = len(outputs)
    message.names = list(outputs)
    message.values = list(outputs.values())
    return message


def test_inputs_go_out_with_client_session_and_growing_numbers(
    robot: rc10.Robot, link: VirtualLink
) -> None:
    seen: list[signals_t] = []
    rc10.Subscriber(link, "demo.v1.base", signals_t, seen.append)
    base = robot.module("base")
    base.send(vx_m_s=0.5, wz_deg_s=30, validity_ms=100)
    base.send(vx_m_s=0, priority=9)
    robot.spin()
    assert [message.client for message in seen] == ["tester", "tester"]
    assert seen[0].session == seen[1].session != 0
    assert seen[0].seq < seen[1].seq
    assert (seen[0].priority, seen[0].validity_ms) == (7, 100)
    assert (seen[1].priority, seen[1].validity_ms) == (9, 0)
    assert dict(zip(seen[0].names, seen[0].values)) == {"vx_m_s": 0.5, "wz_deg_s": 30.0}


def test_the_state_has_its_owner_its_outputs_and_its_age(
    robot: rc10.Robot, link: VirtualLink
) -> None:
    base = robot.module("base")
    with pytest.raises(rc10.NotReceived, match="nothing of module 'base' yet"):
        _ = base.state
    rc10.Publisher(link, "demo.v1.base.state", signals_t).publish(
        state("planner", x_m=1.5, vx_m_s=math.nan)
    )
    robot.spin()
    link.pass_time(0.25)
    assert base.state["x_m"] == 1.5
    assert math.isnan(base.state["vx_m_s"])
    assert base.state.owner == "planner"
    assert base.state.age_s == pytest.approx(0.25)
    with pytest.raises(KeyError, match="no output 'y'; there are x_m, vx_m_s"):
        _ = base.state["y"]
    with pytest.raises(KeyError, match=r"did you mean vx_m_s\?"):
        _ = base.state["vx_ms"]


def test_inputs_for_a_module_that_is_not_there_are_told_once(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink, caplog: pytest.LogCaptureFixture
) -> None:
    there, missing = robot.module("base"), robot.module("bsae")
    for _ in range(40):
        daemon.publish_state()
        rc10.Publisher(link, "demo.v1.base.state", signals_t).publish(state("tester", x_m=0))
        robot.spin()
        there.send(vx_m_s=1)
        missing.send(vx_m_s=1)
        link.pass_time(0.1)
    (told,) = caplog.messages
    assert told.startswith("robot 'demo' is heard, and nothing of module 'bsae' to which inputs")


def test_a_module_of_a_robot_that_is_not_heard_is_not_called_missing(
    robot: rc10.Robot, link: VirtualLink, caplog: pytest.LogCaptureFixture
) -> None:
    for _ in range(40):
        robot.module("base").send(vx_m_s=1)
        link.pass_time(0.1)
    assert caplog.messages == []


def test_one_module_is_one_object(robot: rc10.Robot) -> None:
    assert robot.module("base") is robot.module("base")


def test_what_no_module_takes_is_not_sent(robot: rc10.Robot, link: VirtualLink) -> None:
    seen: list[signals_t] = []
    rc10.Subscriber(link, "demo.v1.base", signals_t, seen.append)
    base = robot.module("base")
    with pytest.raises(ValueError, match="1 to 32 inputs, not 0"):
        base.send()
    with pytest.raises(ValueError, match="vx_m_s = nan is not finite"):
        base.send(vx_m_s=math.nan)
    with pytest.raises(ValueError, match="validity_ms = -1"):
        base.send(vx_m_s=1, validity_ms=-1)
    with pytest.raises(ValueError, match="validity_ms = 1001"):
        base.send(vx_m_s=1, validity_ms=1001)
    robot.spin()
    assert seen == []


def test_waits_for_what_the_module_says(robot: rc10.Robot, link: VirtualLink) -> None:
    base = robot.module("base")
    with pytest.raises(rc10.Timeout, match=r"nothing of module 'base' within 0.1 s: `rc10ctl"):
        base.wait_for_state(0.1)
    publisher = rc10.Publisher(link, "demo.v1.base.state", signals_t)
    publisher.publish(state("", x_m=1.5))
    assert base.wait_for_state()["x_m"] == 1.5
    link.after(0.2, lambda: publisher.publish(state("", x_m=2.5)))
    assert base.wait_for_state()["x_m"] == 2.5


def test_a_misspelt_module_is_told_with_those_that_are_heard(
    robot: rc10.Robot, link: VirtualLink
) -> None:
    publisher = rc10.Publisher(link, "demo.v1.base.state", signals_t)
    link.after(0.05, lambda: publisher.publish(state("", x_m=1.5)))
    with pytest.raises(rc10.Timeout, match=r"heard of robot 'demo': base; did you mean base\?"):
        robot.module("bsae").wait_for_state(0.1)
