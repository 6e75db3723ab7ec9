"""The rules about layers find what they forbid, and let pass what they allow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from check_layers import USES, violations

if TYPE_CHECKING:
    from pathlib import Path


def check(src: Path, file: str, text: str) -> list[str]:
    path = src / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return [str(violation) for violation in violations(src)]


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("app/a.hpp", '#include "bus/can_frame.hpp"'),
        ("bus/a.cpp", '#include "motor/motor_base.hpp"'),
        ("motor/a.cpp", '#include "daemon/scheduler.hpp"'),
        ("gateway/a.cpp", '#include "daemon/link_server.hpp"'),
        ("daemon/a.cpp", '#include "../bus/can_frame.hpp"'),
        ("bus/a.hpp", "#include <atomic>"),
        ("motor/a.hpp", "#  include <spdlog/spdlog.h>"),
        ("app/a.cpp", "auto t = std::chrono::steady_clock::now();"),
        ("sim/a.cpp", "clock_gettime(CLOCK_MONOTONIC, &t);"),
        ("elsewhere/a.cpp", ""),
    ],
)
def test_finds_what_is_forbidden(tmp_path: Path, file: str, text: str) -> None:
    found = check(tmp_path, file, f"#pragma once\n{text}\n")
    assert len(found) == 1
    assert found[0].startswith(str(tmp_path / file))


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("motor/a.hpp", '#include "bus/can_frame.hpp"'),
        ("motor/a.hpp", '#include "motor/b.hpp"'),
        ("daemon/a.cpp", "#include <atomic>\nauto t = std::chrono::steady_clock::now();"),
        ("app/a.hpp", "// not steady_clock::now(): the time is an argument"),
    ],
)
def test_lets_the_allowed_pass(tmp_path: Path, file: str, text: str) -> None:
    assert check(tmp_path, file, text) == []


def test_the_order_has_no_cycles() -> None:
    left = {layer: set(uses) for layer, uses in USES.items()}
    while left:
        lowest = [layer for layer, uses in left.items() if not uses & left.keys()]
        assert lowest, f"cycle among {sorted(left)}"
        for layer in lowest:
            del left[layer]
