"""Tests in this folder run inside the User-Mode Linux guest only."""

import sys
from pathlib import Path

# The readers of pages are there.
sys.path.insert(0, str(Path(__file__).parents[1] / "host"))

from guestlib.collection import fresh_buses, pytest_collection_modifyitems

__all__ = ["fresh_buses", "pytest_collection_modifyitems"]
