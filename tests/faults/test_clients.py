"""Clients that die, freeze, shout, lie or quarrel."""
# run-guest: --timeout 900

from __future__ import annotations

import math
import random
import signal
import sys
import time

import pytest
from faultrig import (
    COMMAND_PERIOD_MS,
    FRONT,
    HERE,
    TICK_NS,
    VALIDITY_MS,
    Stranger,
    client,
    daemon,
    drive,
    drives,
    proven,
    robot_under_test,
    witness,
)
from guestlib import Proc
from rig import wait_status

import rc10

HOLD = HERE.parent / "kernel" / "hold_velocity.py"
VELOCITY, TOTAL_ANGLE = 2, 4
WITHIN = VALIDITY_MS + 1


@pytest.mark.parametrize(
    ("number", "words"),
    [(signal.SIGKILL, "client killed"), (signal.SIGSTOP, "client frozen")],
)
def test_a_client_that_is_lost(number: signal.Signals, words: str) -> None:
    with drives(), witness() as log, daemon():
        start_ns = time.time_ns()
        with Proc(sys.executable, HOLD, "faults", "left", "100", str(VALIDITY_MS)) as hold:
            hold.wait_line("holding", 10.0)
            time.sleep(0.3)
            hold.signal(number)
            lost_ns = time.time_ns()
            time.sleep(0.3)
            if number == signal.SIGSTOP:
                hold.signal(signal.SIGKILL)
        last_ns = log.last_torque_ns("left")
        assert last_ns > lost_ns - 2 * COMMAND_PERIOD_MS * TICK_NS  # it was driving
        log.driven(start_ns, lost_ns, "left")
        log.check()
        proven(words, "rest after the validity of the last command", lost_ns, last_ns, WITHIN)


def test_values_that_are_no_numbers() -> None:
    with robot_under_test() as (_, robot, log):
        stranger = Stranger()
        for value in (math.nan, math.inf, -math.inf):
            for _ in range(10):
                stranger.command("left", VELOCITY, value)
                time.sleep(0.005)
        assert log.last_torque_ns("left") == 0
        log.check()
        wait_refusals(robot, "not finite", 30)
        proven("NaN and infinite targets", "refused, counted, told", None, None, 0)


def wait_refusals(robot: rc10.Robot, reason: str, at_least: int) -> int:
    deadline = time.monotonic() + 5.0
    while True:
        robot.wait_for_state(5.0)
        try:
            count = dict(robot.diagnostics.refusals).get(reason, 0)
        except rc10.NotReceived:
            count = 0
        if count >= at_least:
            return int(count)
        assert time.monotonic() < deadline, f"{reason}: {count}"


def test_garbage_stops_no_motor() -> None:
    noise = random.Random(1)
    with robot_under_test() as (_, robot, log):
        stranger = Stranger()
        for length in [0, 1, 7, 8, 9, 64, 200, 1400] * 10:
            stranger.bytes(noise.randbytes(length))
            stranger.bytes(noise.randbytes(length), "faults.v1.request")
        last_ns = drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
        assert log.last_torque_ns("left") >= last_ns - 20 * TICK_NS  # others are served
        log.check()
        proven("160 messages of noise", "none acts; other clients are served", None, None, 0)


def test_old_sequences_and_foreign_sessions() -> None:
    with robot_under_test() as (_, robot, log):
        stranger = Stranger("pilot")
        start_ns = time.time_ns()
        for _ in range(20):
            stranger.command("left", VELOCITY, 60.0)
            time.sleep(0.01)
        last_ns = time.time_ns()
        log.driven(start_ns, last_ns, "left")
        time.sleep(0.1)
        # A recording of it, played again.
        for seq in range(1, 21):
            stranger.command("left", VELOCITY, 60.0, seq=seq)
            time.sleep(0.01)
        assert log.last_torque_ns("left") <= last_ns + WITHIN * TICK_NS
        wait_refusals(robot, "old sequence", 20)
        log.check()
        proven("commands with old sequence numbers", "refused, counted, told", None, None, 0)

        # A second run of the program while the first is still valid.
        other = Stranger("pilot")
        other.session = 78
        start_ns = time.time_ns()
        for _ in range(20):
            stranger.command("left", VELOCITY, 60.0)
            other.command("left", VELOCITY, -60.0)
            time.sleep(0.01)
        log.driven(start_ns, time.time_ns(), "left")
        assert robot.wait_for_state(1.0).motors["left"].target == 60.0
        wait_refusals(robot, "not owner", 20)
        log.check()
        proven(
            "a second session under the client's name",
            "waits for the first to lapse",
            None,
            None,
            0,
        )


def test_too_many_commands() -> None:
    with robot_under_test() as (_, robot, log):
        stranger = Stranger()
        start_ns = time.time_ns()
        for _ in range(300):  # 10,000 a second
            for _ in range(10):
                stranger.command("left", VELOCITY, 60.0)
            time.sleep(0.001)
        log.driven(start_ns, time.time_ns(), "left")
        robot.wait_for_state(1.0)
        time.sleep(0.2)
        log.check(other_bus=FRONT)
        log.check()
        proven("10,000 commands a second", "obeyed or refused; no tick is missed", None, None, 0)


@pytest.mark.parametrize("priority", [0, 5])
def test_two_clients(priority: int) -> None:
    with robot_under_test() as (_, robot, log), client("rival", priority) as rival:
        start_ns = time.time_ns()
        took_ns = 0
        for t_s in robot.rate(100):
            if t_s >= 0.6:
                break
            robot.command(left=rc10.velocity_rpm(60), validity_ms=VALIDITY_MS)
            if t_s >= 0.3:
                if not took_ns:
                    took_ns = time.time_ns()
                rival.command(left=rc10.velocity_rpm(-60), validity_ms=VALIDITY_MS)
        log.driven(start_ns, time.time_ns(), "left")
        motor = robot.wait_for_state(1.0).motors["left"]
        log.check()
        if priority == 0:
            assert (motor.owner, motor.target) == ("test", 60.0)
            proven("two clients of equal priority", "the first keeps the motor", None, None, 0)
        else:
            assert (motor.owner, motor.target) == ("rival", -60.0)
            turned = next(
                f for f in log.frames(FRONT, took_ns) if int.from_bytes(f.data[:2], signed=True) < 0
            )
            proven(
                "a client of higher priority", "it takes the motor over", took_ns, turned.t_ns, 20
            )


def test_one_bad_setpoint_refuses_the_message() -> None:
    with robot_under_test() as (_, robot, log):
        stranger = Stranger()
        for _ in range(10):
            stranger.command("nobody", VELOCITY, 60.0)
            stranger.command("left", 9, 60.0)  # no such mode
            stranger.command("left", 3, 60.0, validity_ms=60_000)  # for a minute
            time.sleep(0.01)
        assert log.last_torque_ns("left") == 0
        log.check()
        wait_refusals(robot, "unknown motor", 10)
        proven("unknown motor, mode or validity", "refused, counted, told", None, None, 0)


def test_a_client_that_speaks_before_it_is_enabled() -> None:
    with drives(), witness() as log, daemon(), client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        with pytest.raises(rc10.CommandRefused, match="left is READY"):
            robot.command(left=rc10.velocity_rpm(60), validity_ms=VALIDITY_MS)
        stranger = Stranger()
        for t_s in robot.rate(100):
            if t_s > 0.3:
                break
            stranger.command("left", VELOCITY, 60.0)
        assert log.last_torque_ns("left") == 0
        log.check()
        proven("commands before enable", "skipped, counted, told", None, None, 0)
