"""Robot.joints(): motors as arrays in radians."""

from __future__ import annotations

import math

import numpy as np
import pytest

import rc10
from fake_daemon import FakeDaemon, setpoints
from rc10.lcm_types import robot_state_t
from virtual_link import VirtualLink

LEG = ("yaw", "wheel")


class LegDaemon(FakeDaemon):
    """Its motors stand at angles of their own."""

    def state(self) -> robot_state_t:
        message = super().state()
        for i, motor in enumerate(message.motors):
            motor.total_angle_deg = 180.0 * (i + 1)
            motor.velocity_rpm = 30.0 * i
            motor.torque_nm = 0.5 * i
        return message


@pytest.fixture
def daemon(link: VirtualLink) -> LegDaemon:
    return LegDaemon("demo", link, active={"wheel", "yaw", "left-arm"})


@pytest.fixture
def ready(robot: rc10.Robot, daemon: LegDaemon) -> rc10.Robot:
    daemon.publish_state()
    robot.wait_for_state()
    return robot


def test_readings_are_arrays_in_si_units_in_the_order_of_the_names(ready: rc10.Robot) -> None:
    leg = ready.joints(LEG)
    assert len(leg) == 2
    np.testing.assert_allclose(leg.q, [2 * math.pi, math.pi])
    np.testing.assert_allclose(leg.dq, [math.pi, 0.0])
    np.testing.assert_allclose(leg.tau, [0.5, 0.0])


def test_without_names_they_are_all_motors(ready: rc10.Robot) -> None:
    assert ready.joints().names == ("wheel", "yaw", "left-arm")


def test_a_name_alone_is_one_motor(ready: rc10.Robot, daemon: LegDaemon) -> None:
    assert ready.joints("wheel").names == ("wheel",)
    with ready.recorder("wheel") as recorder:
        daemon.publish_state()
        ready.spin()
    assert list(recorder.recording().motors) == ["wheel"]


def test_gains_make_springs_and_dampers(ready: rc10.Robot, daemon: LegDaemon) -> None:
    ready.joints(LEG).command(q=[math.pi, 0], dq=0.0, kp=[20, 30], kd=0.5, tau=[0, 1])
    ready.spin()
    first, second = daemon.commands[-1].setpoints
    assert (first.motor, second.motor) == LEG
    assert first.mode == second.mode == rc10.Mode.IMPEDANCE
    assert first.value == pytest.approx(180.0)
    assert (first.stiffness_nm_per_rad, second.stiffness_nm_per_rad) == (20, 30)
    assert (first.damping_nms_per_rad, second.torque_ff_nm) == (0.5, 1)


def test_damping_alone_is_around_the_present_angle(ready: rc10.Robot, daemon: LegDaemon) -> None:
    ready.joints(LEG).command(kd=1.0)
    ready.spin()
    assert [order.value for order in daemon.commands[-1].setpoints] == pytest.approx([360, 180])
    assert [order.stiffness_nm_per_rad for order in daemon.commands[-1].setpoints] == [0, 0]


def test_without_gains_the_loops_of_the_motors_act(ready: rc10.Robot, daemon: LegDaemon) -> None:
    leg = ready.joints(LEG)
    leg.command(q=math.pi, dq=math.pi)
    leg.command(dq=[math.pi, 0], tau=0.25)
    leg.command(tau=[0.5, 0])
    ready.spin()
    angle, velocity, torque = daemon.commands
    assert setpoints(angle)["yaw"][0] == rc10.Mode.TOTAL_ANGLE
    assert setpoints(angle)["yaw"][1] == pytest.approx(180.0)
    assert angle.setpoints[0].velocity_ff_rpm == pytest.approx(30.0)
    assert setpoints(velocity)["yaw"][0] == rc10.Mode.VELOCITY
    assert setpoints(velocity)["yaw"][1] == pytest.approx(30.0)
    assert velocity.setpoints[1].torque_ff_nm == 0.25
    assert setpoints(torque)["yaw"] == (rc10.Mode.CURRENT, 0.0)
    assert torque.setpoints[0].torque_ff_nm == 0.5


def test_mistakes_name_the_array_and_the_motor(ready: rc10.Robot, daemon: LegDaemon) -> None:
    leg = ready.joints(LEG)
    with pytest.raises(ValueError, match=r"q has the shape \(3,\): .* array of 2, for yaw, wheel"):
        leg.command(q=[1, 2, 3])
    with pytest.raises(rc10.InvalidSetpoint, match="q of wheel is nan"):
        leg.command(q=[0, math.nan])
    with pytest.raises(ValueError, match="at least one of q"):
        leg.command()
    with pytest.raises(rc10.UnknownMotor, match="did you mean wheel"):
        ready.joints(["whel"])
    with pytest.raises(ValueError, match="twice"):
        ready.joints(["yaw", "yaw"])
    ready.spin()
    assert not daemon.commands
