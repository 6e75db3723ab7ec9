"""Delay of an e-stop to the wire, by the socket that needs no ordinary thread."""

from __future__ import annotations

import socket
import time

from guestlib import Candump
from rig import C6XX_COMMAND, MS, ROBOT, commands, currents, drive, enabled_robot, next_diagnostics

import rc10

# As nobody set RC10_RUN_DIR.
ESTOP = f"/run/rc10d/{ROBOT}.estop"


def test_an_estop_by_datagram_is_on_the_wire_two_ticks_later() -> None:
    with enabled_robot() as (process, robot), Candump("vcan0", ids=(C6XX_COMMAND,)) as bus:
        drive(robot, 0.5, left=rc10.current_a(2))
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as way:
            way.connect(ESTOP)
            robot.command({"left": rc10.current_a(2)}, validity_ms=500)
            sent_ns = time.time_ns()
            way.send(b"pult")
        process.wait_line(r"robot: RUN -> ESTOP \(asked for by 'pult'\)", 10.0)
        bus.stop()
        frames = commands(bus.frames(), C6XX_COMMAND)
        before = [currents(frame)[0] for frame in frames if frame.t_ns <= sent_ns]
        after = [currents(frame) for frame in frames if frame.t_ns > sent_ns + 2 * MS]
        assert before[-1] > 0
        assert after
        assert set(after) == {(0, 0, 0, 0)}


def test_a_flood_of_estops_does_not_hold_up_the_ticks() -> None:
    with enabled_robot() as (_, robot):
        before = next_diagnostics(robot)
        with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as way:
            way.setblocking(False)
            way.connect(ESTOP)
            for t_s in robot.rate(1000):
                if t_s >= 1.0:
                    break
                for _ in range(20):
                    try:
                        way.send(b"flood")
                    except BlockingIOError:
                        break
        assert next_diagnostics(robot).missed_ticks == before.missed_ticks
