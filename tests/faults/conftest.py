"""The fault campaign runs inside the User-Mode Linux guest only: tests/faults/run."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "kernel"))

from guestlib.collection import fresh_buses, pytest_collection_modifyitems

__all__ = ["fresh_buses", "pytest_collection_modifyitems"]
