from __future__ import annotations

import pytest

import rc10
from fake_daemon import FakeDaemon, setpoints
from rc10.lcm_types import response_t, signals_t
from rc10.robot_client import AtEnd
from virtual_link import VirtualLink

COAST = (rc10.Mode.COAST, 0.0)


class Client(rc10.Robot):
    """Leaves its link open, so that the daemon on it can be asked afterwards."""

    def __init__(self, link: VirtualLink, at_end: AtEnd) -> None:
        link.close = lambda: None  # type: ignore[method-assign]
        super().__init__("demo", link, client="tester", at_end=at_end)


@pytest.fixture
def client(link: VirtualLink) -> Client:
    return Client(link, "coast")


@pytest.fixture
def lapsing(link: VirtualLink) -> Client:
    return Client(link, "timeout")


def drain(link: VirtualLink) -> None:
    link.pump(0.0)


def test_leaving_is_a_timeout_at_once(
    lapsing: Client, daemon: FakeDaemon, link: VirtualLink
) -> None:
    with lapsing as robot:
        robot.enable(["wheel", "yaw"])
        robot.command(wheel=rc10.velocity_rpm(120), validity_ms=1000)
        robot.command(yaw=rc10.angle_deg(3), validity_ms=1000)
    drain(link)
    # One by one: another client may have taken one of them.
    last = daemon.commands[-2:]
    assert [setpoints(one) for one in last] == [
        {"wheel": (rc10.Mode.VELOCITY, 120)},
        {"yaw": (rc10.Mode.ANGLE, 3)},
    ]
    assert [one.validity_ms for one in last] == [1, 1]
    assert daemon.operations() == ["enable wheel,yaw"]


def test_a_target_that_has_lapsed_does_not_come_back_for_the_end(
    lapsing: Client, daemon: FakeDaemon, link: VirtualLink
) -> None:
    with lapsing as robot:
        robot.command(wheel=rc10.velocity_rpm(120))
        robot.command(yaw=rc10.angle_deg(3), validity_ms=200)
        before_s = link.now()
        while link.now() < before_s + 0.06:
            robot.spin(0.01)
    drain(link)
    assert setpoints(daemon.commands[-1]) == {"yaw": (rc10.Mode.ANGLE, 3)}


def test_a_target_of_a_motor_that_was_stopped_does_not_come_back_for_the_end(
    lapsing: Client, daemon: FakeDaemon, link: VirtualLink
) -> None:
    with lapsing as robot:
        # The program has not listened since.
        robot.command(wheel=rc10.velocity_rpm(120), validity_ms=1000)
        daemon.publish_event("ACTIVE -> READY (the robot stops)", code=100)
        daemon.publish_event("READY -> ENABLING", code=100)
        drain(link)
        sent = len(daemon.commands)
    drain(link)
    assert len(daemon.commands) == sent


def test_a_motor_that_is_gone_does_not_spoil_the_end_of_the_others(
    lapsing: Client, daemon: FakeDaemon, link: VirtualLink
) -> None:
    with lapsing as robot:
        daemon.active = {"wheel", "yaw"}
        daemon.publish_state()
        robot.wait_for_state()
        robot.command(wheel=rc10.velocity_rpm(1), yaw=rc10.velocity_rpm(1), validity_ms=1000)
        daemon.motors = ("wheel",)
        daemon.publish_state()
        robot.wait_for_state()
    drain(link)
    assert setpoints(daemon.commands[-1]) == {"wheel": (rc10.Mode.VELOCITY, 1)}


def test_leaving_may_disable_and_nothing_else(daemon: FakeDaemon, link: VirtualLink) -> None:
    with Client(link, "disable") as robot:
        robot.enable("wheel")
        robot.command(wheel=rc10.velocity_rpm(120))
    drain(link)
    assert setpoints(daemon.commands[-1]) == {"wheel": (rc10.Mode.VELOCITY, 120)}
    assert len(daemon.commands) == 1
    assert daemon.operations() == ["enable wheel", "disable wheel"]
    last = daemon.executed[-1]
    assert {value.name: value.value for value in last.values} == {"at_end": 1.0}


@pytest.fixture
def given(link: VirtualLink) -> list[signals_t]:
    """Messages for the module `base`."""
    given: list[signals_t] = []
    rc10.Subscriber(link, "demo.v1.base", signals_t, given.append)
    return given


@pytest.mark.parametrize("at_end", ["timeout", "disable", "coast"])
def test_leaving_ends_the_inputs_of_modules_at_once(
    link: VirtualLink, given: list[signals_t], at_end: AtEnd
) -> None:
    with Client(link, at_end) as robot:
        robot.module("base").send(vx_m_s=0.5, validity_ms=1000, priority=9)
    drain(link)
    first, last = given
    assert dict(zip(last.names, last.values)) == {"vx_m_s": 0.5}
    assert (last.validity_ms, last.priority) == (1, 9)
    assert last.session == first.session
    assert last.seq > first.seq


def test_inputs_that_have_lapsed_do_not_come_back_for_the_end(
    lapsing: Client, link: VirtualLink, given: list[signals_t]
) -> None:
    with lapsing as robot:
        robot.module("base").send(vx_m_s=0.5)
        link.pass_time(0.06)
    drain(link)
    assert [message.validity_ms for message in given] == [0]


@pytest.mark.parametrize(
    ("change", "count"), [("READY -> ENABLING", 1), ("ACTIVE -> FAULT (stalled)", 2)]
)
def test_inputs_from_before_a_motor_was_enabled_do_not_come_back_for_the_end(
    lapsing: Client,
    daemon: FakeDaemon,
    link: VirtualLink,
    given: list[signals_t],
    change: str,
    count: int,
) -> None:
    with lapsing as robot:
        robot.module("base").send(vx_m_s=0.5, validity_ms=1000)
        daemon.publish_event(change, code=100)
    drain(link)
    assert len(given) == count


def test_an_end_that_does_not_exist_is_refused_at_once(link: VirtualLink) -> None:
    with pytest.raises(ValueError, match="at_end='hold': use timeout, disable, coast"):
        Client(link, "hold")  # type: ignore[arg-type]


def test_leaving_lets_go_of_what_was_taken(
    client: Client, daemon: FakeDaemon, link: VirtualLink
) -> None:
    with client as robot:
        robot.enable(["wheel", "yaw"])
        robot.command(wheel=rc10.velocity_rpm(120), yaw=rc10.angle_deg(3))
    drain(link)
    assert [setpoints(one) for one in daemon.commands[-2:]] == [{"wheel": COAST}, {"yaw": COAST}]
    assert daemon.operations() == ["enable wheel,yaw", "disable wheel,yaw"]
    assert daemon.commands[-1].seq > daemon.commands[-2].seq


@pytest.mark.parametrize("error", [RuntimeError("bug"), KeyboardInterrupt(), SystemExit(3)])
def test_leaving_by_an_exception_lets_go_too(
    client: Client, daemon: FakeDaemon, link: VirtualLink, error: BaseException
) -> None:
    def use() -> None:
        with client as robot:
            robot.enable("wheel")
            robot.command(wheel=rc10.velocity_rpm(120))
            raise error

    with pytest.raises(type(error)) as caught:
        use()
    assert caught.value is error
    drain(link)
    assert setpoints(daemon.commands[-1]) == {"wheel": COAST}
    assert daemon.operations()[-1] == "disable wheel"


def test_enabling_all_disables_all(client: Client, daemon: FakeDaemon) -> None:
    with client as robot:
        robot.enable("wheel")
        robot.enable()
    assert daemon.operations() == ["enable wheel", "enable", "disable"]


def test_a_mere_observer_leaves_without_a_word(
    client: Client, daemon: FakeDaemon, link: VirtualLink
) -> None:
    daemon.publish_state()
    with client as robot:
        robot.wait_for_state()
    drain(link)
    assert not daemon.commands
    assert not daemon.received


def test_what_was_disabled_by_hand_is_not_disabled_again(
    client: Client, daemon: FakeDaemon
) -> None:
    with client as robot:
        robot.enable(["wheel", "yaw"])
        robot.disable("wheel")
    assert daemon.operations()[-1] == "disable yaw"


def test_a_refused_enable_took_nothing(client: Client, daemon: FakeDaemon) -> None:
    daemon.verdicts["enable"] = (response_t.STATUS_REFUSED, "robot is in ESTOP")
    with pytest.raises(rc10.RequestRefused), client as robot:
        robot.enable("wheel")
    assert daemon.operations() == ["enable wheel"]


def test_a_failed_enable_may_have_taken_some(client: Client, daemon: FakeDaemon) -> None:
    daemon.verdicts["enable"] = (response_t.STATUS_FAILED, "yaw: OFFLINE")
    with pytest.raises(rc10.RequestFailed), client as robot:
        robot.enable(["wheel", "yaw"])
    assert daemon.operations() == ["enable wheel,yaw", "disable wheel,yaw"]


def test_an_unanswered_enable_may_have_worked(client: Client, daemon: FakeDaemon) -> None:
    daemon.lost_answers = 20
    with pytest.raises(rc10.Timeout), client as robot:
        robot.enable("wheel")
    assert daemon.operations() == ["enable wheel", "disable wheel"]


def test_motors_that_are_gone_do_not_spoil_the_release_of_the_others(
    client: Client, daemon: FakeDaemon, link: VirtualLink
) -> None:
    with client as robot:
        robot.enable(["wheel", "yaw"])
        robot.command(wheel=rc10.velocity_rpm(1), yaw=rc10.velocity_rpm(1))
        daemon.motors = ("wheel",)
        daemon.publish_state()
        robot.wait_for_state()
    drain(link)
    assert setpoints(daemon.commands[-1]) == {"wheel": COAST}
    assert daemon.operations()[-1] == "disable wheel"


def test_leaving_a_dead_daemon_is_short_and_logged(
    client: Client, daemon: FakeDaemon, link: VirtualLink, caplog: pytest.LogCaptureFixture
) -> None:
    with client as robot:
        robot.enable("wheel")
        daemon.deaf_to_requests = 1000
        before_s = link.now()
    assert link.now() - before_s == pytest.approx(0.5)
    (record,) = caplog.records
    assert "leaving demo: motors may still be enabled: no answer to 'disable'" in record.message


def test_a_closed_robot_says_so(client: Client) -> None:
    client.close()
    client.close()
    for use in (
        client.spin,
        client.estop,
        client.enable,
        lambda: client.command(wheel=rc10.coast()),
    ):
        with pytest.raises(rc10.LinkError, match="'demo' is closed"):
            use()


def test_what_it_commanded_and_did_not_enable_ends_at_once_too(
    daemon: FakeDaemon, link: VirtualLink
) -> None:
    with Client(link, "disable") as robot:
        robot.enable("yaw")
        robot.command(wheel=rc10.velocity_rpm(120), yaw=rc10.angle_deg(3), validity_ms=1000)
    drain(link)
    last = daemon.commands[-1]
    assert setpoints(last) == {"wheel": (rc10.Mode.VELOCITY, 120)}
    assert last.validity_ms == 1
    assert daemon.operations() == ["enable yaw", "disable yaw"]
