"""Frames in and out without waiting, and on SocketCAN without detours."""

from __future__ import annotations

import errno
import socket
import struct
from typing import Protocol

import can
from can.interfaces.socketcan import SocketcanBus

# The interface is there, but busy or down: what is sent then is lost, as on a cut wire.
_PASSING_ERRORS = {errno.ENOBUFS, errno.EAGAIN, errno.ENETDOWN}

# struct can_frame and struct canfd_frame of linux/can.h.
_FRAME = struct.Struct("=IB3x8s")
_FD_FRAME = struct.Struct("=IBB2x64s")
_BIT_RATE_SWITCH = 0x01
_EXTENDED, _REMOTE, _ERROR = 0x80000000, 0x40000000, 0x20000000


class Port(Protocol):
    """One end of a bus. A bus that is busy or down loses frames; one that is gone raises."""

    def receive(self) -> can.Message | None:
        """Returns the next frame that waits, valid until the next call; None without one."""

    def send(self, message: can.Message) -> bool:
        """Sends a data frame; returns whether the bus took it."""


def open_port(bus: can.BusABC) -> Port:
    """Returns the quickest port to a bus of python-can."""
    return SocketPort(bus.socket) if isinstance(bus, SocketcanBus) else BusPort(bus)


class BusPort:
    """Any bus of python-can."""

    def __init__(self, bus: can.BusABC) -> None:
        self._bus = bus

    def receive(self) -> can.Message | None:
        """Returns the next frame that waits; None without one."""
        try:
            return self._bus.recv(timeout=0)
        except can.CanOperationError as error:
            _pass_over(error)
            return None

    def send(self, message: can.Message) -> bool:
        """Sends a frame; returns whether the bus took it."""
        try:
            self._bus.send(message)
        except can.CanOperationError as error:
            _pass_over(error)
            return False
        return True


class SocketPort:
    """A SocketCAN socket, one system call for each frame.

    python-can makes three or four of them and a new object for each: too much for eight motors
    a thousand times a second on a small computer, and far too much in a User-Mode Linux.
    """

    def __init__(self, raw_socket: socket.socket) -> None:
        self._socket = raw_socket
        self._message = can.Message(data=bytearray(8))

    def receive(self) -> can.Message | None:
        """Returns the next frame that waits, in the same object each time; None without one."""
        try:
            data = self._socket.recv(_FD_FRAME.size, socket.MSG_DONTWAIT)
        except OSError as error:
            _pass_over(can.CanOperationError(f"cannot receive: {error.strerror}", error.errno))
            return None
        message = self._message
        message.is_fd = len(data) == _FD_FRAME.size
        flags = 0
        if message.is_fd:
            can_id, length, flags, payload = _FD_FRAME.unpack(data)
        else:
            can_id, length, payload = _FRAME.unpack(data)
        message.bitrate_switch = bool(flags & _BIT_RATE_SWITCH)
        message.arbitration_id = can_id & 0x1FFFFFFF
        message.is_extended_id = bool(can_id & _EXTENDED)
        message.is_remote_frame = bool(can_id & _REMOTE)
        message.is_error_frame = bool(can_id & _ERROR)
        message.dlc = length
        message.data = payload[:length]
        return message

    def send(self, message: can.Message) -> bool:
        """Sends a frame; returns whether the bus took it."""
        can_id = message.arbitration_id | (_EXTENDED if message.is_extended_id else 0)
        if message.is_fd:
            flags = _BIT_RATE_SWITCH if message.bitrate_switch else 0
            frame = _FD_FRAME.pack(can_id, message.dlc, flags, bytes(message.data))
        else:
            frame = _FRAME.pack(can_id, message.dlc, bytes(message.data))
        try:
            self._socket.send(frame, socket.MSG_DONTWAIT)
        except OSError as error:
            _pass_over(can.CanOperationError(f"cannot send: {error.strerror}", error.errno))
            return False
        return True


def _pass_over(error: can.CanOperationError) -> None:
    # python-can has no number for "Transmit buffer full".
    if error.error_code is not None and error.error_code not in _PASSING_ERRORS:
        raise error
