"""Fake drives on the other end of a client's socket pair, until SIGTERM."""

from __future__ import annotations

import os
import signal
import sys

import can
from pair import use_pair

from rc10.fakes import Drives
from rc10.fakes.families import family_spec
from rc10.fakes.runner import Runner

PRIORITY = 70  # above every client

fd, *names = sys.argv[1:]
use_pair(int(fd))
specs = [spec for name in names if (spec := family_spec(name)) is not None]
drives = Drives([spec.make(initial_angle_deg=0.0, load_nm=0.0) for spec in specs])
stopped: list[int] = []
signal.signal(signal.SIGTERM, lambda number, _: stopped.append(number))
try:
    os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(PRIORITY))
except PermissionError:
    print("no real-time priority", file=sys.stderr)
bus = can.Bus(interface="socketcan", channel="can0", fd=drives.fd)
print("ready", flush=True)
# Four times in a millisecond: an answer comes within 0.25 ms, as from a drive.
Runner(bus, drives, rate_hz=4000.0).run(lambda: bool(stopped))
