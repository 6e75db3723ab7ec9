"""docs/tuning.md: what it shows is run, in its order, against the robot that it shows."""

from __future__ import annotations

from pathlib import Path

import pytest
from hostlib import Daemon
from hostlib.daemon import REPO
from hostlib.page import blocks, robots, run
from hostlib.shown import rows_missing


# Some programs, on a machine that may be busy.
@pytest.mark.timeout(300)
def test_everything_that_it_shows_works(tmp_path: Path) -> None:
    page = REPO / "docs" / "tuning.md"
    (robot,) = robots(page)
    shown = [block for block in blocks(page) if block.kind in ("sh", "text")]
    assert len(shown) == 7
    printed = ""
    with Daemon(robot) as daemon:
        daemon.wait_ready()
        for block in shown:
            if block.kind == "text":
                assert rows_missing(block.text, printed) == [], printed
            else:
                printed = run(block, daemon, tmp_path)
    for picture in ("step.png", "angle.png", "bode.png"):
        assert (tmp_path / picture).read_bytes().startswith(b"\x89PNG")
