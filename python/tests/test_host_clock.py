from __future__ import annotations

import pytest

from rc10.host_clock import HostClock


def test_the_quickest_message_sets_the_distance() -> None:
    clock = HostClock()
    assert clock.observe(100.0, 7.002) == pytest.approx(7.002)
    assert clock.observe(101.0, 8.001) == pytest.approx(8.001)
    # This one was half a second on its way.
    assert clock.observe(102.0, 9.5) == pytest.approx(9.001, abs=1e-3)


def test_a_slower_host_clock_does_not_add_up() -> None:
    clock = HostClock()
    for second in range(3600):
        taken_s = clock.observe(second * (1 - 50e-6), float(second))
    assert taken_s == pytest.approx(3599.0, abs=1e-6)


def test_a_faster_host_clock_does_not_add_up() -> None:
    clock = HostClock()
    for second in range(3600):
        taken_s = clock.observe(second * (1 + 50e-6), float(second))
    assert taken_s == pytest.approx(3599.0, abs=1e-6)


def test_a_host_that_has_slept_is_placed_anew() -> None:
    clock = HostClock()
    clock.observe(5000.0, 10.0)
    assert clock.observe(5001.0, 70.0) < 20.0
    for tick in range(600):
        clock.observe(5001.0 + tick * 0.01, 70.0 + tick * 0.01)
    assert clock.observe(5007.0, 76.0) == pytest.approx(76.0)


def test_messages_of_a_queue_that_is_read_in_bursts_are_as_old_as_they_are() -> None:
    clock = HostClock()
    clock.observe(5000.0, 10.0)
    for turn in range(10):
        for i in range(100):
            taken_s = clock.observe(5000.0 + 2 * turn + i * 0.005, 12.0 + 2 * turn)
            assert taken_s < 10.0 + 2 * turn + 0.51


def test_a_restarted_host_begins_anew() -> None:
    clock = HostClock()
    clock.observe(5000.0, 10.0)
    assert clock.observe(3.0, 20.0) == pytest.approx(20.0)


def test_messages_of_a_queue_that_is_never_empty_are_as_old_as_they_are() -> None:
    clock = HostClock()
    clock.observe(5000.0, 1000.0)
    # A callback of 12 ms for each of 200 states a second: each waits for 1.2 s.
    for turn in range(1000):
        host_s, local_s = 5000.0 + turn * 0.012, 1001.2 + turn * 0.012
        assert clock.observe(host_s, local_s, last=False) < local_s - 1.1
