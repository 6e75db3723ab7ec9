from __future__ import annotations

from typing import Callable

import pytest

import rc10
from fake_daemon import FakeDaemon
from rc10.lcm_types import response_t
from virtual_link import VirtualLink

REFUSED = response_t.STATUS_REFUSED
FAILED = response_t.STATUS_FAILED


def test_a_request_is_answered(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.verdicts["get_config"] = (response_t.STATUS_OK, "as built")
    daemon.values = {"rate_hz": 1000.0}
    response = robot.request("get_config", "wheel", {"kp_a_per_rpm": 0.5})
    assert response.message == "as built"
    assert response.values == {"rate_hz": 1000.0}
    (request,) = daemon.executed
    assert (request.client, request.operation, request.target) == ("tester", "get_config", "wheel")
    assert [(v.name, v.value) for v in request.values] == [("kp_a_per_rpm", 0.5)]


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        (lambda robot: robot.enable(), "enable"),
        (lambda robot: robot.enable("wheel"), "enable wheel"),
        (lambda robot: robot.enable(["wheel", "yaw"]), "enable wheel,yaw"),
        (lambda robot: robot.enable(name for name in ("yaw",)), "enable yaw"),
        (lambda robot: robot.disable(("yaw", "wheel")), "disable yaw,wheel"),
        (lambda robot: robot.clear(), "clear"),
        (lambda robot: robot.zero("yaw"), "zero yaw"),
        (lambda robot: robot.gains("yaw"), "get_config yaw"),
    ],
)
def test_operations_name_their_motors(
    robot: rc10.Robot,
    daemon: FakeDaemon,
    call: Callable[[rc10.Robot], object],
    expected: str,
) -> None:
    call(robot)
    assert daemon.operations() == [expected]


def test_gains_are_set_and_told_with_their_lines(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    lines = "velocity_pid: {type: position, kp_a_per_rpm: 0.8}"
    daemon.verdicts["get_config"] = (response_t.STATUS_OK, lines)
    daemon.values = {"velocity_pid.kp_a_per_rpm": 0.8}
    gains = robot.set_gains("wheel", {"velocity.kp": 0.8})
    assert daemon.operations() == ["set_gains wheel", "get_config wheel"]
    assert [(v.name, v.value) for v in daemon.executed[0].values] == [("velocity.kp", 0.8)]
    assert gains == {"velocity_pid.kp_a_per_rpm": 0.8}
    assert gains.yaml == lines


def test_refused_gains_raise(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.verdicts["set_gains"] = (REFUSED, "wheel: velocity_pid.kp_a_per_rpm: -1 is below 0")
    with pytest.raises(rc10.RequestRefused, match="-1 is below 0"):
        robot.set_gains("wheel", {"velocity.kp": -1.0})
    assert daemon.operations() == ["set_gains wheel"]


def test_a_lost_request_is_repeated(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.deaf_to_requests = 3
    before_s = link.now()
    robot.enable("wheel")
    assert len(daemon.received) == 1
    assert link.now() - before_s == pytest.approx(0.3)


def test_a_repeated_request_is_carried_out_once(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.lost_answers = 3
    robot.enable("wheel")
    assert len(daemon.received) == 4
    assert len({request.seq for request in daemon.received}) == 1
    assert daemon.operations() == ["enable wheel"]


def test_the_answer_to_another_client_is_not_ours(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.deaf_to_requests = 1
    foreign = response_t()
    foreign.client = "tester"
    foreign.session = 1
    foreign.seq = 1
    foreign.status = REFUSED
    link.after(0.01, lambda: link.publish(daemon.channel("response"), foreign.encode()))
    robot.enable("wheel")


def test_a_refusal_carries_the_daemons_words(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.verdicts["zero"] = (REFUSED, "yaw is ACTIVE: disable it first")
    with pytest.raises(rc10.RequestRefused) as caught:
        robot.zero("yaw")
    assert caught.value.operation == "zero"
    assert caught.value.target == "yaw"
    assert caught.value.message == "yaw is ACTIVE: disable it first"
    assert str(caught.value) == "zero yaw: refused: yaw is ACTIVE: disable it first"
    assert len(daemon.received) == 1


def test_a_failure_carries_the_daemons_words(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.verdicts["enable"] = (FAILED, "wheel: OFFLINE: no feedback on can0")
    with pytest.raises(
        rc10.RequestFailed, match="enable: failed: wheel: OFFLINE: no feedback on can0"
    ):
        robot.enable()


def test_without_a_daemon_the_timeout_says_what_to_check(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.deaf_to_requests = 1000
    before_s = link.now()
    with pytest.raises(rc10.Timeout) as caught:
        robot.enable("wheel", timeout_s=1.5)
    assert link.now() - before_s == pytest.approx(1.5)
    text = str(caught.value)
    assert "no answer to 'enable' from robot 'demo' within 1.5 s" in text
    assert "is rc10d running?" in text
    assert "Is its robot called 'demo'" in text
    assert "sudo ip route add 239.255.76.67/32 dev lo src 127.0.0.1" in text
    assert isinstance(caught.value, TimeoutError)


def test_with_a_silent_daemon_the_timeout_does_not_blame_the_route(
    robot: rc10.Robot, daemon: FakeDaemon
) -> None:
    daemon.publish_states()
    daemon.deaf_to_requests = 1000
    with pytest.raises(rc10.Timeout, match="Its state arrives") as caught:
        robot.enable("wheel")
    assert "ip route" not in str(caught.value)


def test_names_are_checked_before_anything_is_sent(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.publish_state()
    robot.wait_for_state()
    with pytest.raises(rc10.UnknownMotor, match="no motor 'whel'"):
        robot.enable(["whel", "yaw"])
    # Each of these would reach the daemon as an empty target, which means all.
    for nobody in ([], "", [""]):
        with pytest.raises(ValueError, match="name"):
            robot.enable(nobody)
    with pytest.raises(ValueError, match="given as a list"):
        robot.disable("wheel,yaw")
    assert not daemon.received


def test_estop_is_repeated_until_the_state_shows_it(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.publish_states()
    daemon.deaf_to_requests = 4
    robot.estop()
    assert robot.state.estopped
    assert daemon.deaf_to_requests == 0
    assert daemon.operations() == ["estop"]


def test_an_answer_alone_does_not_end_estop(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.publish_states()
    daemon.shows_estop = False
    before_s = link.now()
    with pytest.raises(rc10.Timeout, match="hardware emergency stop"):
        robot.estop(timeout_s=0.5)
    assert link.now() - before_s == pytest.approx(0.5)
    assert len(daemon.received) >= 25
    assert len(daemon.executed) == 1


def test_a_state_from_before_does_not_end_estop(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.estopped = True
    daemon.publish_state()
    daemon.estopped = daemon.shows_estop = False
    with pytest.raises(rc10.Timeout):
        robot.estop(timeout_s=0.1)


def test_a_refused_estop_is_told_at_once(
    robot: rc10.Robot, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.publish_states()
    daemon.verdicts["estop"] = (REFUSED, "no such operation")
    before_s = link.now()
    with pytest.raises(rc10.RequestRefused, match="no such operation"):
        robot.estop()
    assert link.now() - before_s < 0.01
