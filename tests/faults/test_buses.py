"""Frames lost, late, doubled; buses flooded, off, down, gone, full and slow."""
# run-guest: --timeout 900

from __future__ import annotations

import itertools
import threading
import time

import pytest
from faultrig import (
    FRONT,
    REAR,
    TICK_NS,
    client,
    daemon,
    drive,
    drives,
    proven,
    robot_under_test,
    witness,
)
from guestlib import (
    can_frame,
    can_socket,
    link_add,
    link_delete,
    link_down,
    link_up,
    netem,
    netem_clear,
    run,
)
from rig import currents, wait_status

import rc10


@pytest.mark.parametrize(
    ("rules", "words"),
    [
        ("loss 5%", "5 % of all frames lost"),
        ("duplicate 20%", "20 % of all frames doubled"),
        ("delay 4ms", "every frame 4 ms late"),
    ],
)
def test_a_bad_bus_keeps_its_motors_going(rules: str, words: str) -> None:
    # A first qdisc stops the interface for milliseconds, which is another fault: a stalled bus.
    netem(FRONT, "limit 1000")
    with robot_under_test() as (_, robot, log):
        netem(FRONT, rules)
        drive(robot, log, 1.5, right=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
        state = robot.wait_for_state(1.0)
        assert state.motors["right"].status is rc10.MotorStatus.ACTIVE
        assert abs(state.motors["right"].velocity_rpm - 60) < 20
        netem_clear(FRONT)
        time.sleep(0.1)
        log.check()
        proven(words, "the motors go on; the other bus misses no tick", None, None, 0)


def test_a_node_floods_the_bus() -> None:
    with robot_under_test() as (_, robot, log):
        stop = threading.Event()

        def flood() -> None:
            with can_socket(FRONT) as node:
                while not stop.is_set():
                    for number in range(8):  # 8,000 frames a second: more than 1 Mbit/s carries
                        node.send(can_frame(0x100 + number, b"\xff" * 8))
                    time.sleep(0.001)

        thread = threading.Thread(target=flood)
        thread.start()
        try:
            drive(robot, log, 1.0, right=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
            state = robot.wait_for_state(1.0)
        finally:
            stop.set()
            thread.join()
        assert abs(state.motors["right"].velocity_rpm - 60) < 3
        log.check()
        proven(
            "8,000 unknown frames a second", "unmatched, counted; the motors go on", None, None, 0
        )


@pytest.mark.parametrize(
    ("frame", "state"),
    [
        ("20000004#0008000000000000", "error-warning"),
        ("20000204#0020000000008800", "error-passive"),
        ("20000040#0000000000000000", "bus-off"),
    ],
)
def test_an_error_frame_sets_the_state_of_its_bus_alone(frame: str, state: str) -> None:
    with robot_under_test() as (process, robot, log):
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
        run("cansend", FRONT, frame)
        process.wait_line(f"bus {state}", 5.0)
        drive(robot, log, 0.3, other=rc10.velocity_rpm(60))
        run("cansend", FRONT, "20000100#0000000000000000")  # restarted
        run("cansend", FRONT, "20000204#0040000000000000")  # error-active again
        process.wait_line("bus active", 5.0)
        log.check()
        proven(
            f"error frame: {state}",
            "a state and an event; the other bus misses no tick",
            None,
            None,
            0,
        )


def test_the_interface_goes_down_and_comes_back() -> None:
    with robot_under_test() as (process, robot, log):
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
        link_down(FRONT)
        down_ns = time.time_ns()
        process.wait_line("bus interface down", 5.0)
        drive(robot, log, 0.3, other=rc10.velocity_rpm(60))
        link_up(FRONT)
        wait_status(robot, rc10.MotorStatus.READY, "left")
        up_ns = time.time_ns()
        drive(robot, log, 0.2, other=rc10.velocity_rpm(60))
        assert all(not any(currents(f)[:2]) for f in log.frames(FRONT, up_ns))
        log.check()
        proven(
            "interface down and up",
            "OFFLINE; back at rest, not enabled",
            down_ns,
            max(down_ns, log.last_torque_ns("left")),
            1,
        )


def test_the_interface_is_deleted_and_made_again() -> None:
    # The witness listens to an interface that is gone: only the other bus can be read to the end.
    with drives(), daemon() as process, client() as robot, witness() as log:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable(["other"])
        drive(robot, log, 0.3, other=rc10.velocity_rpm(60))
        link_delete(FRONT)
        process.wait_line("bus interface gone", 5.0)
        drive(robot, log, 0.3, other=rc10.velocity_rpm(60))
        link_add(FRONT)
        with can_socket(FRONT) as bus:
            commands = [f for f in (bus.recv(16) for _ in range(50)) if f[:2] == b"\0\2"]
            assert commands
            assert all(f[8:] == bytes(8) for f in commands)
        drive(robot, log, 0.3, other=rc10.velocity_rpm(60))
        times = [f.t_ns for f in log.frames(REAR)]
        assert all(abs(b - a - TICK_NS) <= 2000 for a, b in itertools.pairwise(times))
        proven(
            "interface deleted and made again",
            "used again, at rest; the other bus misses no tick",
            None,
            None,
            0,
        )


# Four frames a millisecond of 128 us each: three of feedback, one command.
@pytest.mark.parametrize(("load", "kbit"), [(80, 640), (100, 512), (130, 394)])
def test_a_bus_of_real_bandwidth(load: int, kbit: int) -> None:
    with robot_under_test() as (_, robot, log):
        netem(FRONT, f"rate {kbit}kbit limit 12")
        last_ns = drive(robot, log, 1.0, right=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
        time.sleep(0.2)
        netem_clear(FRONT)
        time.sleep(0.1)
        # At most twelve frames wait: 12 * 128 us * 1000 / kbit, some 4 ms.
        log.driven(last_ns, last_ns + 6 * TICK_NS, "right")
        log.check()
        proven(
            f"a bus of {kbit} kbit/s: {load} % load",
            "what does not fit is dropped, never late by more than the queue",
            None,
            None,
            0,
        )


def test_the_transmit_queue_stalls() -> None:
    with robot_under_test() as (process, robot, log):
        drive(robot, log, 0.3, right=rc10.velocity_rpm(60), other=rc10.velocity_rpm(60))
        netem(FRONT, "rate 8bit limit 4")  # a frame takes longer than the test
        stalled_ns = time.time_ns()
        process.wait_line("bus (stalled|silent)", 5.0)
        drive(robot, log, 0.3, other=rc10.velocity_rpm(60))
        netem_clear(FRONT)
        time.sleep(0.3)
        log.check()
        proven(
            "transmit queue stalls",
            "stalled; OFFLINE; at rest when it moves again",
            stalled_ns,
            max(stalled_ns, log.last_torque_ns("right")),
            10,
        )


def test_enobufs_again_and_again() -> None:
    with robot_under_test() as (_, robot, log):
        # Room for one frame, which is sent in 2 ms: every second command frame or so is refused.
        netem(FRONT, "delay 2ms limit 1")
        drive(robot, log, 0.5, other=rc10.velocity_rpm(60))
        netem_clear(FRONT)
        time.sleep(0.2)
        log.check()
        proven(
            "the kernel takes only some frames",
            "refused ones are dropped and counted; the other bus misses no tick",
            None,
            None,
            0,
        )
