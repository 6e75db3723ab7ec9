"""`build` of scripts/lib/project.sh: a tree is configured once."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]

# Writes down what it is asked for; configuring makes the build files.
CMAKE = """#!/bin/bash
echo "$1 $2" >>"$CALLS"
[ "$1" != --preset ] || { mkdir -p "build/$2" && touch "build/$2/build.ninja"; }
"""


@pytest.fixture
def repo(tmp_path: Path) -> Path:
    shutil.copytree(REPO / "scripts" / "lib", tmp_path / "scripts" / "lib")
    shutil.copy(REPO / "CMakePresets.json", tmp_path)
    os.utime(tmp_path / "CMakePresets.json", (1, 1))
    cmake = tmp_path / "bin" / "cmake"
    cmake.parent.mkdir()
    cmake.write_text(CMAKE)
    cmake.chmod(0o755)
    return tmp_path


def test_a_clone_that_cannot_be_written_fails_at_once(repo: Path) -> None:
    (repo / "build").touch()
    done = subprocess.run(
        ["bash", "-c", f". '{repo}/scripts/lib/project.sh'; build dev || echo failed"],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, "PATH": f"{repo}/bin:{os.environ['PATH']}", "CALLS": f"{repo}/calls"},
    )
    assert len(done.stderr.splitlines()) == 1
    assert done.stdout.splitlines()[-1] == "failed"
    assert not (repo / "calls").exists()


@pytest.mark.parametrize(
    "foreign", ["build", "build/.dev.lock", "build/dev", "build/dev/src/motor.o"]
)
def test_what_a_run_with_sudo_has_left_is_named_with_the_remedy(
    foreign: str, repo: Path, stranger: list[str]
) -> None:
    calls_of_a_build(repo)
    (repo / "calls").unlink()
    (repo / "build" / "dev" / "src").mkdir()
    (repo / "build" / "dev" / "src" / "motor.o").touch()
    (repo / foreign).chmod(0o555)
    done = subprocess.run(
        [*stranger, "bash", "-c", f". '{repo}/scripts/lib/project.sh'; build dev"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "PATH": f"{repo}/bin:{os.environ['PATH']}", "CALLS": f"{repo}/calls"},
    )
    remedy = 'sudo chown -R "$USER" . (in the clone)'
    assert done.stderr == f"{foreign} belongs to another user: {remedy}\n"
    assert done.returncode != 0
    assert not (repo / "calls").exists()


def calls_of_a_build(repo: Path) -> list[str]:
    calls = repo / "calls"
    calls.write_text("")
    subprocess.run(
        ["bash", "-c", f". '{repo}/scripts/lib/project.sh'; build dev"],
        check=True,
        env={**os.environ, "PATH": f"{repo}/bin:{os.environ['PATH']}", "CALLS": str(calls)},
    )
    return calls.read_text().splitlines()


def test_a_new_tree_is_configured(repo: Path) -> None:
    assert calls_of_a_build(repo) == ["--preset dev", "--build --preset"]


def test_a_configured_tree_is_only_built(repo: Path) -> None:
    """Configuring writes the lists of tests anew, under the eyes of a ctest that reads them."""
    calls_of_a_build(repo)
    assert calls_of_a_build(repo) == ["--build --preset"]


def test_a_preset_that_has_changed_is_configured_anew(repo: Path) -> None:
    calls_of_a_build(repo)
    os.utime(repo / "build" / "dev" / "build.ninja", (2, 2))
    os.utime(repo / "CMakePresets.json", (3, 3))
    assert calls_of_a_build(repo) == ["--preset dev", "--build --preset"]


def test_a_tree_that_was_copied_with_its_clone_is_configured_anew(repo: Path) -> None:
    calls_of_a_build(repo)
    cache = repo / "build" / "dev" / "CMakeCache.txt"
    cache.write_text(f"CMAKE_HOME_DIRECTORY:INTERNAL={repo}\n")
    assert calls_of_a_build(repo) == ["--build --preset"]
    cache.write_text("CMAKE_HOME_DIRECTORY:INTERNAL=/another/clone\n")
    assert calls_of_a_build(repo) == ["--preset dev", "--build --preset"]
