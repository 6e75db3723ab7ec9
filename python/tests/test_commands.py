from __future__ import annotations

import math

import pytest

import rc10
from fake_daemon import FakeDaemon, setpoints
from rc10.lcm_types import command_t, request_t


def known(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.publish_state()
    robot.wait_for_state()


def test_one_call_sends_one_message_with_all_setpoints(
    robot: rc10.Robot, daemon: FakeDaemon
) -> None:
    robot.command(wheel=rc10.velocity_rpm(120), yaw=rc10.angle_deg(90), validity_ms=30)
    robot.spin()
    (message,) = daemon.commands
    assert setpoints(message) == {
        "wheel": (rc10.Mode.VELOCITY, 120.0),
        "yaw": (rc10.Mode.ANGLE, 90.0),
    }
    assert message.client == "tester"
    assert message.priority == 7
    assert message.validity_ms == 30
    assert message.utime > 0


def test_the_default_validity_is_the_hosts(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    robot.command(wheel=rc10.brake())
    robot.spin()
    assert daemon.commands[0].validity_ms == 0


def test_names_that_are_no_identifiers_come_in_a_mapping(
    robot: rc10.Robot, daemon: FakeDaemon
) -> None:
    robot.command({"left-arm": rc10.current_a(1)}, yaw=rc10.coast())
    robot.spin()
    assert set(setpoints(daemon.commands[0])) == {"left-arm", "yaw"}


def test_fields_that_are_not_given_are_not_sent(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    robot.command(wheel=rc10.velocity_rpm(1))
    robot.spin()
    (setpoint,) = daemon.commands[0].setpoints
    assert (setpoint.velocity_ff_rpm, setpoint.torque_ff_nm) == (0.0, 0.0)
    assert math.isnan(setpoint.stiffness_nm_per_rad)
    assert math.isnan(setpoint.damping_nms_per_rad)


def test_the_session_stays_and_the_number_grows(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    for rpm in range(5):
        robot.command(wheel=rc10.velocity_rpm(rpm))
        robot.clear()
    robot.spin()
    sent: list[command_t | request_t] = [*daemon.commands, *daemon.executed]
    assert len({message.session for message in sent}) == 1
    assert 0 < sent[0].session < 2**63
    numbers = [message.seq for message in daemon.commands]
    assert numbers == sorted(set(numbers))
    assert len({message.seq for message in sent}) == len(sent)


def test_two_runs_of_a_program_have_different_sessions(daemon: FakeDaemon) -> None:
    robots = [rc10.Robot("demo", daemon.link, client="tester") for _ in range(2)]
    for robot in robots:
        robot.command(wheel=rc10.coast())
    robots[0].spin()
    assert daemon.commands[0].session != daemon.commands[1].session


def test_nothing_repeats_a_command(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.publish_states()
    robot.command(wheel=rc10.velocity_rpm(1))
    for _ in range(50):
        robot.wait_for_state()
    assert len(daemon.commands) == 1


def test_an_unknown_motor_is_refused_once_the_robot_is_known(
    robot: rc10.Robot, daemon: FakeDaemon
) -> None:
    robot.command(wheeel=rc10.coast())
    robot.spin()
    assert len(daemon.commands) == 1
    known(robot, daemon)
    with pytest.raises(rc10.UnknownMotor, match=r"no motor 'wheeel'; it has: wheel, yaw"):
        robot.command(wheel=rc10.coast(), wheeel=rc10.coast())
    robot.spin()
    assert len(daemon.commands) == 1


def test_a_bare_number_is_refused(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    with pytest.raises(TypeError, match=r"wheel: 120 is not a setpoint.*velocity_rpm\(120\)"):
        robot.command(wheel=120)  # type: ignore[arg-type]
    robot.spin()
    assert not daemon.commands


def test_a_command_must_say_something(robot: rc10.Robot) -> None:
    with pytest.raises(ValueError, match="at least one"):
        robot.command()
    with pytest.raises(ValueError, match="two setpoints for yaw"):
        robot.command({"yaw": rc10.coast()}, yaw=rc10.brake())
    with pytest.raises(ValueError, match="validity_ms = -1"):
        robot.command(yaw=rc10.brake(), validity_ms=-1)
    with pytest.raises(ValueError, match="validity_ms = 1001 is out of range; use 1 to 1000"):
        robot.command(yaw=rc10.brake(), validity_ms=1001)


def test_a_command_to_a_motor_that_was_never_active_raises_and_sends_nothing(
    robot: rc10.Robot, daemon: FakeDaemon
) -> None:
    known(robot, daemon)
    with pytest.raises(rc10.CommandRefused, match="wheel is READY: enable it first"):
        robot.command(wheel=rc10.velocity_rpm(1))
    robot.command(wheel=rc10.coast())
    robot.enable("wheel")
    robot.command(wheel=rc10.velocity_rpm(2))
    robot.spin()
    assert [setpoints(message)["wheel"][1] for message in daemon.commands] == [0, 2]


def test_a_motor_that_another_program_has_just_enabled_obeys(
    robot: rc10.Robot, daemon: FakeDaemon
) -> None:
    known(robot, daemon)
    daemon.active = {"wheel"}
    daemon.publish_state()  # not received yet
    robot.command(wheel=rc10.velocity_rpm(1))
    robot.spin()
    assert len(daemon.commands) == 1


def test_a_motor_that_stops_later_does_not_end_a_loop_that_holds_others(
    robot: rc10.Robot, daemon: FakeDaemon
) -> None:
    daemon.active = {"wheel", "yaw"}
    known(robot, daemon)
    robot.command(wheel=rc10.velocity_rpm(1), yaw=rc10.velocity_rpm(1))
    daemon.active = {"yaw"}
    known(robot, daemon)
    robot.command(wheel=rc10.velocity_rpm(1), yaw=rc10.velocity_rpm(1))
    assert robot.motor("wheel").status is rc10.MotorStatus.READY


def test_a_mode_that_rc10d_has_refused_raises_when_it_is_asked_for_again(
    robot: rc10.Robot, daemon: FakeDaemon
) -> None:
    daemon.active = {"wheel"}
    known(robot, daemon)
    stiff = rc10.impedance_deg(0, stiffness_nm_per_rad=1, damping_nms_per_rad=0)
    robot.command(wheel=stiff)
    text = (
        "command of 'tester' refused: wheel: impedance: the motor's drive does not support the mode"
    )
    daemon.publish_event(text, code=202, client="another")
    robot.spin()
    robot.command(wheel=stiff)
    daemon.publish_event(text, code=202, client="tester")
    robot.spin()
    with pytest.raises(rc10.CommandRefused, match="wheel: impedance"):
        robot.command(wheel=stiff)
    robot.command(wheel=rc10.velocity_rpm(1))
    daemon.publish_event(
        "command of 'tester' refused: wheel: velocity: a value is not finite", 202, "tester"
    )
    robot.spin()
    robot.command(wheel=rc10.velocity_rpm(1))
    with pytest.raises(rc10.CommandRefused, match="wheel: impedance"):
        robot.command(wheel=stiff)


def test_gains_beyond_the_drive_raise_once_rc10d_has_named_its_range(
    robot: rc10.Robot, daemon: FakeDaemon
) -> None:
    def spring(stiffness: float, damping: float) -> rc10.Setpoint:
        return rc10.impedance_deg(0, stiffness_nm_per_rad=stiffness, damping_nms_per_rad=damping)

    robot.command(wheel=spring(1e6, 500))
    daemon.publish_event(
        "command of 'tester' refused: wheel: impedance: stiffness or damping out of what the "
        "motor's drive takes: 0 to 500 Nm/rad, 0 to 5 Nms/rad",
        code=202,
        client="tester",
    )
    robot.spin()
    for beyond in (spring(1e6, 1), spring(500, 5.5)):
        with pytest.raises(rc10.CommandRefused, match=r"wheel: impedance: .* 0 to 500 Nm/rad"):
            robot.command(wheel=beyond)
    robot.command(wheel=spring(500, 5))
    robot.command(lift=spring(1e6, 1))


def test_a_refused_message_is_logged_once_in_the_words_of_rc10d(
    robot: rc10.Robot, daemon: FakeDaemon, caplog: pytest.LogCaptureFixture
) -> None:
    text = "command of 'tester' refused: the module has no input of that name"
    robot.module("base").send(vx=0.5)
    for client in ("another", "tester", "tester"):
        daemon.publish_event(text, code=202, client=client)
    daemon.publish_event("another event", client="tester")
    robot.spin()
    assert caplog.messages == [f"rc10d says: wheel: {text}"]


def test_a_misspelt_motor_is_suggested(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    known(robot, daemon)
    with pytest.raises(rc10.UnknownMotor, match=r"did you mean wheel\?"):
        robot.enable("whel")
    with pytest.raises(rc10.UnknownMotor, match=r"did you mean wheel\?"):
        robot.motor("wheeel")
