"""CAN links: up, down, away, with a limited rate; and plain sockets on them."""

from __future__ import annotations

import socket
import struct
from pathlib import Path

from guestlib.process import run

_CAN_FRAME = struct.Struct("=IB3x8s")

# linux/can/raw.h; Python leaves it out.
CAN_RAW_ERR_FILTER = 2

# The size of struct canfd_frame.
FD_MTU = 72


def link_add(iface: str) -> None:
    run("ip", "link", "add", iface, "type", "vcan")
    run("ip", "link", "set", iface, "mtu", str(FD_MTU), "up")


def link_delete(iface: str) -> None:
    run("ip", "link", "del", iface)


def link_up(iface: str) -> None:
    run("ip", "link", "set", iface, "up")


def link_down(iface: str) -> None:
    run("ip", "link", "set", iface, "down")


def netem(iface: str, rules: str) -> None:
    """Give a virtual bus a rate, delay or loss: netem("vcan0", "rate 1mbit limit 12").

    netem counts 16 bytes for a classic frame: at 1 Mbit/s one takes 128 us, as on a wire.
    """
    run("tc", "qdisc", "replace", "dev", iface, "root", "netem", *rules.split())


def netem_clear(iface: str) -> None:
    if "netem" in run("tc", "qdisc", "show", "dev", iface):
        run("tc", "qdisc", "del", "dev", iface, "root")


def reset_buses(*ifaces: str) -> None:
    """Make virtual buses as the guest started with them, whatever a test did."""
    commands = []
    for iface in ifaces:
        if Path("/sys/class/net", iface).exists():
            commands.append(f"link del {iface}")
        commands += [f"link add {iface} type vcan", f"link set {iface} mtu {FD_MTU} up"]
    # One process: starting one is what takes real time in User-Mode Linux.
    batch = Path("/tmp/reset-buses")
    batch.write_text("\n".join(commands) + "\n")
    run("ip", "-batch", batch)


def can_socket(iface: str, *, fd: bool = False, errors: bool = False) -> socket.socket:
    """A CAN_RAW socket that gives up after a second."""
    can = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
    if fd:
        can.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FD_FRAMES, 1)
    if errors:
        can.setsockopt(socket.SOL_CAN_RAW, CAN_RAW_ERR_FILTER, socket.CAN_ERR_MASK)
    can.bind((iface,))
    can.settimeout(1.0)
    return can


def can_frame(number: int, data: bytes) -> bytes:
    """A struct can_frame; an extended id carries CAN_EFF_FLAG."""
    return _CAN_FRAME.pack(number, len(data), data)
