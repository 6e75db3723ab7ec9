"""Hooks of pytest for each folder of guest tests: import both names into its conftest.py."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from guestlib.links import reset_buses

if TYPE_CHECKING:
    from collections.abc import Iterator


def pytest_collection_modifyitems() -> None:
    """Refuses to run elsewhere: what these tests do to the buses must stay in a guest."""
    if os.environ.get("RC10_GUEST") != "kernel":
        raise pytest.UsageError(
            "these tests need a guest: use tests/kernel/run or tests/faults/run"
        )


@pytest.fixture(autouse=True)
def fresh_buses() -> Iterator[None]:
    """One guest runs many tests: none may find what another did to the buses."""
    yield
    reset_buses("vcan0", "vcan1")
