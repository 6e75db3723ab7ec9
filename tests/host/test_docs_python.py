"""docs/python.md: what it shows is run, in its order, against the robot of the demo."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from hostlib import Daemon
from hostlib.daemon import REPO
from hostlib.page import blocks, run
from hostlib.shown import rows_missing


@pytest.fixture
def demo() -> Iterator[Daemon]:
    with Daemon((REPO / "config" / "demo.yaml").read_text(encoding="utf-8")) as daemon:
        daemon.wait_ready()
        yield daemon


# A dozen programs, on a machine that may be busy.
@pytest.mark.timeout(400)
def test_everything_that_it_shows_works(
    demo: Daemon, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # In place of a display: windows that are closed at once.
    monkeypatch.setenv("MPLBACKEND", "svg")
    # The robot of the policy loop: test_policy.py.
    shown = [block for block in blocks(REPO / "docs" / "python.md") if block.kind != "yaml"]
    assert len(shown) >= 9
    printed = ""
    for block in shown:
        if block.kind == "text":
            assert rows_missing(block.text, printed) == [], printed
        else:
            printed = run(block, demo, tmp_path)
    written = {path.name for path in tmp_path.iterdir()}
    assert written >= {"all.csv", "yaw.png", "step.png", "wheels.png", "bode.png"}
    assert written >= {"match.lcmlog.mcap", "match.lcmlog.csv"}
    assert (tmp_path / "bode.png").read_bytes().startswith(b"\x89PNG")
    table = (tmp_path / "wheels.csv").read_text(encoding="utf-8").splitlines()
    assert table[0] == "time_s,front_left.velocity_rpm,yaw.angle_deg"
    assert len(table) > 50
    demo.wait_motors(lambda motor: motor["acting"] != "target", "obeys nobody any more")
