"""The test guest itself: real SocketCAN, virtual buses with a rate, exact virtual time."""

from __future__ import annotations

import ctypes
import errno
import itertools
import os
import socket
import struct
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from guestlib import (
    Candump,
    Frame,
    Pin,
    Proc,
    can_frame,
    can_socket,
    link_delete,
    link_down,
    link_up,
    netem,
    netem_clear,
    run,
    wait_for,
)

if TYPE_CHECKING:
    from contextlib import AbstractContextManager

LCM_GROUP = ("239.255.76.67", 7667)


def raises_errno(number: int) -> AbstractContextManager[object]:
    return pytest.raises(OSError, match=os.strerror(number))


@pytest.mark.parametrize("iface", ["vcan0", "vcan1"])
def test_virtual_buses_are_up_and_take_fd_frames(iface: str) -> None:
    link = run("ip", "link", "show", iface)
    assert "mtu 72" in link
    assert ",UP," in link


def test_candump_records_what_cansend_sends() -> None:
    with Candump("vcan0", "vcan1") as bus:
        run("cansend", "vcan0", "201#1122334455667788")
        run("cansend", "vcan1", "1FABCDE0##1AABB")
    classic, fd = bus.frames()
    data = bytes.fromhex("1122334455667788")
    assert classic == Frame(classic.t_ns, "vcan0", 0x201, ext=False, data=data)
    assert fd == Frame(fd.t_ns, "vcan1", 0x1FABCDE0, ext=True, data=b"\xaa\xbb", fd=True)


def test_candump_loses_no_frame_of_a_burst() -> None:
    with Candump("vcan0") as bus, can_socket("vcan0") as can:
        for burst in range(100):
            for index in range(50):
                can.send(can_frame(index, struct.pack("<I", burst)))
            time.sleep(0.001)
    expected = [(index, struct.pack("<I", burst)) for burst in range(100) for index in range(50)]
    assert [(frame.id, frame.data) for frame in bus.frames()] == expected


def test_thousand_hertz_loop_is_never_late() -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    timer = libc.timerfd_create(time.CLOCK_MONOTONIC, 0)
    assert timer >= 0
    period = struct.pack("@4l", 0, 1_000_000, 0, 1_000_000)
    start = time.monotonic_ns()
    assert libc.timerfd_settime(timer, 0, period, None) == 0
    missed = 0
    for _ in range(10_000):
        missed += struct.unpack("@Q", os.read(timer, 8))[0] - 1
    elapsed_ns = time.monotonic_ns() - start
    os.close(timer)
    assert missed == 0
    assert elapsed_ns == pytest.approx(10_000_000_000, abs=1_000_000)


def test_a_rate_spaces_frames_as_a_wire_does() -> None:
    netem("vcan0", "rate 1mbit limit 12")
    with Candump("vcan0") as bus, can_socket("vcan0") as can:
        for _ in range(10):
            can.send(can_frame(0x200, bytes(8)))
        time.sleep(0.01)
    stamps = [frame.t_ns for frame in bus.frames()]
    gaps_us = [(b - a) / 1000 for a, b in itertools.pairwise(stamps)]
    assert gaps_us == pytest.approx([128] * 9, abs=1)


def test_a_full_queue_refuses_a_frame() -> None:
    netem("vcan0", "rate 1mbit limit 12")

    def send(frames: int) -> None:
        for _ in range(frames):
            can.send(can_frame(0x200, bytes(8)))

    with can_socket("vcan0") as can:
        send(12)
        with raises_errno(errno.ENOBUFS):
            send(2)
        netem_clear("vcan0")
        send(1)


def test_injected_error_frame_is_received() -> None:
    with Candump("vcan0") as bus, can_socket("vcan0", errors=True) as can:
        run("cansend", "vcan0", "20000040#0000000000000000")
        number, size = struct.unpack_from("=IB", can.recv(16))
    assert number == socket.CAN_ERR_FLAG | 0x40
    assert size == 8
    assert [(frame.id, frame.error) for frame in bus.frames()] == [(0x40, True)]


def test_socket_works_again_after_down_and_up() -> None:
    with can_socket("vcan0") as can:
        link_down("vcan0")
        with raises_errno(errno.ENETDOWN):
            can.recv(16)
        with raises_errno(errno.ENETDOWN):
            can.send(can_frame(0x200, b""))
        link_up("vcan0")
        run("cansend", "vcan0", "123#")
        assert struct.unpack_from("=I", can.recv(16)) == (0x123,)
        can.send(can_frame(0x200, b""))


def test_deleted_link_ends_the_socket() -> None:
    with can_socket("vcan0") as can:
        link_delete("vcan0")
        with raises_errno(errno.ENODEV):
            can.recv(16)
        with raises_errno(errno.ENXIO):
            can.send(can_frame(0x200, b""))


def test_lcm_multicast_stays_on_lo() -> None:
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as receiver,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender,
    ):
        receiver.bind(LCM_GROUP)
        membership = socket.inet_aton(LCM_GROUP[0]) + socket.inet_aton("0.0.0.0")
        receiver.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, membership)
        receiver.settimeout(1.0)
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        sender.sendto(b"hello", LCM_GROUP)
        assert receiver.recv(64) == b"hello"
    assert "dev lo" in run("ip", "route", "get", LCM_GROUP[0])


def test_simulated_pin_follows_its_switch() -> None:
    with Pin(high=True) as pin:
        assert pin.chip.is_char_device()
        assert pin.high()
        pin.set(False)
        assert not pin.high()


def test_process_output_is_read_as_events() -> None:
    with Proc("bash", "-c", "sleep 30; echo one; sleep 30; echo two; sleep 1000") as process:
        start = time.monotonic()
        process.wait_line("one", timeout_s=31)
        process.wait_line("two", timeout_s=31)
        assert time.monotonic() - start == pytest.approx(60, abs=0.1)
        with pytest.raises(TimeoutError, match="no line 'three'"):
            process.wait_line("three", timeout_s=1)
        assert process.stop() == -15


@pytest.mark.parametrize("order", ["one two", "two one"])
def test_lines_of_several_threads_are_read_in_any_order(order: str) -> None:
    with Proc("bash", "-c", f"printf '%s\\n' {order} three; sleep 1000") as process:
        found = process.wait_lines("^one$", "^two$", timeout_s=5)
        assert [match[0] for match in found] == ["one", "two"]
        process.wait_line("three")


def test_wait_for_counts_virtual_seconds() -> None:
    start = time.monotonic()
    with pytest.raises(TimeoutError):
        wait_for(lambda: False, 3.0)
    assert time.monotonic() - start == pytest.approx(3, abs=0.01)


def test_root_is_read_only_and_scratch_is_not() -> None:
    with raises_errno(errno.EROFS):
        Path(os.environ["RC10_REPO"], "must-not-exist").touch()
    note = Path(os.environ["RC10_SCRATCH"], "note")
    note.write_text("kept on the host")
    note.unlink()
