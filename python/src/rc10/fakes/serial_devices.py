"""Fake devices on serial ports: receivers of remote controls and an inertial sensor.

Written from the makers' descriptions alone, as the fake motors are.
"""

from __future__ import annotations

import binascii
import struct
from typing import Callable

Send = Callable[[bytes], object]

DR16_PERIOD_S = 0.014
_DR16_CENTRE, _DR16_FULL = 1024, 660
_DR16_SWITCH = {1: 1, -1: 2, 0: 3}  # up, down, middle
_DR16_REST = struct.Struct("<hhhBBHH")

SBUS_PERIOD_S = 0.007
_SBUS_CENTRE, _SBUS_FULL = 992, 820

_HI_HEADER = struct.Struct("<BBHH")
_HI_PACKET_91 = struct.Struct("<BHBfI3f3f3f3f4f")
_STANDARD_GRAVITY_M_S2 = 9.80665


class _Sender:
    """Sends a frame at its period, as time is let pass."""

    def __init__(self, send: Send, period_s: float) -> None:
        self.on = True
        self.frames = 0
        self._send = send
        self._period_s = period_s
        self._left_s = 0.0

    def frame(self) -> bytes:
        """Its present bytes."""
        raise NotImplementedError

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass; sends a frame when it is time for one."""
        self._left_s -= dt_s
        if self._left_s > 1e-9:
            return
        self._left_s += self._period_s
        if self.on:
            self.frames += 1
            self._send(self.frame())


class FakeDr16(_Sender):
    """DJI's DR16 receiver, and the driver's remote: 18 bytes of DBUS every 14 ms.

    Public attributes may be set at any time:
        right_x, right_y, left_x, left_y, wheel: -1 to 1, right and up positive.
        right_switch, left_switch: -1 down, 0, 1 up.
        keys: bits; bit 0 is W.
        on: whether the remote is on. When it is not, the receiver is silent.

    Args:
        send: takes the bytes, FakePort.send.
    """

    def __init__(self, send: Send) -> None:
        super().__init__(send, DR16_PERIOD_S)
        self.right_x = self.right_y = self.left_x = self.left_y = self.wheel = 0.0
        self.right_switch = self.left_switch = -1
        self.keys = 0

    def frame(self) -> bytes:
        """Returns the 18 bytes: four channels of 11 bits, two switches of 2, mouse, keys, wheel."""
        bits = 0
        for place, stick in enumerate((self.right_x, self.right_y, self.left_x, self.left_y)):
            bits |= _channel(stick) << 11 * place
        bits |= _DR16_SWITCH[self.right_switch] << 44 | _DR16_SWITCH[self.left_switch] << 46
        rest = _DR16_REST.pack(0, 0, 0, 0, 0, self.keys, _channel(self.wheel))
        return bits.to_bytes(6, "little") + rest


def _channel(stick: float) -> int:
    return _DR16_CENTRE + round(max(-1.0, min(1.0, stick)) * _DR16_FULL)


class FakeSbus(_Sender):
    """A SBUS receiver: 25 bytes, every 7 ms.

    Public attributes may be set at any time:
        channels: 16 of them, -1 to 1.
        digital: channels 17 and 18.
        frame_lost, failsafe: what the receiver says of its remote.
        on: whether the receiver has power.

    Args:
        send: takes the bytes, FakePort.send.
    """

    def __init__(self, send: Send) -> None:
        super().__init__(send, SBUS_PERIOD_S)
        self.channels = [0.0] * 16
        self.digital = [False, False]
        self.frame_lost = self.failsafe = False

    def frame(self) -> bytes:
        """Returns the 25 bytes: 16 channels of 11 bits and the flags."""
        bits = 0
        for place, value in enumerate(self.channels):
            bits |= round(_SBUS_CENTRE + max(-1.0, min(1.0, value)) * _SBUS_FULL) << 11 * place
        flags = (*self.digital, self.frame_lost, self.failsafe)
        last = sum(1 << place for place, flag in enumerate(flags) if flag)
        return bytes([0x0F, *bits.to_bytes(22, "little"), last, 0x00])


class FakeHipnuc(_Sender):
    """A HiPNUC sensor (HI226, HI229, CH0x0) that sends packet 0x91.

    Public attributes may be set at any time:
        roll_deg, pitch_deg, yaw_deg: from -180 to 180.
        rates_deg_s: about x, y and z.
        acceleration_m_s2: along them.
        on: whether it has power.

    Args:
        send: takes the bytes, FakePort.send.
        rate_hz: 100 as it leaves the factory.
    """

    def __init__(self, send: Send, rate_hz: float = 100.0) -> None:
        super().__init__(send, 1.0 / rate_hz)
        self.roll_deg = self.pitch_deg = self.yaw_deg = 0.0
        self.rates_deg_s = (0.0, 0.0, 0.0)
        self.acceleration_m_s2 = (0.0, 0.0, _STANDARD_GRAVITY_M_S2)

    def frame(self) -> bytes:
        """Returns header, length, checksum and the 76 bytes of packet 0x91."""
        payload = _HI_PACKET_91.pack(
            0x91,
            0,  # reserved
            25,  # deg C
            101_325.0,  # Pa
            self.frames * 10,  # ms
            *(value / _STANDARD_GRAVITY_M_S2 for value in self.acceleration_m_s2),
            *self.rates_deg_s,
            *(0.0, 0.0, 0.0),  # magnetic field
            *(self.roll_deg, self.pitch_deg, self.yaw_deg),
            *(1.0, 0.0, 0.0, 0.0),  # the quaternion, which nobody here reads
        )
        head = struct.pack("<BBH", 0x5A, 0xA5, len(payload))
        # The checksum leaves itself out.
        checksum = binascii.crc_hqx(payload, binascii.crc_hqx(head, 0))
        return _HI_HEADER.pack(0x5A, 0xA5, len(payload), checksum) + payload
