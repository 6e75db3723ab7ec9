"""Losses: the client, the gateway, the interface, the daemon, the wall clock's place."""

from __future__ import annotations

import signal
import sys
import time
from pathlib import Path

import pytest
from guestlib import Candump, Frame, Proc, link_add, link_delete, link_down, link_up, run
from rig import (
    C6XX_COMMAND,
    COMMAND_IDS,
    MS,
    client,
    commands,
    currents,
    daemon,
    drive,
    enabled_robot,
    fakes,
    gateway_pid,
    next_diagnostics,
    receiving,
    wait_status,
)

import rc10

HOLD = Path(__file__).with_name("hold_velocity.py")
VALIDITY_MS = 40


def holder() -> Proc:
    return Proc(sys.executable, HOLD, "vcan_mixed", "left", "100", str(VALIDITY_MS))


def last_drive_ns(frames: list[Frame]) -> int:
    """When the last frame with a current left."""
    return max(frame.t_ns for frame in commands(frames, C6XX_COMMAND) if any(frame.data))


@pytest.mark.parametrize("sig", [signal.SIGKILL, signal.SIGSTOP])
def test_losing_the_client_ends_in_zero_current_within_validity_and_a_tick(sig: int) -> None:
    with fakes(), daemon(), Candump("vcan0") as bus:
        with holder() as hold:
            hold.wait_line("holding", 10.0)
            time.sleep(0.3)
            lost_ns = time.time_ns()
            hold.signal(sig)
            time.sleep(0.3)
            if sig == signal.SIGSTOP:
                hold.signal(signal.SIGKILL)
        bus.stop()
        last = last_drive_ns(bus.frames())
        assert last > lost_ns - 20 * MS  # it was driving
        assert last <= lost_ns + (VALIDITY_MS + 1) * MS


def test_killing_the_gateway_ends_in_zero_current_and_it_comes_back() -> None:
    with fakes(), daemon() as process, Candump("vcan0") as bus, holder() as hold:
        hold.wait_line("holding", 10.0)
        time.sleep(0.3)
        lost_ns = time.time_ns()
        run("kill", "-KILL", str(gateway_pid()))
        process.wait_line("rc10-lcm ended .killed by signal 9", 5.0)
        # The client's loop goes on all the time; a new gateway lets it act again.
        again = bus.wait_frame(
            lambda f: (
                f.id == C6XX_COMMAND and any(f.data) and f.t_ns > lost_ns + (VALIDITY_MS + 1) * MS
            ),
            10.0,
        )
        bus.stop()
        pause = [
            f
            for f in commands(bus.frames(), C6XX_COMMAND)
            if lost_ns + (VALIDITY_MS + 1) * MS < f.t_ns < again.t_ns
        ]
        assert len(pause) > 20
        assert all(currents(frame) == (0, 0, 0, 0) for frame in pause)


def test_no_command_from_before_the_stop_acts_after_the_gateway_continues() -> None:
    with fakes(), daemon(), Candump("vcan0") as bus:
        pid = gateway_pid()
        with holder() as hold:
            hold.wait_line("holding", 10.0)
            time.sleep(0.3)
            stopped_ns = time.time_ns()
            run("kill", "-STOP", str(pid))
            # Thirty more commands wait in the gateway's socket, then the client is gone.
            time.sleep(0.3)
            hold.signal(signal.SIGKILL)
        time.sleep(0.2)
        run("kill", "-CONT", str(pid))
        time.sleep(0.5)
        bus.stop()
        assert last_drive_ns(bus.frames()) <= stopped_ns + (VALIDITY_MS + 1) * MS


@pytest.mark.parametrize("reader", ["tick", "thread"])
def test_the_interface_down_and_up_is_survived(reader: str) -> None:
    with enabled_robot(receiving(reader)) as (process, robot):
        drive(robot, 0.2, left=rc10.velocity_rpm(100))
        link_down("vcan0")
        process.wait_line("bus interface down", 5.0)
        drive(robot, 0.3, left=rc10.velocity_rpm(100))
        assert robot.motor("left").status is rc10.MotorStatus.OFFLINE
        link_up("vcan0")
        with Candump("vcan0") as bus:
            wait_status(robot, rc10.MotorStatus.READY)
            drive(robot, 0.2, left=rc10.velocity_rpm(100))
            bus.stop()
            # It comes back at rest: enabling is a person's decision.
            assert all(
                currents(frame) == (0, 0, 0, 0) for frame in commands(bus.frames(), C6XX_COMMAND)
            )
        robot.enable()
        drive(robot, 1.0, left=rc10.velocity_rpm(100))
        assert abs(robot.motor("left").velocity_rpm - 100) < 2


def test_an_interface_that_is_deleted_and_made_again_is_used_again() -> None:
    with daemon() as process, client() as robot:
        with fakes():
            wait_status(robot, rc10.MotorStatus.READY)
            link_delete("vcan0")
            process.wait_line("bus interface gone", 5.0)
            wait_status(robot, rc10.MotorStatus.OFFLINE)
        link_add("vcan0")
        with fakes():
            wait_status(robot, rc10.MotorStatus.READY)
            robot.enable()
            drive(robot, 1.0, left=rc10.velocity_rpm(100))
            assert abs(robot.motor("left").velocity_rpm - 100) < 2
            state = next_diagnostics(robot).buses["mixed"]
            assert state.restarts >= 1
            assert state.tx_confirmed > 0


def test_sigterm_ends_with_rest_frames_last_on_the_wire() -> None:
    with fakes(), Candump("vcan0") as bus, daemon() as process, holder() as hold:
        hold.wait_line("holding", 10.0)
        time.sleep(0.3)
        asked_ns = time.time_ns()
        assert process.stop(signal.SIGTERM) == 0
        bus.stop()
        for number in COMMAND_IDS:
            sent = commands(bus.frames(), number)
            assert [currents(frame) for frame in sent[-3:]] == [(0, 0, 0, 0)] * 3
        assert last_drive_ns(bus.frames()) <= asked_ns + 60 * MS


@pytest.mark.parametrize("step_s", [3600, -3600])
def test_a_step_of_the_wall_clock_changes_nothing(step_s: int) -> None:
    with enabled_robot() as (_, robot):
        missed = next_diagnostics(robot).missed_ticks
        robot.events()
        drive(robot, 1.0, left=rc10.velocity_rpm(100), feeder=rc10.velocity_rpm(300))
        with Candump("vcan0") as bus:
            before = drive(robot, 0.2, left=rc10.velocity_rpm(100), feeder=rc10.velocity_rpm(300))
            time.clock_settime(time.CLOCK_REALTIME, time.time() + step_s)
            after = drive(robot, 0.8, left=rc10.velocity_rpm(100), feeder=rc10.velocity_rpm(300))
            bus.stop()
        # Not one tick without current, no timeout, no turn counted wrongly, no tick missed.
        assert all(currents(frame)[2] != 0 for frame in commands(bus.frames(), C6XX_COMMAND)[:950])
        assert all(abs(s.motors["left"].velocity_rpm - 100) < 2 for s in before + after)
        seconds = (after[-1].tick - before[0].tick) / 1000
        turned_deg = (
            after[-1].motors["feeder"].total_angle_deg - before[0].motors["feeder"].total_angle_deg
        )
        assert turned_deg == pytest.approx(300 * 6 * seconds, rel=0.02)
        assert robot.events() == []
        assert next_diagnostics(robot).missed_ticks == missed


def test_a_bus_off_frame_becomes_a_state_and_a_restart_ends_it() -> None:
    with fakes(), daemon() as process:
        run("cansend", "vcan0", "20000040#0000000000000000")
        process.wait_line("bus bus-off", 5.0)
        run("cansend", "vcan0", "20000100#0000000000000000")
        process.wait_line("bus active", 5.0)
        run("cansend", "vcan0", "20000204#0020000000008800")
        process.wait_line("bus error-passive", 5.0)
        with client() as robot:
            assert next_diagnostics(robot).buses["mixed"].tec == 0x88
