"""The stream that VOFA+ receives."""

from __future__ import annotations

import math
import socket
import struct

import pytest

import rc10
from rc10.stream import JUSTFLOAT_TAIL, justfloat
from rc10.stream.udp import UdpTarget


def test_a_frame_is_little_endian_floats_and_a_tail() -> None:
    assert justfloat([1.0, -2.5]) == bytes.fromhex("0000803f 000020c0 0000807f")
    assert struct.pack("<f", math.inf) == JUSTFLOAT_TAIL


def test_no_value_looks_like_the_tail() -> None:
    frame = justfloat([math.inf, -math.inf, math.nan, 1e300])
    assert frame.index(JUSTFLOAT_TAIL) == 16
    largest, smallest, missing, large = struct.unpack("<4f", frame[:16])
    assert largest == -smallest == large == pytest.approx(3.4028235e38)
    assert math.isnan(missing)


def test_datagrams_arrive() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as vofa:
        vofa.bind(("127.0.0.1", 0))
        vofa.settimeout(30)
        with UdpTarget(f"udp://127.0.0.1:{vofa.getsockname()[1]}") as target:
            target.send(justfloat([12.5]))
            assert vofa.recv(100) == justfloat([12.5])


@pytest.mark.parametrize(
    "url", ["127.0.0.1:1347", "udp://127.0.0.1", "tcp://127.0.0.1:1", "udp://a:b", "udp://:7/x"]
)
def test_another_target_is_refused(url: str) -> None:
    with pytest.raises(rc10.Rc10Error, match="write udp://HOST:PORT"):
        UdpTarget(url)


def test_nobody_there_is_no_error() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as once:
        once.bind(("127.0.0.1", 0))
        port = once.getsockname()[1]
    with UdpTarget(f"udp://127.0.0.1:{port}") as target:
        for _ in range(10):
            target.send(b"x")
