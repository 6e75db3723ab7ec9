"""rc10-sim in place of the fakes: motors with physics on real SocketCAN."""

from __future__ import annotations

from typing import TYPE_CHECKING

from guestlib import Candump, Proc
from rig import (
    BIN,
    C6XX_COMMAND,
    CONFIG,
    client,
    commands,
    currents,
    daemon,
    drive,
    wait_status,
)

import rc10

if TYPE_CHECKING:
    from pathlib import Path


def simulator() -> Proc:
    return Proc(BIN / "rc10-sim", "-c", CONFIG)


def test_the_simulated_motors_follow_their_targets() -> None:
    with simulator() as motors, daemon(), client() as robot:
        motors.wait_line("^ready: 5 motors", 10.0)
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        state = drive(
            robot,
            3.0,
            left=rc10.velocity_rpm(120),
            right=rc10.total_angle_deg(-360),
            yaw=rc10.angle_deg(90),
        )[-1]
        assert abs(state.motors["left"].velocity_rpm - 120) < 2
        assert abs(state.motors["right"].total_angle_deg + 360) < 1
        assert abs(state.motors["yaw"].angle_deg - 90) < 1


def test_a_motor_that_is_too_fast_stops_and_the_state_says_why(tmp_path: Path) -> None:
    config = tmp_path / "robot.yaml"
    config.write_text(
        CONFIG.read_text().replace(
            "{name: left, model: M3508, id: 1,",
            "{name: left, model: M3508, id: 1, velocity_limit_rpm: 50, overspeed_rpm: 60,"
            " soft_start_ms: 0,",
        )
    )
    with simulator() as motors, Candump("vcan0") as bus, daemon(config), client() as robot:
        motors.wait_line("^ready", 10.0)
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        # A current, which no velocity limit holds back.
        state = drive(robot, 2.0, left=rc10.current_a(2), right=rc10.velocity_rpm(120))[-1]
        bus.stop()
        assert state.motors["left"].status is rc10.MotorStatus.FAULT
        assert state.motors["left"].fault_text.startswith("over-speed")
        assert state.motors["right"].status is rc10.MotorStatus.ACTIVE
        assert abs(state.motors["right"].velocity_rpm - 120) < 3
        sent = [currents(frame)[0] for frame in commands(bus.frames(), C6XX_COMMAND)]
        pushed = [i for i, raw in enumerate(sent) if raw != 0]
        # 2 A of 20 A full scale, then nothing more, for as long as it is commanded.
        assert {sent[i] for i in pushed} == {1638}
        assert len(sent) - pushed[-1] > 1000


def test_a_higher_priority_takes_a_motor_over_and_keeps_it() -> None:
    with simulator() as motors, daemon(), client("planner") as planner:
        motors.wait_line("^ready", 10.0)
        wait_status(planner, rc10.MotorStatus.READY)
        planner.enable()
        with rc10.connect(planner.name, client="remote", priority=5) as remote:
            remote.wait_for_state(10.0)
            for t_s in planner.rate(100):
                planner.command({"left": rc10.velocity_rpm(100)})
                if 0.5 <= t_s < 1.5:
                    remote.command({"left": rc10.velocity_rpm(-40)})
                if t_s >= 1.5:
                    break
            taken = planner.state.motors["left"]
            assert taken.owner == "remote"
            assert abs(taken.velocity_rpm + 40) < 3
        back = drive(planner, 1.0, left=rc10.velocity_rpm(100))[-1].motors["left"]
        assert back.owner == "planner"
        assert abs(back.velocity_rpm - 100) < 3
