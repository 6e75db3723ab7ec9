"""The loop that every client runs, on a CAN interface or on a socket pair in the place of one.

python-can and what is built upon it open `socketcan` as they always do: only the socket is another.
"""

from __future__ import annotations

import argparse
import json
import logging
import math
import os
import resource
import signal
import socket
import sys
import time
from typing import TYPE_CHECKING

from can.interfaces.socketcan import socketcan

if TYPE_CHECKING:
    from collections.abc import Callable

PRIORITY = 60  # of rc10d's scheduler
PERIOD_NS = 1_000_000
SETTLING_S = 0.5


def use_pair(fd: int) -> None:
    """From now on, what opens a SocketCAN interface gets this descriptor."""
    logging.getLogger("can").setLevel(logging.CRITICAL)  # it has no filters of CAN frames
    socketcan.create_socket = lambda: socket.socket(fileno=os.dup(fd))
    socketcan.bind_socket = lambda *_: None


def arguments() -> argparse.Namespace:
    """Reads --fd or --channel, and --seconds; takes the pair, and rc10d's priority."""
    parser = argparse.ArgumentParser()
    wire = parser.add_mutually_exclusive_group(required=True)
    wire.add_argument("--fd", type=int)
    wire.add_argument("--channel", help="a CAN interface")
    parser.add_argument("--seconds", type=float, default=math.inf, help="default: until SIGTERM")
    options = parser.parse_args()
    if options.fd is not None:
        use_pair(options.fd)
        options.channel = "can0"
    # Before a library starts threads: they inherit it.
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
    except PermissionError:
        print("no real-time priority", file=sys.stderr)
    return options


def run(seconds: float, cycle: Callable[[], object]) -> None:
    """Calls `cycle` on an absolute grid of 1 ms until then or SIGTERM; prints what that took."""
    ended: list[int] = []
    signal.signal(signal.SIGTERM, lambda number, _: ended.append(number))
    late_ns: list[int] = []
    missed = 0
    begin_ns = time.monotonic_ns() + round(SETTLING_S * 1e9)
    cpu_s = None
    due_ns = time.monotonic_ns() + PERIOD_NS
    while not ended and due_ns < begin_ns + seconds * 1e9:
        wait_ns = due_ns - time.monotonic_ns()
        if wait_ns > 0:
            time.sleep(wait_ns * 1e-9)
        now_ns = time.monotonic_ns()
        cycle()
        passed = max(1, (time.monotonic_ns() - due_ns) // PERIOD_NS)
        if due_ns >= begin_ns:
            cpu_s = cpu_seconds() if cpu_s is None else cpu_s
            late_ns.append(now_ns - due_ns)
            missed += passed - 1
        due_ns += passed * PERIOD_NS
    measured_s = (due_ns - begin_ns) * 1e-9
    report(late_ns, missed, (cpu_seconds() - (cpu_s or 0.0)) / measured_s)


def report(late_ns: list[int], missed: int, cpu_share: float) -> None:
    """Prints the figures of a block, and ends."""
    late_ns.sort()
    figures = {
        "p50_us": late_ns[len(late_ns) // 2] / 1000,
        "p99_us": late_ns[len(late_ns) * 99 // 100] / 1000,
        "cpu_us": cpu_share * 1000,
        "missed": missed,
    }
    print(json.dumps(figures), flush=True)
    os._exit(0)  # threads of libraries may wait for ever


def cpu_seconds() -> float:
    """CPU time of the process."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime
