from __future__ import annotations

from typing import Callable

import pytest

import rc10
from fake_daemon import FakeDaemon, setpoints
from rc10 import MoveOutcome
from rc10.lcm_types import motor_state_t, request_t, response_t, robot_state_t, setpoint_t
from virtual_link import VirtualLink


class MovingDaemon(FakeDaemon):
    """Its wheel has an angle, and takes targets."""

    angle_deg = 0.0
    zeroed = True
    status = motor_state_t.STATUS_ACTIVE
    owner: str | None = None

    def state(self) -> robot_state_t:
        message = super().state()
        wheel = message.motors[0]
        wheel.total_angle_deg = self.angle_deg
        wheel.angle_deg = self.angle_deg % 360
        wheel.zeroed = self.zeroed
        wheel.status = self.status
        if self.commands:
            wheel.mode, wheel.target = setpoints(self.commands[-1]).get("wheel", (0, 0.0))
            wheel.owner = self.owner if self.owner is not None else self.commands[-1].client
        return message

    def _execute(self, request: request_t) -> response_t:
        if request.operation == "enable":
            # Taken before the answer, and on its way behind it.
            older = self.state().encode()
            assert isinstance(self.link, VirtualLink)
            self.link.after(0.0, lambda: self.link.publish(self.channel("state"), older))
            self.status = motor_state_t.STATUS_ACTIVE
        return super()._execute(request)


@pytest.fixture
def daemon(link: VirtualLink) -> MovingDaemon:
    daemon = MovingDaemon("demo", link)
    daemon.publish_states()
    return daemon


def expect_silence(robot: rc10.Robot, daemon: MovingDaemon) -> None:
    """No command comes for 50 states."""
    sent = len(daemon.commands)
    for _ in range(50):
        robot.wait_for_state()
    assert len(daemon.commands) == sent


def test_a_move_is_done_when_the_motor_stands_there(
    robot: rc10.Robot, daemon: MovingDaemon, link: VirtualLink
) -> None:
    robot.wait_for_state()
    before_s = link.now()
    move = robot.move_to("wheel", 720, tolerance_deg=2)
    link.after(1.0, lambda: setattr(daemon, "angle_deg", 719.0))
    assert not move.done()
    result = move.result()
    assert result
    assert result.outcome is MoveOutcome.DONE
    assert result.angle_deg == 719.0
    assert link.now() - before_s == pytest.approx(1.06, abs=0.02)


def test_its_target_is_sent_again_while_the_program_receives(
    robot: rc10.Robot, daemon: MovingDaemon
) -> None:
    robot.wait_for_state()
    robot.move_to("wheel", 720)
    for t_s in robot.rate(10):
        if t_s > 0.95:
            break
    assert 40 <= len(daemon.commands) <= 52
    assert {c.validity_ms for c in daemon.commands} == {100}
    assert all(setpoints(c)["wheel"] == (setpoint_t.MODE_TOTAL_ANGLE, 720) for c in daemon.commands)


def test_a_move_goes_the_shortest_way_round(robot: rc10.Robot, daemon: MovingDaemon) -> None:
    robot.wait_for_state()
    daemon.angle_deg = 0.5
    assert robot.move_to("wheel", 359.5, tolerance_deg=2, shortest_way=True).result()
    assert setpoints(daemon.commands[0])["wheel"] == (setpoint_t.MODE_ANGLE, 359.5)


def test_a_move_times_out(robot: rc10.Robot, daemon: MovingDaemon) -> None:
    robot.wait_for_state()
    daemon.angle_deg = 300
    result = robot.move_to("wheel", 720, timeout_s=2).result()
    assert result.outcome is MoveOutcome.TIMEOUT
    assert result.reason == "wheel is at 300 deg and not at 720 after 2 s"
    assert not result


@pytest.mark.parametrize(
    ("attribute", "value", "reason"),
    [
        ("status", motor_state_t.STATUS_FAULT, "in FAULT"),
        ("status", motor_state_t.STATUS_OFFLINE, "OFFLINE"),
        ("zeroed", False, "no reference"),
        ("estopped", True, "ESTOP"),
        ("owner", "remote", "held by the client 'remote'"),
        ("owner", "", "lost the target"),
    ],
)
def test_a_move_fails_with_the_reason(
    robot: rc10.Robot,
    daemon: MovingDaemon,
    link: VirtualLink,
    attribute: str,
    value: object,
    reason: str,
) -> None:
    robot.wait_for_state()
    move = robot.move_to("wheel", 720)
    link.after(0.1, lambda: setattr(daemon, attribute, value))
    result = move.result()
    assert result.outcome is MoveOutcome.FAILED
    assert reason in result.reason
    # And nothing is sent any more.
    sent = len(daemon.commands)
    robot.spin(1.0)
    assert len(daemon.commands) == sent


def test_a_move_whose_target_is_never_taken_fails(robot: rc10.Robot, daemon: MovingDaemon) -> None:
    robot.wait_for_state()
    daemon.owner = ""
    assert "did not take the target" in robot.move_to("wheel", 720).result().reason


def test_a_move_goes_on_after_a_target_that_lapsed_for_a_moment(
    robot: rc10.Robot, daemon: MovingDaemon, link: VirtualLink
) -> None:
    robot.wait_for_state()
    daemon.angle_deg = 300
    move = robot.move_to("wheel", 720)
    owner = daemon.owner
    link.after(0.5, lambda: setattr(daemon, "owner", ""))
    link.after(0.7, lambda: setattr(daemon, "owner", owner))
    link.after(1.0, lambda: setattr(daemon, "angle_deg", 720))
    assert move.result()


def test_a_move_that_cannot_begin_has_failed(robot: rc10.Robot, daemon: MovingDaemon) -> None:
    daemon.status = motor_state_t.STATUS_READY
    robot.wait_for_state()
    move = robot.move_to("wheel", 720)
    assert move.done()
    assert move.result().reason == "wheel is READY: enable it first"
    assert not daemon.commands


def test_a_motor_that_was_just_enabled_moves_at_once(
    robot: rc10.Robot, daemon: MovingDaemon
) -> None:
    daemon.status = motor_state_t.STATUS_READY
    robot.wait_for_state()
    robot.enable("wheel")
    assert robot.motor("wheel").status is rc10.MotorStatus.ACTIVE
    assert robot.move_to("wheel", 0).result()


def test_a_state_from_before_it_was_enabled_ends_no_move(link: VirtualLink) -> None:
    daemon = MovingDaemon("demo", link)
    daemon.status = motor_state_t.STATUS_READY
    with rc10.Robot("demo", link, client="tester") as robot:
        daemon.publish_state()
        robot.spin()
        older = daemon.state().encode()
        robot.enable("wheel")  # no state comes but older ones
        move = robot.move_to("wheel", 0)
        link.publish(daemon.channel("state"), older)
        robot.spin()
        assert not move.done()
        daemon.publish_states()
        assert move.result()


def test_enabling_that_failed_is_told_by_the_state(robot: rc10.Robot, daemon: MovingDaemon) -> None:
    robot.wait_for_state()
    daemon.verdicts["enable"] = (response_t.STATUS_FAILED, "wheel: its drive did not confirm")
    with pytest.raises(rc10.RequestFailed):
        robot.enable("wheel")
    daemon.status = motor_state_t.STATUS_FAULT
    robot.wait_for_state()
    assert "in FAULT" in robot.move_to("wheel", 720).result().reason


def test_another_target_ends_it(robot: rc10.Robot, daemon: MovingDaemon) -> None:
    robot.wait_for_state()
    move = robot.move_to("wheel", 720)
    robot.command(wheel=rc10.brake())
    assert move.result().reason == "wheel was given another target"
    robot.spin(0.5)
    assert setpoints(daemon.commands[-1])["wheel"][0] == setpoint_t.MODE_BRAKE


@pytest.mark.usefixtures("daemon")
def test_leaving_ends_it(link: VirtualLink) -> None:
    with rc10.Robot("demo", link, client="tester") as robot:
        robot.wait_for_state()
        move = robot.move_to("wheel", 720)
    assert move.result().reason == "the program has let go of the robot"


def test_a_motor_that_was_lost_after_the_move_is_not_driven_when_it_is_back(
    robot: rc10.Robot, daemon: MovingDaemon
) -> None:
    robot.wait_for_state()
    daemon.angle_deg = 720
    assert robot.move_to("wheel", 720).result()
    daemon.status = motor_state_t.STATUS_OFFLINE
    robot.wait_for_state()
    robot.wait_for_state()
    daemon.status = motor_state_t.STATUS_ACTIVE
    expect_silence(robot, daemon)


def test_a_motor_that_another_client_takes_after_the_move_is_let_go(
    robot: rc10.Robot, daemon: MovingDaemon
) -> None:
    robot.wait_for_state()
    daemon.angle_deg = 720
    assert robot.move_to("wheel", 720).result()
    daemon.owner = "remote"
    robot.wait_for_state()
    robot.wait_for_state()
    daemon.owner = None
    sent = len(daemon.commands)
    robot.spin(1.0)
    expect_silence(robot, daemon)
    assert len(daemon.commands) == sent


def test_a_move_that_ended_is_not_sent_on_when_the_motor_has_not_obeyed_meanwhile(
    robot: rc10.Robot, daemon: MovingDaemon, link: VirtualLink
) -> None:
    robot.wait_for_state()
    daemon.angle_deg = 720
    assert robot.move_to("wheel", 720).result()
    sent = len(daemon.commands)
    # The program waits for somebody: its target lapses, and the motor is disabled and enabled.
    daemon.owner = ""
    link.pass_time(60.0)
    expect_silence(robot, daemon)
    assert len(daemon.commands) == sent


def test_a_motor_that_was_disabled_and_enabled_between_two_states_is_not_driven(
    robot: rc10.Robot, daemon: MovingDaemon
) -> None:
    robot.wait_for_state()
    move = robot.move_to("wheel", 720)
    robot.wait_for_state()
    daemon.publish_event(
        "ACTIVE -> READY (disabled by 'panel')", code=100, mono_us=robot.state.mono_us + 1
    )
    sent = len(daemon.commands)
    for _ in range(50):
        robot.wait_for_state()
    assert move.result().reason == "wheel: ACTIVE -> READY (disabled by 'panel')"
    assert len(daemon.commands) <= sent + 1


def test_a_motor_that_was_enabled_anew_while_the_program_stood_is_not_moved(
    robot: rc10.Robot, daemon: MovingDaemon, link: VirtualLink
) -> None:
    robot.wait_for_state()
    move = robot.move_to("wheel", 720)
    robot.spin(0.1)
    daemon.owner = ""  # disabled and enabled by others, and the events are lost
    link.pass_time(0.9)
    sent = len(daemon.commands)
    assert move.result().outcome is MoveOutcome.FAILED
    robot.spin(0.5)
    assert len(daemon.commands) == sent


STOPS: dict[str, Callable[[rc10.Robot], object]] = {
    "disable it": lambda robot: robot.disable("wheel"),
    "disable several": lambda robot: robot.disable(["yaw", "wheel"]),
    "disable all": lambda robot: robot.disable(),
    "disable also one that is not there": lambda robot: robot.disable(["wheel", "whel"]),
    "a request of its own": lambda robot: robot.request("disable", "wheel"),
    "estop": lambda robot: robot.estop(),
}
IN_VAIN: dict[str, Callable[[MovingDaemon], object]] = {
    "refused": lambda daemon: daemon.verdicts.update(
        dict.fromkeys(("disable", "estop"), (response_t.STATUS_REFUSED, "too many at once"))
    ),
    "failed": lambda daemon: daemon.verdicts.update(
        dict.fromkeys(("disable", "estop"), (response_t.STATUS_FAILED, "its drive is silent"))
    ),
    "not heard": lambda daemon: setattr(daemon, "deaf_to_requests", 1000),
}


@pytest.mark.parametrize("stop", STOPS)
@pytest.mark.parametrize("in_vain", IN_VAIN)
@pytest.mark.parametrize("arrived", [False, True])
def test_a_stop_in_vain_ends_it_all_the_same(
    robot: rc10.Robot, daemon: MovingDaemon, stop: str, in_vain: str, arrived: bool
) -> None:
    robot.wait_for_state()
    daemon.angle_deg = 720 if arrived else 300
    move = robot.move_to("wheel", 720)
    if arrived:
        assert move.result()
    robot.spin(0.1)
    IN_VAIN[in_vain](daemon)
    sent = len(daemon.commands)
    with pytest.raises(rc10.Rc10Error):
        STOPS[stop](robot)
    robot.spin(0.3)
    assert len(daemon.commands) <= sent + 1, "but for the one on its way"
    expect_silence(robot, daemon)
    assert move.done()
    if not arrived:
        assert move.result().reason == "the program has let go of wheel"


def test_disabling_another_motor_does_not_end_it(robot: rc10.Robot, daemon: MovingDaemon) -> None:
    robot.wait_for_state()
    daemon.angle_deg = 300
    move = robot.move_to("wheel", 720)
    robot.disable("yaw")
    began_s = robot.link.now()
    while robot.link.now() < began_s + 0.5:
        robot.spin(0.1)
    assert not move.done()
    assert len(daemon.commands) >= 20
