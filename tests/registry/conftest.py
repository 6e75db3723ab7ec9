"""Clients of others against our simulated drives, in a guest: scripts/test/registry.sh."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "kernel"))

from guestlib.collection import fresh_buses, pytest_collection_modifyitems

__all__ = ["fresh_buses", "pytest_collection_modifyitems"]
