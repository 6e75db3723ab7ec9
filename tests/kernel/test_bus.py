"""The unit tests of src/bus that need real SocketCAN."""

from __future__ import annotations

import re

from guestlib import run
from rig import BUILD


def test_the_bus_on_real_socketcan() -> None:
    output = run(BUILD / "tests" / "bus_test", "--gtest_filter=*SocketCan*")
    passed = re.search(r"\[  PASSED  \] (\d+) tests", output)
    assert passed is not None
    assert int(passed[1]) >= 16, output
