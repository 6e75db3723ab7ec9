"""Datagrams of other computers, kept away from liblcm's sockets by filters in the kernel.

LCM has no passwords, and whatever the ttl, another computer reaches what receives: liblcm 1.3 by
unicast, all by the group where its route leaves the computer.

With ttl 0 what was sent on this computer comes in. With ttl ≥ 1 the network is meant: what comes
to the group by the interface of its route; but of a robot that was heard on this computer, nothing
that another computer says.
"""

from __future__ import annotations

import ctypes
import os
import re
import socket
import struct

Program = list[tuple[int, int, int, int]]

_SO_ATTACH_FILTER = 26
_IP_MULTICAST_ALL = 49
_PACKET_LOOPBACK = 5
_DESCRIPTORS = "/proc/self/fd"
_GROUP = ("239.255.76.67", 7667)

# Instructions of classic BPF, and what of a datagram they see: from the UDP header on.
_LOAD = {4: 0x20, 2: 0x28, 1: 0x30}
_IF_EQUAL, _IF_NOT_LESS, _RETURN = 0x15, 0x35, 0x06
_INTERFACE, _PACKET_TYPE, _IP_TO = 0xFFFFF000 + 8, 0xFFFFF000 + 4, 0xFFF00000 + 16
_ACCEPT, _DROP = (_RETURN, 0, 0, 0xFFFFFFFF), (_RETURN, 0, 0, 0)
# LCM's header has 8 bytes; 20 of a message in fragments, the first of which has the channel.
_MAGIC, _CHANNEL, _FRAGMENT_NUMBER, _CHANNEL_OF_FRAGMENTS = 8, 16, 24, 28
_FRAGMENTS = int.from_bytes(b"LC03", "big")


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


class OwnDatagrams:
    """Filters of the UDP sockets among these new descriptors.

    Args:
        url: that of LCM.
        new: descriptors of which some are liblcm's.
    """

    def __init__(self, url: str, new: set[int]) -> None:
        self._url = url
        self._here: list[bytes] = []
        self._witnesses: dict[str, socket.socket] = {}
        self._sockets: list[int] = []
        if url and not url.startswith("udpm://"):
            return
        for descriptor in new:
            try:
                udp = socket.socket(fileno=os.dup(descriptor))
            except OSError:
                continue  # no socket, or closed meanwhile
            with udp:
                if (udp.family, udp.type) == (socket.AF_INET, socket.SOCK_DGRAM):
                    # Not what other programs have joined at other interfaces.
                    udp.setsockopt(socket.IPPROTO_IP, _IP_MULTICAST_ALL, 0)
                    self._sockets.append(descriptor)
        self._filter()

    def watch(self, robot: str) -> None:
        """Looks out for this robot on this computer, unless all is of this computer anyway."""
        if not self._sockets or stays_on_this_computer(self._url) or robot in self._witnesses:
            return
        place = re.match(r"udpm://([\d.]*):?(\d*)", self._url)
        group = (place and place[1]) or _GROUP[0]
        port = int((place and place[2]) or _GROUP[1])
        witness = socket.socket(socket.AF_INET, socket.SOCK_DGRAM | socket.SOCK_NONBLOCK)
        state = _if_bytes(f"{robot}.v1.state\0".encode(), _CHANNEL, _ACCEPT)
        _attach(witness, [*_if_own(state), _DROP])
        try:
            witness.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            witness.bind((group, port))
            membership = socket.inet_aton(group) + socket.inet_aton("0.0.0.0")
            witness.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        except OSError:
            witness.close()
            return
        self._witnesses[robot] = witness

    def look(self) -> None:
        """From here on nobody else speaks for robots that were heard on this computer."""
        for robot, witness in self._witnesses.items():
            try:
                heard = witness.fileno() >= 0 and witness.recv(1) != b""
            except OSError:
                continue  # nothing yet
            if heard:
                witness.close()
                self._here.append(f"{robot}.v1.".encode())
                self._filter()

    def close(self) -> None:
        """Frees its sockets."""
        for witness in self._witnesses.values():
            witness.close()
        self._sockets.clear()
        self._witnesses.clear()

    def _filter(self) -> None:
        program = _if_own([_ACCEPT])
        if stays_on_this_computer(self._url):
            program.append(_DROP)
        else:
            # To a group: the first byte of the address is 224 or more.
            program += [(_LOAD[1], 0, 0, _IP_TO), (_IF_NOT_LESS, 1, 0, 224), _DROP]
            for beginning in self._here:
                fragments = _if_bytes(beginning, _CHANNEL_OF_FRAGMENTS, _DROP)
                program += [
                    (_LOAD[4], 0, 0, _MAGIC),
                    (_IF_EQUAL, 0, len(fragments) + 2, _FRAGMENTS),
                    (_LOAD[2], 0, 0, _FRAGMENT_NUMBER),
                    (_IF_EQUAL, 0, len(fragments), 0),
                    *fragments,
                    *_if_bytes(beginning, _CHANNEL, _DROP),
                ]
            program.append(_ACCEPT)
        for descriptor in self._sockets:
            with socket.socket(fileno=os.dup(descriptor)) as udp:
                _attach(udp, program)


def _if_own(then: Program) -> Program:
    # By the loopback interface; or by another one, as a copy of a multicast that left by it.
    return [
        (_LOAD[4], 0, 0, _INTERFACE),
        (_IF_EQUAL, 2, 0, socket.if_nametoindex("lo")),
        (_LOAD[4], 0, 0, _PACKET_TYPE),
        (_IF_EQUAL, 0, len(then), _PACKET_LOOPBACK),
        *then,
    ]


def _if_bytes(wanted: bytes, offset: int, match: tuple[int, int, int, int]) -> Program:
    # In order: a load beyond the end of a datagram drops it.
    loads = []
    at = 0
    while at < len(wanted):
        size = 4 if len(wanted) - at >= 4 else 1
        loads.append((_LOAD[size], offset + at, int.from_bytes(wanted[at : at + size], "big")))
        at += size
    program: Program = []
    for i, (load, place, value) in enumerate(loads):
        program.append((load, 0, 0, place))
        program.append((_IF_EQUAL, 0, 2 * (len(loads) - 1 - i) + 1, value))
    return [*program, match]


def _attach(udp: socket.socket, program: Program) -> None:
    code = ctypes.create_string_buffer(b"".join(struct.pack("=HBBI", *step) for step in program))
    udp.setsockopt(
        socket.SOL_SOCKET,
        _SO_ATTACH_FILTER,
        struct.pack("@HP", len(program), ctypes.addressof(code)),
    )
