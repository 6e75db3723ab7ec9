"""The quick way to a SocketCAN socket, on a pair of sockets that carry the same structs."""

from __future__ import annotations

import errno
import socket
from collections.abc import Iterator

import can
import pytest
from can.interfaces.socketcan.socketcan import build_can_frame, dissect_can_frame

from rc10.fakes import Drives, FakeMotor, MotorSpec
from rc10.fakes.port import SocketPort


@pytest.fixture
def ends() -> Iterator[tuple[SocketPort, socket.socket]]:
    near, far = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with near, far:
        yield SocketPort(near), far


@pytest.mark.parametrize(
    "message",
    [
        can.Message(arbitration_id=0x200, is_extended_id=False, data=bytes(range(8))),
        can.Message(arbitration_id=0x200, is_extended_id=True, data=b"\1\2"),
        can.Message(arbitration_id=0x1FFFFFFF, is_extended_id=True),
        can.Message(arbitration_id=0x200, is_extended_id=False, is_remote_frame=True, dlc=8),
        can.Message(arbitration_id=0x004, is_extended_id=False, is_error_frame=True, data=bytes(8)),
    ],
)
def test_it_reads_what_python_can_writes(
    ends: tuple[SocketPort, socket.socket], message: can.Message
) -> None:
    port, host = ends
    host.send(build_can_frame(message))
    received = port.receive()
    assert received is not None
    if message.is_remote_frame:
        received.data = bytearray()
    assert received.equals(message, timestamp_delta=None, check_channel=False)
    assert port.receive() is None


def test_a_frame_leaves_nothing_to_the_next(ends: tuple[SocketPort, socket.socket]) -> None:
    port, host = ends
    fakes = Drives([FakeMotor(MotorSpec.parse("M3508:1"))])
    for data in (bytes([0x20, 0, 0, 0, 0, 0, 0, 0]), bytes([0x10, 0])):
        message = can.Message(arbitration_id=0x200, is_extended_id=False, data=data)
        host.send(build_can_frame(message))
        received = port.receive()
        assert received is not None
        assert bytes(received.data) == data
        fakes.receive(received)
    assert fakes.motors[0].command == 10.0, "the short frame is no command"


def test_python_can_reads_what_it_writes(ends: tuple[SocketPort, socket.socket]) -> None:
    port, host = ends
    fake = FakeMotor(MotorSpec.parse("GM6020:7"), initial_angle_deg=90.0)
    assert port.send(fake.feedback())
    can_id, length, _, data = dissect_can_frame(host.recv(100))
    assert (can_id, length, data) == (0x20B, 8, bytes(fake.feedback().data))


def test_a_full_queue_costs_the_frame(ends: tuple[SocketPort, socket.socket]) -> None:
    port, _ = ends
    message = FakeMotor(MotorSpec.parse("M3508:1")).feedback()
    while port.send(message):
        pass
    assert not port.send(message)


def test_a_socket_that_is_gone_raises(ends: tuple[SocketPort, socket.socket]) -> None:
    port, host = ends
    host.close()
    with pytest.raises(can.CanOperationError, match="cannot send") as caught:
        port.send(FakeMotor(MotorSpec.parse("M3508:1")).feedback())
    assert caught.value.error_code == errno.EPIPE
