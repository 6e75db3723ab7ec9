"""Targets are followed over real SocketCAN, and the right bytes leave."""

from __future__ import annotations

from guestlib import Candump
from rig import (
    C6XX_COMMAND,
    GM6020_COMMAND,
    client,
    commands,
    currents,
    daemon,
    drive,
    enabled_robot,
    fakes,
    wait_status,
)

import rc10


def test_nothing_is_active_at_start_and_only_rest_leaves() -> None:
    with fakes(), Candump("vcan0") as bus, daemon(), client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        for t_s in robot.rate(100):
            if t_s >= 0.5:
                break
            # As a program in another language would: command() refuses it.
            robot._publish_command({"left": rc10.velocity_rpm(100)}, validity_ms=0)
        bus.stop()
        assert robot.state is not None
        assert all(motor.status is rc10.MotorStatus.READY for motor in robot.state.motors.values())
        for number in (C6XX_COMMAND, GM6020_COMMAND):
            sent = commands(bus.frames(), number)
            assert len(sent) > 500
            assert all(currents(frame) == (0, 0, 0, 0) for frame in sent)


def test_steps_of_velocity_angle_and_total_angle_settle() -> None:
    # All three models on one bus, at once.
    with enabled_robot() as (_, robot):
        states = drive(
            robot,
            2.0,
            left=rc10.velocity_rpm(120),
            right=rc10.total_angle_deg(-360),
            feeder=rc10.total_angle_deg(720),
            yaw=rc10.angle_deg(90),
            pitch=rc10.velocity_rpm(-60),
        )
        settled = [
            state for state in states if state.age_s >= 0 and state.tick > states[-1].tick - 500
        ]
        assert len(settled) > 20
        for state in settled:
            motors = state.motors
            assert abs(motors["left"].velocity_rpm - 120) < 2
            assert abs(motors["pitch"].velocity_rpm + 60) < 3
            assert abs(motors["right"].total_angle_deg + 360) < 1
            assert abs(motors["feeder"].total_angle_deg - 720) < 1
            assert abs(motors["yaw"].angle_deg - 90) < 1


def test_a_commanded_current_reaches_the_bus_as_the_right_bytes() -> None:
    with enabled_robot() as (_, robot):
        still = rc10.current_a(0.0)
        drive(robot, 0.3, left=still, right=still, feeder=still, yaw=still)  # the soft start
        with Candump("vcan0") as bus:
            drive(
                robot,
                0.1,
                left=rc10.current_a(2.0),  # 2 / 20 * 16384 = 1638.4
                right=rc10.current_a(1.0),  # direction -1: -819.2
                feeder=rc10.current_a(-2.5),  # -2.5 / 10 * 10000
                yaw=rc10.current_a(1.0),  # 1 / 3 * 16384 = 5461.3
            )
            bus.stop()
            c6xx = [frame for frame in commands(bus.frames(), C6XX_COMMAND) if any(frame.data)]
            gm6020 = [frame for frame in commands(bus.frames(), GM6020_COMMAND) if any(frame.data)]
            assert len(c6xx) > 90
            assert {frame.data.hex(" ") for frame in c6xx} == {"06 66 fc cd f6 3c 00 00"}
            assert {frame.data.hex(" ") for frame in gm6020} == {"15 55 00 00 00 00 00 00"}
