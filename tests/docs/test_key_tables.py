"""The tables of keys are what scripts/lib/key_tables.py makes of the schema."""

from __future__ import annotations

import shutil
import subprocess
from typing import TYPE_CHECKING

import pytest
from pages import REPO

if TYPE_CHECKING:
    from pathlib import Path


def key_tables(*words: str | Path) -> subprocess.CompletedProcess[str]:
    command = [REPO / "scripts/lib/key_tables.py", *words]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    shutil.copytree(REPO / "docs", tmp_path / "docs", ignore=shutil.ignore_patterns("images"))
    (tmp_path / "config").mkdir()
    shutil.copy(REPO / "config/rc10d.schema.json", tmp_path / "config")
    return tmp_path


def edit(file: Path, old: str, new: str) -> None:
    text = file.read_text(encoding="utf-8")
    assert text.count(old) == 1
    file.write_text(text.replace(old, new), encoding="utf-8")


def test_every_table_is_as_the_schema_says() -> None:
    done = key_tables("--check")
    assert done.returncode == 0, done.stdout + done.stderr


def test_a_table_that_somebody_has_edited_is_found_and_mended(copy: Path) -> None:
    page = copy / "docs/motors/vesc.md"
    before = page.read_text(encoding="utf-8")
    edit(page, "| `25000` |", "| `30000` |")
    done = key_tables("--check", copy)
    assert (done.returncode, done.stdout) == (1, "docs/motors/vesc.md: is not as the schema says\n")
    assert "--target reference" in done.stderr
    assert key_tables(copy).stdout == "docs/motors/vesc.md: written\n"
    assert page.read_text(encoding="utf-8") == before


def test_a_section_without_a_table_is_named(copy: Path) -> None:
    edit(copy / "docs/modules.md", "<!-- keys: module_joint -->\n", "")
    done = key_tables("--check", copy)
    assert done.returncode == 1
    assert "on no page: module_joint" in done.stderr


def test_a_table_of_nothing_is_named_with_its_page(copy: Path) -> None:
    edit(copy / "docs/modules.md", "keys: module_joint ", "keys: module_elbow ")
    done = key_tables("--check", copy)
    assert done.returncode == 1
    assert "docs/modules.md: there is no 'module_elbow'; there are: " in done.stderr
