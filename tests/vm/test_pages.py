"""Commands that pages show for a real controller, typed for one with a real driver."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from guestlib import link_down
from hostlib.page import Block, blocks_run_by
from link_setup import link_details, set_link

REPO = Path(__file__).parents[2]
HERE = "tests/vm/test_pages.py"
CLASSIC = " bitrate 1000000 "
FD = " dbitrate 5000000 "


def shown(page: str) -> list[Block]:
    return blocks_run_by(HERE, REPO / "docs" / page)


def type_for(iface: str, block: Block) -> str:
    """Types it as root, for whom sudo has no use, and returns what became of the interface."""
    text = block.text.replace("sudo ", "").replace("can0", iface)
    done = subprocess.run(["bash", "-ec", text], capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{text}{done.stderr}"
    return link_details(iface)


@pytest.mark.parametrize("page", ["first-motor.md", "can-setup.md"])
def test_an_interface_comes_up_without_an_automatic_restart(page: str) -> None:
    set_link("can0", "bitrate 500000 restart-ms 100")
    link_down("can0")
    became = type_for("can0", shown(page)[0])
    for words in (CLASSIC, "restart-ms 0", ",UP,"):
        assert words in became, became


def test_an_interface_for_can_fd_comes_up_with_both_rates() -> None:
    _, block = shown("can-setup.md")
    try:
        became = type_for("can2", block)
        for words in (CLASSIC, FD, "<FD", "restart-ms 0", ",UP,"):
            assert words in became, became
    finally:
        link_down("can2")
