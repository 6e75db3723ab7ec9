"""Tests in this folder run in a network namespace of their own: see tests/host/run."""

from __future__ import annotations

import ctypes
import signal
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon, check_environment

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE = Path(__file__).parent
MULTICAST = ("239.255.76.67/32", "dev", "lo", "src", "127.0.0.1")

# A shell that runs this in the background ignores Ctrl-C, and programs inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)
# nohup does so with the end of the terminal, and rc10d keeps what it inherits.
signal.signal(signal.SIGHUP, signal.default_int_handler)
# A run that is broken off removes its folders: some lie in memory.
signal.signal(signal.SIGTERM, signal.default_int_handler)


CLONE_NEWNET = 0x40000000  # <linux/sched.h>


def pytest_configure(config: pytest.Config) -> None:
    """Each worker of pytest-xdist has a network of its own: one robot is not heard by another."""
    if not hasattr(config, "workerinput"):
        return
    if ctypes.CDLL(None, use_errno=True).unshare(CLONE_NEWNET) != 0:
        raise OSError(ctypes.get_errno(), "a network namespace for a worker")
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
    subprocess.run(["ip", "route", "add", *MULTICAST], check=True)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    reason = check_environment()
    for item in items:
        if reason is not None and HERE in item.path.parents:
            item.add_marker(pytest.mark.skip(reason=reason))


@pytest.fixture
def daemon() -> Iterator[Daemon]:
    """rc10d with three simulated motors on two buses, all READY."""
    with Daemon() as daemon:
        daemon.wait_ready()
        yield daemon


@pytest.fixture(scope="module")
def robot(request: pytest.FixtureRequest) -> Iterator[Daemon]:
    """rc10d with the robot of the test's file, all READY."""
    with Daemon(request.module.ROBOT) as daemon:
        daemon.wait_ready()
        yield daemon


@pytest.fixture
def no_route() -> Iterator[None]:
    """The reader adds the route of the multicast."""
    subprocess.run(["ip", "route", "del", *MULTICAST], check=True)
    yield
    subprocess.run(["ip", "route", "replace", *MULTICAST], check=True)
