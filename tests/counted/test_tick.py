"""The cost of a millisecond, and how late ticks are, counted in a PREEMPT_RT guest.

Instructions, not times: the same program gives the same figures on a busy machine. The limits are
the goals of docs/performance.md.
"""

from __future__ import annotations

import os
from pathlib import Path

import guest
import pytest
from robots import DAMIAO, DJI, Cost, Robot, measure_rc10d

BUILD = Path(os.environ.get("RC10_BUILD", Path(__file__).resolve().parents[2] / "build" / "dev"))
HOG_US = 3000


def measure(robot: Robot, *, settings: str = "", hog_us: int = 0) -> Cost:
    kernel = guest.installed_rt_kernel()
    return measure_rc10d(kernel, robot, BUILD, settings=settings, hog_us=hog_us)


@pytest.fixture(scope="module")
def wheels() -> Cost:
    return measure(DJI)


def test_four_drives_with_frames_of_their_own_cost_what_a_peer_does() -> None:
    assert measure(DAMIAO).busy_k <= 68.0  # 1.2 of openarm_can's 56.9


def test_eight_wheels_on_two_buses_cost_no_more_than_their_goal(wheels: Cost) -> None:
    assert wheels.busy_k <= 80.0


def test_frames_wake_the_rx_thread_only_if_it_receives(wheels: Cost) -> None:
    assert wheels.threads_k["rx"] < 0.5
    by_thread = measure(DJI, settings="receive: thread")
    assert by_thread.threads_k["rx"] > 10.0
    assert by_thread.threads_k["sched"] < wheels.threads_k["sched"]
    assert by_thread.busy_k <= 95.0


def test_a_lower_thread_that_keeps_the_cpu_does_not_delay_ticks(wheels: Cost) -> None:
    beside = measure(DJI, hog_us=HOG_US)
    for share in ("p50", "p99"):
        assert beside.lateness_us[share] <= 1.6 * wheels.lateness_us[share], share


def test_by_timerfd_a_tick_would_be_late() -> None:
    """The guest shows what the test before is about."""
    late = measure(DJI, settings="scheduler: {timer: timerfd}", hog_us=HOG_US)
    assert late.lateness_us["p99"] > HOG_US / 2
