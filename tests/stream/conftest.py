"""Runs in a network namespace of its own: see scripts/test/long_stream.sh."""

from __future__ import annotations

import pytest
from hostlib import check_environment


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    reason = check_environment()
    for item in items:
        if reason is not None:
            item.add_marker(pytest.mark.skip(reason=reason))
