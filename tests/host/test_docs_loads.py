"""Loads of a bus that pages claim, beside those that `rc10d --check` predicts."""

from __future__ import annotations

import re
import subprocess
from typing import TYPE_CHECKING, NamedTuple

import pytest
from hostlib.daemon import BIN, REPO

if TYPE_CHECKING:
    from pathlib import Path

FD = "data_bitrate: 5000000"
KV = ", motor_kv_rpm_per_v: 300"


class Claim(NamedTuple):
    page: str
    words: str  # that stand there
    model: str
    motors: int
    keys: str = ""
    divider: int = 1
    bus: str = ""
    rate_hz: int = 1000
    load: tuple[int, int] | None = (
        None  # percent, rounded; none: it fits, and with one motor more frames wait
    )


CLAIMS = [
    Claim(
        "motors.md",
        "Four motors and one command frame at 1 kHz: 56 to 68 %",
        "M3508",
        4,
        load=(56, 68),
    ),
    Claim("motors.md", "Six motors in two command frames: 89 to 108 %", "M3508", 6, load=(89, 108)),
    Claim("motors/robstride.md", "takes 27 to 33 %", "RS00", 1, load=(27, 33)),
    Claim("motors/robstride.md", "two drives fit at 1 kHz", "RS00", 2),
    Claim("motors/robstride.md", "four with `command_divider: 2`", "RS00", 4, divider=2),
    Claim("motors/damiao.md", "takes 22 to 27 %", "DM4310", 1, load=(22, 27)),
    Claim("motors/damiao.md", "two fit", "DM4310", 2),
    Claim("motors/damiao.md", "five with `command_divider: 2`", "DM4310", 5, divider=2),
    Claim(
        "motors/damiao.md",
        "20 to 23 % at `rate_hz: 2000`",
        "DM4310",
        1,
        ", can_fd: true",
        bus=FD,
        rate_hz=2000,
        load=(20, 23),
    ),
    Claim(
        "motors/damiao.md",
        "39 to 45 % at 4000",
        "DM4310",
        1,
        ", can_fd: true",
        bus=FD,
        rate_hz=4000,
        load=(39, 45),
    ),
    Claim("motors/moteus.md", "three drives at 1 kHz fit", "moteus", 3, KV, bus=FD),
    Claim(
        "motors/moteus.md",
        "one takes 44 to 53 %",
        "moteus",
        1,
        KV,
        bus=FD,
        rate_hz=2000,
        load=(44, 53),
    ),
    Claim(
        "motors/moteus.md",
        "at 4000 88 to 106 %",
        "moteus",
        1,
        KV,
        bus=FD,
        rate_hz=4000,
        load=(88, 106),
    ),
    Claim(
        "motors/myactuator.md", "54 % of 1 Mbit/s in the worst case", "RMD-X8-25", 1, load=(45, 54)
    ),
    Claim("motors/myactuator.md", "2 for two motors", "RMD-X8-25", 2, divider=2),
    Claim("motors/myactuator.md", "4 for up to five", "RMD-X8-25", 5, divider=4),
]


def check(claim: Claim, motors: int, folder: Path) -> str:
    """The predicted load, and the warning where frames wait."""
    text = f"robot: page\nscheduler: {{rate_hz: {claim.rate_hz}}}\n"
    text += f"buses:\n  - name: bus\n    interface: can0\n    {claim.bus}\n    motors:\n"
    for number in range(1, motors + 1):
        master = f", master_id: {number + 16}" if claim.model.startswith("DM") else ""
        text += f"      - {{name: m{number}, model: {claim.model}, id: {number}"
        text += f", command_divider: {claim.divider}" if claim.divider > 1 else ""
        text += f"{master}{claim.keys}}}\n"
    file = folder / "robot.yaml"
    file.write_text(text)
    done = subprocess.run(
        [BIN / "rc10d", "--check", file], capture_output=True, text=True, check=False
    )
    said = done.stdout + done.stderr
    assert "predicted load" in said, said
    return said


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: f"{claim.page}: {claim.words}")
def test_a_load_is_that_which_the_check_predicts(claim: Claim, tmp_path: Path) -> None:
    page = (REPO / "docs" / claim.page).read_text(encoding="utf-8")
    assert claim.words in " ".join(page.split())
    said = check(claim, claim.motors, tmp_path)
    if claim.load is None:
        assert "makes frames wait" not in said
        assert re.search("makes frames wait|does not fit", check(claim, claim.motors + 1, tmp_path))
    else:
        found = re.search(r"predicted load ([\d.]+) % to ([\d.]+) %", said)
        assert found, said
        # A page cuts where it does not round.
        low, high = (float(percent) for percent in found.groups())
        assert abs(low - claim.load[0]) < 1
        assert abs(high - claim.load[1]) < 1
