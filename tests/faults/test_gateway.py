"""The LCM gateway killed, stopped and flooded; the link socket misused."""
# run-guest: --timeout 900

from __future__ import annotations

import contextlib
import math
import random
import re
import socket
import struct
import time
from pathlib import Path

import pytest
from faultrig import (
    FRONT,
    TICK_NS,
    VALIDITY_MS,
    Stranger,
    ctl,
    datagram,
    drive,
    proven,
    robot_under_test,
)
from guestlib import run
from rig import gateway_pid

import rc10
from rc10.lcm_types import named_value_t, request_t

WITHIN = VALIDITY_MS + 1
SOCKET = "/run/rc10d/faults.sock"


def gateway_memory_kb() -> int:
    status = Path("/proc", str(gateway_pid()), "status").read_text()
    return int(re.findall(r"VmRSS:\s+(\d+) kB", status)[0])


def test_the_gateway_is_killed() -> None:
    with robot_under_test() as (process, robot, log):
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
        run("kill", "-KILL", str(gateway_pid()))
        killed_ns = time.time_ns()
        process.wait_line("rc10-lcm ended .killed by signal 9", 5.0)
        time.sleep(0.1)
        last_ns = log.last_torque_ns("left")
        log.check()
        proven(
            "gateway killed",
            "rest after the validity; it is started again",
            killed_ns,
            last_ns,
            WITHIN,
        )


def test_the_gateway_is_stopped_and_continued() -> None:
    with robot_under_test() as (_, robot, log):
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
        pid = gateway_pid()
        run("kill", "-STOP", str(pid))
        stopped_ns = time.time_ns()
        for t_s in robot.rate(100):  # thirty commands wait in its socket
            if t_s >= 0.3:
                break
            robot.command(left=rc10.velocity_rpm(60), validity_ms=VALIDITY_MS)
        going_ns = time.time_ns()
        run("kill", "-CONT", str(pid))
        time.sleep(0.3)
        torque = [f.t_ns for f in log.frames(FRONT) if any(f.data[:2])]
        last_ns = max(t for t in torque if t < going_ns)
        # The newest of those that waited may still be valid; none from before may act.
        log.driven(going_ns, going_ns, "left")
        log.check()
        proven(
            "gateway stopped, later continued",
            "rest after the validity; what waited is not fresh",
            stopped_ns,
            last_ns,
            WITHIN,
        )


def test_the_gateway_is_flooded() -> None:
    noise = random.Random(2)
    with robot_under_test() as (_, robot, log):
        start_ns = time.time_ns()
        stranger = Stranger()
        memory_kb = gateway_memory_kb()
        for number in range(2000):
            stranger.bytes(b"x" * 20, f"channel{number}")
            datagram(noise.randbytes(number % 300))
            # A fragment of a message that never comes, and one that lies about its size.
            datagram(
                struct.pack(">IIIIHH", 0x4C433033, number, 0xFFFFFFFF, 0, 0, 2)
                + b"faults.v1.command\0"
            )
            if number % 20 == 0:
                robot.command(left=rc10.velocity_rpm(60), validity_ms=200)
                time.sleep(0.002)
        log.driven(start_ns, time.time_ns(), "left", validity_ms=200)
        time.sleep(0.3)
        log.check(other_bus=FRONT)
        log.check()
        assert gateway_memory_kb() < memory_kb + 1024
        proven(
            "2,000 channel names, 4,000 malformed datagrams",
            "no tick is missed, no memory grows",
            None,
            None,
            0,
        )


def test_the_link_socket_is_misused() -> None:
    with robot_under_test() as (_, robot, log):
        strangers = []
        for number in range(100):
            link = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
            link.setblocking(False)
            try:
                link.connect(SOCKET)
                if number % 3 == 0:
                    link.send(b"\1\0")
                elif number % 3 == 1:
                    link.send(struct.pack("=II", 1, 5000) + b"\0" * 100)
            except OSError:
                pass
            strangers.append(link)
        drive(robot, log, 0.3, left=rc10.velocity_rpm(60))
        asked_ns = time.time_ns()
        done = ctl("estop")
        assert done.returncode == 0, done.stderr
        log.check(other_bus=FRONT)
        log.check()
        assert robot.wait_for_state(1.0).estopped
        assert log.last_torque_ns("left") <= asked_ns + WITHIN * TICK_NS
        for link in strangers:
            link.close()
        proven(
            "100 connections that send halves or nothing",
            "dropped; rc10ctl estop gets through",
            None,
            None,
            0,
        )


def test_an_estop_while_driving_rests_all_motors() -> None:
    with robot_under_test() as (_, robot, log):
        start_ns = time.time_ns()
        stop_ns = 0
        for t_s in robot.rate(100):
            if t_s >= 0.5:
                break
            robot.command(
                left=rc10.velocity_rpm(60), right=rc10.velocity_rpm(60), validity_ms=VALIDITY_MS
            )
            if t_s >= 0.3 and not stop_ns:
                stop_ns = time.time_ns()
                robot.estop()
        log.driven(start_ns, stop_ns, "left", "right", validity_ms=10)
        log.check()
        proven("e-stop through LCM", "rest, latched", stop_ns, log.last_torque_ns("left"), 10)


@pytest.mark.parametrize("kept", ["16 idle clients keep every seat", "the gateway is killed"])
def test_an_estop_gets_in(kept: str) -> None:
    """By the datagram socket, whoever is there and whoever is not."""
    with robot_under_test() as (_, robot, log), contextlib.ExitStack() as guests:
        drive(robot, log, 0.2, left=rc10.velocity_rpm(60))
        if kept.startswith("16"):
            for _ in range(16):
                link = guests.enter_context(socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET))
                link.connect(SOCKET)
        start_ns = time.time_ns()
        robot.command(left=rc10.velocity_rpm(60), validity_ms=500)
        time.sleep(0.05)
        if not kept.startswith("16"):
            run("kill", "-KILL", str(gateway_pid()))
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as way:
            way.connect(SOCKET.replace(".sock", ".estop"))
            asked_ns = time.time_ns()
            way.send(b"pult")
        time.sleep(0.1)
        log.driven(start_ns, asked_ns, "left", validity_ms=5)
        log.check()
        proven(f"e-stop while {kept}", "rest, latched", asked_ns, log.last_torque_ns("left"), 2)


def test_an_estop_whose_message_is_nonsense_otherwise() -> None:
    with robot_under_test() as (_, robot, log):
        start_ns = time.time_ns()
        robot.command(left=rc10.velocity_rpm(60), validity_ms=500)
        time.sleep(0.05)
        message = request_t()
        message.session, message.seq, message.client = 77, 1, "x" * 200
        message.operation, message.target = "estop", "nobody" * 100
        message.value_count = 17
        message.values = [value(f"v{i}", math.nan) for i in range(17)]
        asked_ns = time.time_ns()
        Stranger().bytes(message.encode(), "faults.v1.request")
        time.sleep(0.1)
        assert robot.wait_for_state(5.0).estopped
        log.driven(start_ns, asked_ns, "left", validity_ms=10)
        log.check()
        proven(
            "e-stop with a name of 200 bytes, a target of 600 and 17 values",
            "rest, latched",
            asked_ns,
            log.last_torque_ns("left"),
            10,
        )


def value(name: str, number: float) -> named_value_t:
    """One value of a request."""
    named = named_value_t()
    named.name, named.value = name, number
    return named
