"""Tests in this folder run in a network namespace of their own: see tests/host/run."""

from __future__ import annotations

import signal
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon, check_environment

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE = Path(__file__).parent

# A shell that runs this in the background ignores Ctrl-C, and programs inherit that.
signal.signal(signal.SIGINT, signal.default_int_handler)


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
