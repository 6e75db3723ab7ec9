"""Tests in this folder run inside the QEMU guest only: can0 and can1 on one simulated wire."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE = Path(__file__).parent
IN_GUEST = os.environ.get("RC10_GUEST") == "vm"

# On the host, where the tests are only collected to be skipped, nobody sets PYTHONPATH.
sys.path.append(str(HERE.parent / "kernel"))
# The readers of pages are there.
sys.path.append(str(HERE.parent / "host"))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    if IN_GUEST:
        return
    for item in items:
        if HERE in item.path.parents:
            item.add_marker(pytest.mark.skip(reason="needs CAN controllers: use tests/vm/run"))


@pytest.fixture(autouse=True)
def fresh_controllers() -> Iterator[None]:
    """Restart both controllers after a test: states and counters start from zero."""
    from guestlib import link_down, link_up

    yield
    for iface in ("can0", "can1"):
        link_down(iface)
        link_up(iface)
