"""Python packages are installed by their hashes."""

from __future__ import annotations

from pathlib import Path

import hashed_requirements
import pytest


def test_each_pin_of_the_project_has_hashes() -> None:
    lines = hashed_requirements.hashed(hashed_requirements.FILES)
    assert len(lines) > 30
    assert all("--hash=sha256:" in line for line in lines)
    conditional = next(line for line in lines if line.startswith("tomli=="))
    assert '; python_version < "3.11" --hash=' in conditional


def test_a_pin_without_hashes_is_named(tmp_path: Path) -> None:
    file = tmp_path / "requirements.txt"
    file.write_text("# a comment\nlcm==1.5.3\nlcm==9.9.9\n")
    with pytest.raises(SystemExit, match=r"python-hashes.txt has no hashes of lcm==9\.9\.9; its"):
        hashed_requirements.hashed([file])


def test_a_requirement_without_a_version_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "requirements.txt"
    file.write_text("lcm>=1.5\n")
    with pytest.raises(SystemExit, match=r"'lcm>=1\.5' has no version: write name==version"):
        hashed_requirements.hashed([file])


def test_names_are_the_same_however_they_are_spelt() -> None:
    assert hashed_requirements.pin("Mypy_Extensions==1.2.0") == "mypy-extensions==1.2.0"
