"""The list of public headers: closed, and of files that exist."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from check_public_api import violations

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    """The layer app is public, of config one header."""
    (tmp_path / "cmake").mkdir()
    (tmp_path / "cmake" / "PublicApi.cmake").write_text(
        "set(RC10_PUBLIC_LAYERS app)\nset(RC10_PUBLIC_HEADERS\n  config/load.hpp)\n"
    )
    for name in ("app/units.hpp", "config/load.hpp", "config/tree.hpp"):
        file = tmp_path / "src" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text("#pragma once\n")
    return tmp_path


def test_public_headers_include_each_other(clone: Path) -> None:
    (clone / "src" / "config" / "load.hpp").write_text('#include "app/units.hpp"\n#include "v.h"\n')
    assert violations(clone) == []


def test_a_public_header_that_includes_an_internal_one_is_named(clone: Path) -> None:
    (clone / "src" / "app" / "units.hpp").write_text('#include "config/tree.hpp"\n')
    (found,) = violations(clone)
    assert found.startswith("app/units.hpp is public and includes config/tree.hpp")


def test_a_listed_header_that_is_gone_is_named(clone: Path) -> None:
    (clone / "src" / "config" / "load.hpp").unlink()
    assert violations(clone) == ["config/load.hpp: listed, and not there"]
