from __future__ import annotations

import os
import select
from typing import TYPE_CHECKING

import pytest

from rc10.fakes.serial_devices import FakeDr16, FakeHipnuc, FakeSbus
from rc10.fakes.serial_port import FakePort

if TYPE_CHECKING:
    from pathlib import Path


def test_dbus_bytes_are_as_computed_by_hand_from_the_makers_table() -> None:
    dr16 = FakeDr16(lambda _: None)
    # 1024 in every channel, both switches down, nothing pressed.
    assert dr16.frame().hex() == "0004200001a8" + "00" * 10 + "0004"
    dr16.right_x, dr16.right_y, dr16.left_x, dr16.left_y = 1.0, -1.0, 0.5, 0.0
    dr16.right_switch, dr16.left_switch = 1, 0
    dr16.keys = 0x8001
    # 1684, 364, 1354 and 1024 in 11 bits each from the lowest, then 1 and 3 in two bits each.
    bits = 1684 | 364 << 11 | 1354 << 22 | 1024 << 33 | 1 << 44 | 3 << 46
    assert dr16.frame()[:6] == bits.to_bytes(6, "little")
    assert dr16.frame()[14:16] == b"\x01\x80"
    assert len(dr16.frame()) == 18


def test_sbus_flags_are_in_the_last_but_one_byte() -> None:
    sbus = FakeSbus(lambda _: None)
    sbus.digital = [True, False]
    sbus.failsafe = True
    frame = sbus.frame()
    assert (len(frame), frame[0], frame[23], frame[24]) == (25, 0x0F, 0b1001, 0x00)
    assert int.from_bytes(frame[1:23], "little") & 0x7FF == 992


def test_a_hipnuc_frame_has_its_angles_where_the_manual_says() -> None:
    sensor = FakeHipnuc(lambda _: None)
    sensor.yaw_deg = 90.0
    frame = sensor.frame()
    assert frame[:4].hex() == "5aa54c00"
    assert (len(frame), frame[6]) == (82, 0x91)
    # Roll, pitch and yaw from byte 48 of the packet; 90 is 0x42B40000 as a float.
    assert frame[6 + 56 : 6 + 60].hex() == "0000b442"


def test_a_device_sends_at_its_period_while_it_is_on() -> None:
    sent: list[bytes] = []
    dr16 = FakeDr16(sent.append)
    for _ in range(141):
        dr16.step(0.001)
    assert len(sent) == 11  # the first at once
    dr16.on = False
    for _ in range(100):
        dr16.step(0.001)
    assert len(sent) == 11


def test_a_port_is_there_while_it_is_plugged_and_hangs_up_when_it_is_pulled(
    tmp_path: Path,
) -> None:
    path = tmp_path / "device"
    with FakePort(path) as port:
        host = os.open(path, os.O_RDWR | os.O_NOCTTY)
        port.send(b"\x00\x0d\x11\xff")
        assert os.read(host, 10) == b"\x00\x0d\x11\xff"
        port.unplug()
        assert not path.exists()
        poll = select.poll()
        poll.register(host)
        assert poll.poll(1000)[0][1] & select.POLLHUP
        os.close(host)
        port.send(b"lost")
        port.plug()
        host = os.open(path, os.O_RDWR | os.O_NOCTTY)
        port.send(b"again")
        assert os.read(host, 10) == b"again"
        os.close(host)


def test_a_port_that_nobody_reads_loses_bytes_instead_of_waiting(tmp_path: Path) -> None:
    path = tmp_path / "device"
    with FakePort(path) as port:
        host = os.open(path, os.O_RDWR | os.O_NOCTTY)
        for _ in range(200):
            port.send(bytes(1000))
        received = b""
        while b"again" not in received:
            port.send(b"again")
            received += os.read(host, 4096)
        assert 1000 <= received.index(b"again") < 200_000
        os.close(host)


@pytest.mark.parametrize("stick", [-2.0, 2.0])
def test_a_stick_goes_no_farther_than_its_end(stick: float) -> None:
    dr16 = FakeDr16(lambda _: None)
    dr16.right_x = stick
    assert int.from_bytes(dr16.frame()[:2], "little") & 0x7FF == (1684 if stick > 0 else 364)
