"""The commands of a page of docs/, run as a reader would."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from typing import TYPE_CHECKING, NamedTuple

from hostlib.daemon import BIN, REPO, Daemon

if TYPE_CHECKING:
    from pathlib import Path

BLOCK = re.compile(r"^```(?P<kind>\w+)?(?: (?P<note>\S+))?\n(?P<text>.*?)^```$", re.M | re.S)
# Commands that cannot run here: see CONTRIBUTING.md. Beside them there is the path of a test.
NOT_RUN = {"hardware"}
ROBOT = re.compile(r"(?:#.*\n)*robot:")


class Block(NamedTuple):
    kind: str
    text: str


def blocks(page: Path) -> list[Block]:
    """The blocks of code that are of a kind and can run here."""
    found = list(BLOCK.finditer(page.read_text(encoding="utf-8")))
    notes = {block["note"] for block in found if block["kind"] and block["note"]} - NOT_RUN
    for note in notes:
        assert "/" in note, f"{page.name}: '{note}' is none of {', '.join(sorted(NOT_RUN))}"
        assert (REPO / note).is_file(), f"{page.name}: there is no {note}"
    return [Block(b["kind"], b["text"]) for b in found if b["kind"] and not b["note"]]


def blocks_run_by(test: str, page: Path) -> list[Block]:
    """Those that the page says this test runs."""
    found = BLOCK.finditer(page.read_text(encoding="utf-8"))
    chosen = [Block(b["kind"], b["text"]) for b in found if b["kind"] and b["note"] == test]
    assert chosen, f"{page.name}: no block is marked {test}"
    return chosen


def robots(page: Path) -> list[str]:
    """The configurations that it shows: whole ones, and buses of a robot without a name."""
    found = []
    for block in blocks(page):
        if block.kind == "yaml" and ROBOT.match(block.text):
            found.append(block.text)
        elif block.kind == "yaml" and block.text.startswith("buses:") and "motors:" in block.text:
            found.append("robot: page\n" + block.text)
    return found


def run(block: Block, daemon: Daemon, folder: Path) -> str:
    """Runs Python or shell in the folder, which must succeed; what it printed."""
    if not (folder / "python").exists():
        os.symlink(REPO / "python", folder / "python")
    if not (folder / ".venv").exists():
        os.symlink(sys.prefix, folder / ".venv")
    python = os.path.dirname(sys.executable)
    env = {**os.environ, **daemon.env, "PATH": f"{python}:{BIN}:{os.environ['PATH']}"}
    command = [sys.executable, "-c"] if block.kind == "python" else ["bash", "-ec"]
    done = subprocess.run(
        [*command, block.text], cwd=folder, env=env, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{block.text}\n{done.stdout}{done.stderr}"
    return done.stdout
