"""Forged messages of another computer change nothing of a robot that is here."""

from __future__ import annotations

import subprocess
import sys

import pytest

from rc10.link import LcmLink
from rc10.own_datagrams import stays_on_this_computer

CHANNEL = "demo.v1.state"
GROUP = "239.255.76.67"
# Both ends have one address of hardware, so that no datagram waits for ARP.
ADDRESS = "02:00:00:00:00:01"
FORGE = f"""
import socket, struct
udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
udp.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("10.9.0.2"))
for number in range(20):
    text = b"{CHANNEL}\\0" + b"forged"
    whole = b"LC02" + struct.pack(">I", number) + text
    fragment = b"LC03" + struct.pack(">IIIHH", number, 6, 0, 0, 1) + text
    for message in (whole, fragment):
        udp.sendto(message, ("10.9.0.1", 7667))
        udp.sendto(message, ("{GROUP}", 7667))
"""


def wire(end: str, number: int) -> str:
    return f"ip addr add 10.9.0.{number}/24 dev {end} && ip link set {end} arp off up"


class OtherComputer:
    """At the other end of a wire to the interface `near`."""

    def __init__(self) -> None:
        steps = f"echo; read go; {wire('far', 2)}; echo; read go"
        # With its end the wire would be gone.
        attack = f"{sys.executable} -c '{FORGE}'; echo; read go"
        begin = f"{steps}; {attack}; {attack}"
        self._shell = subprocess.Popen(
            ["unshare", "--net", "sh", "-ec", begin],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self._hear()
        ends = f"near address {ADDRESS} type veth peer name far address {ADDRESS}"
        run(f"ip link add {ends} netns {self._shell.pid}")
        run(wire("near", 1))
        self._go()
        self._hear()

    def attack(self) -> None:
        """Sends twenty messages to the computer, and to the group; returns when all have left."""
        self._go()
        self._hear()

    def close(self) -> None:
        self._shell.kill()
        self._shell.communicate()

    def _go(self) -> None:
        assert self._shell.stdin is not None
        self._shell.stdin.write("go\n")
        self._shell.stdin.flush()

    def _hear(self) -> None:
        assert self._shell.stdout is not None
        assert self._shell.stdout.readline() == "\n"


def run(command: str) -> None:
    subprocess.run(command, shell=True, check=True)


@pytest.mark.netns(route=False)
@pytest.mark.parametrize(
    ("way", "url", "before"),
    [
        ("lo src 127.0.0.1", None, {b"own"}),
        # Its own multicast leaves by the wire then, and comes back as a copy.
        ("near", None, {b"own"}),
        ("near", f"udpm://{GROUP}:7667?ttl=0", {b"own"}),
        # The robot may be elsewhere, until it is heard here.
        ("near", f"udpm://{GROUP}:7667?ttl=1", {b"own", b"forged"}),
        ("lo src 127.0.0.1", f"udpm://{GROUP}:7667?ttl=1", {b"own"}),
    ],
)
def test_a_forged_message_of_another_computer_changes_nothing(
    way: str, url: str | None, before: set[bytes]
) -> None:
    other = OtherComputer()  # no fixture: that would be outside of the namespace
    run(f"ip route add {GROUP}/32 dev {way}")
    received: list[bytes] = []
    link = LcmLink(url)
    link.subscribe(CHANNEL, received.append, 100)
    for word, heard in ((b"own", before), (b"last", {b"last"})):
        received.clear()
        other.attack()
        link.publish(CHANNEL, word)
        while word not in received:
            assert link.pump(20.0) > 0
        assert set(received) == heard
    link.close()
    other.close()


@pytest.mark.parametrize(
    ("url", "stays"),
    [
        ("", True),
        ("udpm://", True),
        ("udpm://239.255.76.67:7667?recv_buf_size=9&ttl=0", True),
        ("udpm://239.255.76.67:7667?ttl=1", False),
        ("memq://", False),
    ],
)
def test_ttl_0_is_this_computer(url: str, stays: bool) -> None:
    assert stays_on_this_computer(url) is stays
