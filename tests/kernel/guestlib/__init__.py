"""Helpers of tests inside a guest: processes, recorded buses, links and pins.

In the User-Mode Linux guest the clock moves only while every process sleeps, so a wait that
polls costs nothing and a time-out counts virtual seconds. The same helpers work in the QEMU guest,
where time is real and slow.
"""

from guestlib.candump import Candump, Frame
from guestlib.links import (
    can_frame,
    can_socket,
    link_add,
    link_delete,
    link_down,
    link_up,
    netem,
    netem_clear,
    reset_buses,
)
from guestlib.pins import Pin
from guestlib.process import Proc, run, wait_for

__all__ = [
    "Candump",
    "Frame",
    "Pin",
    "Proc",
    "can_frame",
    "can_socket",
    "link_add",
    "link_delete",
    "link_down",
    "link_up",
    "netem",
    "netem_clear",
    "reset_buses",
    "run",
    "wait_for",
]
