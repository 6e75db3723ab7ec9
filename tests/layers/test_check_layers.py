"""The rules about layers find what they forbid, and let pass what they allow."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from check_layers import ROOMS, USES, violations

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
        ("daemon/elsewhere/a.cpp", ""),
        ("bus/elsewhere/a.cpp", ""),
        ("robot_client/session/a.cpp", '#include "robot_client/elsewhere/b.hpp"'),
        ("tools/rc10ctl/a.cpp", '#include "tools/rc10-web/b.hpp"'),
        ("daemon/tick/a.cpp", '#include "daemon/threads/rx_loop.hpp"'),
        ("daemon/tick/a.cpp", '#include "daemon/log.hpp"'),
        ("config/yaml/a.cpp", '#include "config/keys/key_table.hpp"'),
        ("drives/vesc/a.cpp", '#include "drives/dji/dji_model.hpp"'),
        ("app/a.cpp", "#include <daemon/daemon.hpp>"),
        ("daemon/tick/a.cpp", "#include <daemon/threads/rx_loop.hpp>"),
        ("drives/vesc/vesc_simulated.cpp", '#include "drives/vesc/vesc_motor.hpp"'),
        ("drives/vesc/vesc_simulated.cpp", '#include "vesc_motor.hpp"'),
        ("drives/vesc/vesc_motor.cpp", '#include "drives/vesc/vesc_simulated.hpp"'),
        ("drives/vesc/vesc_motor.cpp", '#include "sim/drive.hpp"'),
        ("drives/vesc/vesc_motor.hpp", '#include "drives/families.hpp"'),
        ("motor/a.hpp", '#include "motor/guarding/motor_guard.hpp"'),
        ("config/yaml/a.hpp", '#include "config/load_config.hpp"'),
        ("bus/a.cpp", '/**/ #include "daemon/daemon.hpp"'),
        ("bus/a.cpp", "#include HEADER"),
        ("bus/a.cpp", '#import "bus/b.hpp"'),
        ("bus/a.inl", ""),
        ("bus/a.h", ""),
        ("daemon/tick/deep/a.cpp", ""),
        ("bus/a.cpp", "#include <threads.h>"),
        ("bus/a.cpp", "auto t = Clock::now();"),
        ("bus/a.cpp", "auto t = std::time(NULL);"),
        ("bus/a.cpp", 'f("http://x"); auto t = steady_clock::now();'),
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
        ("daemon/tick/a.cpp", '#include "daemon/devices/robot.hpp"'),
        ("config/yaml/a.cpp", '#include "config/robot_config.hpp"'),
        ("drives/vesc/a.cpp", '#include "drives/recogniser.hpp"'),
        ("daemon/a.cpp", "#include <atomic>\nauto t = std::chrono::steady_clock::now();"),
        ("app/a.hpp", "// not steady_clock::now(): the time is an argument"),
        ("app/a.hpp", '/* #include "daemon/daemon.hpp"\n steady_clock::now() */'),
        ("drives/vesc/vesc_simulated.cpp", '#include "drives/vesc/vesc_frames.hpp"'),
        ("config/load_config.hpp", '#include "config/yaml/problem.hpp"'),
    ],
)
def test_lets_the_allowed_pass(tmp_path: Path, file: str, text: str) -> None:
    assert check(tmp_path, file, text) == []


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("config/report/a.cpp", '#include "drives/vesc/vesc_family.hpp"'),
        ("config/keys/a.cpp", '#include "drives/vesc/vesc_family.hpp"'),
        ("config/build/a.cpp", "const bool mine = isVesc(motor);"),
        ("config/keys/a.cpp", "const bool mine = isVesc(motor);"),
        ("survey/a.cpp", 'say("VESC id " + id);'),
    ],
)
def test_finds_a_family_by_its_name(tmp_path: Path, file: str, text: str) -> None:
    check(tmp_path, "drives/vesc/vesc_family.hpp", "#pragma once\n")
    found = check(tmp_path, file, f"#pragma once\n{text}\n")
    assert len(found) == 1
    assert "vesc" in found[0]


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("config/keys/a.cpp", 'Key{.about = "Set on the drive (VESC: VESC Tool)."}'),
        ("survey/a.cpp", "// To a VESC it is packet 0xFD."),
        ("survey/a.cpp", '#include "drives/families.hpp"'),
        ("tools/a.cpp", "const bool mine = isVesc(motor);"),
    ],
)
def test_lets_families_be_named_in_texts_of_keys_and_comments(
    tmp_path: Path, file: str, text: str
) -> None:
    check(tmp_path, "drives/vesc/vesc_family.hpp", "#pragma once\n")
    assert check(tmp_path, file, text) == []


def test_the_order_has_no_cycles() -> None:
    # A layer's own headers are below its rooms where a room may include them.
    rooms = [{"": set[str](), **graph} for graph in ROOMS.values()]
    for graph in (USES, *rooms):
        left = {name: set(uses) for name, uses in graph.items()}
        while left:
            lowest = [name for name, uses in left.items() if not uses & left.keys()]
            assert lowest, f"cycle among {sorted(left)}"
            for name in lowest:
                del left[name]
