"""Datagrams of this computer, and no others, for sockets that liblcm opens.

Whatever the ttl, another computer reaches what receives: liblcm 1.3 by unicast, all by the group
where its route leaves the computer.
"""

from __future__ import annotations

import ctypes
import os
import re
import socket
import struct

_SO_ATTACH_FILTER = 26
_PACKET_LOOPBACK = 5
_DESCRIPTORS = "/proc/self/fd"


def stays_on_this_computer(url: str) -> bool:
    """Whether LCM stays here with this URL: udpm with ttl 0, which is LCM's default."""
    ttl = re.search(r"ttl=(\d+)", url)
    return (url.startswith("udpm://") and (ttl is None or int(ttl[1]) == 0)) or not url


def descriptors() -> set[int]:
    """Open descriptors; where there is no /proc, none: then nothing is kept out."""
    try:
        return {int(name) for name in os.listdir(_DESCRIPTORS)}
    except OSError:
        return set()


def keep_others_out(new: set[int]) -> None:
    """Lets those of these descriptors that are UDP sockets hear this computer alone."""
    for descriptor in new:
        try:
            udp = socket.socket(fileno=os.dup(descriptor))
        except OSError:
            continue  # no socket, or closed meanwhile
        with udp:
            if (udp.family, udp.type) == (socket.AF_INET, socket.SOCK_DGRAM):
                _hear_this_computer_only(udp)


def _hear_this_computer_only(udp: socket.socket) -> None:
    # By the loopback interface; or by another one, as a copy of a multicast that left by it.
    interface_index, packet_type = 0xFFFFF000 + 8, 0xFFFFF000 + 4
    program = [
        (0x20, 0, 0, interface_index),
        (0x15, 2, 0, socket.if_nametoindex("lo")),
        (0x20, 0, 0, packet_type),
        (0x15, 0, 1, _PACKET_LOOPBACK),
        (0x06, 0, 0, 0xFFFFFFFF),
        (0x06, 0, 0, 0),
    ]
    code = ctypes.create_string_buffer(b"".join(struct.pack("=HBBI", *step) for step in program))
    udp.setsockopt(
        socket.SOL_SOCKET,
        _SO_ATTACH_FILTER,
        struct.pack("@HP", len(program), ctypes.addressof(code)),
    )
