"""The folder of what serves all clones: in the home folder, or else in the clone."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]
# No folder can be made there, not even by root.
READ_ONLY = "/dev/null"


@pytest.fixture
def clone(tmp_path: Path) -> Path:
    clone = tmp_path / "a clone"
    shutil.copytree(REPO / "scripts" / "lib", clone / "scripts" / "lib")
    return clone


def run(command: list[str | Path], **variables: str) -> subprocess.CompletedProcess[str]:
    """Runs it with nothing of the caller's but the PATH."""
    environment = {"PATH": os.environ["PATH"], **variables}
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)


@pytest.mark.parametrize(
    ("variables", "folder"),
    [
        ({"HOME": "{}/home"}, "home/.cache/rc10"),
        ({"HOME": READ_ONLY, "XDG_CACHE_HOME": "{}/xdg"}, "xdg/rc10"),
        ({"HOME": READ_ONLY}, "a clone/build/cache"),
        ({}, "a clone/build/cache"),
        ({"HOME": "{}/home", "XDG_CACHE_HOME": READ_ONLY}, "a clone/build/cache"),
        ({"HOME": READ_ONLY, "RC10_CACHE": "{}/mine"}, "mine"),
    ],
    ids=["home", "XDG", "a read-only home", "no home", "a read-only XDG", "named"],
)
def test_it_is_one_that_can_be_written(
    variables: dict[str, str], folder: str, clone: Path, tmp_path: Path
) -> None:
    script = ". scripts/lib/cache.sh && printenv RC10_CACHE"
    values = {name: value.format(tmp_path) for name, value in variables.items()}
    # By a relative path, with a CDPATH that would find another.
    command = ["bash", "-euc", f"cd '{clone}' && CDPATH=/ && {script}"]
    done = run(list(command), **values)
    assert (done.stdout, done.stderr) == (f"{tmp_path / folder}\n", "")


def test_a_guest_starts_without_a_home(clone: Path) -> None:
    kernel = clone / "tests" / "kernel"
    kernel.mkdir(parents=True)
    shutil.copy(REPO / "tests" / "kernel" / "on-one-cpu", kernel)
    done = run([kernel / "on-one-cpu", "echo", "started"])
    assert (done.stdout, done.stderr) == ("started\n", "")
    assert list((clone / "build" / "cache").glob("cpu-*.lock"))


@pytest.mark.parametrize("home", ["home", READ_ONLY])
def test_npm_has_a_folder_where_the_home_cannot_be_written(
    home: str, clone: Path, tmp_path: Path
) -> None:
    shutil.copy(REPO / "scripts" / "web.sh", clone / "scripts")
    (clone / "web").mkdir()
    (clone / "docs").mkdir()
    (clone / "docs" / "troubleshooting.md").touch()
    npm = tmp_path / "bin" / "npm"
    npm.parent.mkdir()
    npm.write_text('#!/bin/sh\necho "npm: ${npm_config_cache:-its own}" >&2\nexit 1\n')
    npm.chmod(0o755)
    path = f"{npm.parent}:{os.environ['PATH']}"
    done = run([clone / "scripts" / "web.sh"], HOME=str(tmp_path / home), PATH=path)
    folder = f"{clone}/build/cache/npm" if home == READ_ONLY else "its own"
    assert done.stderr == f"npm: {folder}\n"
