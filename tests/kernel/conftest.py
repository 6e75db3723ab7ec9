"""Tests in this folder run inside the User-Mode Linux guest only."""

from guestlib.collection import fresh_buses, pytest_collection_modifyitems

__all__ = ["fresh_buses", "pytest_collection_modifyitems"]
