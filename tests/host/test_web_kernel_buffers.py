"""rc10-web: the room of its connections at the kernel."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from hostlib import Daemon
from test_web import Web


@pytest.fixture
def web(daemon: Daemon, tmp_path: Path) -> Iterator[Web]:
    server = Web(daemon, tmp_path)
    with server.program:
        yield server


def test_what_the_kernel_keeps_of_a_connection_is_bounded(web: Web) -> None:
    """Its buffers would grow to megabytes for one that does not read."""
    with web.page() as page:
        page.wait("state")
        ours = f"sport = :{web.port}"
        told = subprocess.run(["ss", "-Htnm", ours], capture_output=True, text=True, check=True)
        rooms = re.findall(r"rb(\d+),t\d+,tb(\d+)", told.stdout)
        assert rooms, told.stdout
        assert all(int(room) <= 128 << 10 for both in rooms for room in both), told.stdout
