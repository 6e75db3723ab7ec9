"""Clients that others publish in registries of packages, against our simulated drives."""
# run-guest: --timeout 900

from __future__ import annotations

import json
import math
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from guestlib import Proc
from rig import BIN, REPO

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE = Path(__file__).resolve().parent
CLIENTS = REPO / "build" / "registry" / "bin" / "python"


@pytest.fixture(autouse=True)
def drives() -> Iterator[None]:
    with Proc(BIN / "rc10-sim", "-c", HERE / "drives.yaml") as simulator:
        simulator.wait_line("^ready", 30.0)
        yield


def said_by(client: str) -> dict[str, Any]:
    done = subprocess.run(
        [str(CLIENTS), str(HERE / f"client_{client}.py")],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    print(done.stdout, done.stderr)
    assert done.returncode == 0, done.stderr
    said: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return said


def test_moteus_turns_its_drive() -> None:
    said = said_by("moteus")
    assert said["modes"] == [0, 10, 0]
    assert said["faults"] == [0, 0, 0]
    assert said["rev_s"] == pytest.approx(0.5, abs=0.05)
    assert 0.2 < said["turned_rev"] < 0.7
    assert said["volts"] == pytest.approx(24.0, abs=1.0)
    assert said["torque_at_rest_nm"] == pytest.approx(0.0, abs=0.02)


def test_damiao_motor() -> None:
    said = said_by("damiao")
    assert said["ranges"] == pytest.approx([12.5, 30.0, 10.0])
    assert said["turning"]["status"] == "ENABLED"
    assert said["turning"]["vel"] == pytest.approx(3.0, abs=0.3)
    assert said["stopped"]["status"] == "DISABLED"
    assert abs(said["stopped"]["torq"]) < 0.05


def test_motorbridge_turns_drives_of_three_families() -> None:
    said = said_by("motorbridge")
    assert said["damiao_ranges"] == pytest.approx([12.5, 30.0, 10.0])
    assert said["damiao"]["rad_s"] == pytest.approx(3.0, abs=0.3)
    assert said["damiao"]["status"] == 1
    assert said["robstride_ping"][0] == 127
    assert said["robstride_volts"] == pytest.approx(48.0, abs=1.0)
    assert said["robstride"]["rad_s"] == pytest.approx(3.0, abs=0.3)
    assert said["myactuator"]["rad_s"] == pytest.approx(3.0, abs=0.3)


def test_python_can() -> None:
    said = said_by("python_can")
    rpm, current = said["turning"][1:3]
    assert rpm > 100
    assert current == pytest.approx(1000, rel=0.2)
    assert abs(said["resting"][2]) < 20
    assert math.isfinite(said["first"][3])
