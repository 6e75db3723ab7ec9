"""The installed package: the generated messages are in it, from a clone and from an sdist."""

from __future__ import annotations

import subprocess
import sys
import tarfile
import zipfile
from importlib import metadata
from pathlib import Path

import rc10
from rc10 import lcm_types

PROJECT = Path(__file__).parent.parent
TYPES = {f"rc10/lcm_types/{name}" for name in ("command_t.py", "command_t.pyi", "__init__.py")}


def build(project: Path, target: str, destination: Path) -> Path:
    subprocess.run(
        [sys.executable, "-m", "hatchling", "build", "-t", target, "-d", str(destination)],
        cwd=project,
        check=True,
        capture_output=True,
    )
    (built,) = destination.iterdir()
    return built


def names(wheel: Path) -> set[str]:
    with zipfile.ZipFile(wheel) as archive:
        listed = archive.namelist()
    assert len(listed) == len(set(listed)), "no file twice"
    return set(listed)


def test_a_wheel_from_an_sdist_is_that_from_a_clone(tmp_path: Path) -> None:
    sdist = build(PROJECT, "sdist", tmp_path / "sdist")
    with tarfile.open(sdist) as archive:
        members = archive.getnames()
        assert not any("src/rc10/lcm_types" in name for name in members), "nothing generated"
        archive.extractall(tmp_path / "unpacked")
    (unpacked,) = (tmp_path / "unpacked").iterdir()

    direct = names(build(PROJECT, "wheel", tmp_path / "direct"))
    indirect = names(build(unpacked, "wheel", tmp_path / "indirect"))
    assert direct == indirect
    assert direct >= TYPES | {
        "rc10/py.typed",
        "rc10/client.py",
        "rc10/fakes/__main__.py",
        "rc10/step/__main__.py",
    }
    assert not any(name.startswith("tests") for name in direct)


def test_the_installed_version_is_this_one() -> None:
    assert metadata.version("rc10") == rc10.__version__


def test_the_generated_package_is_ours() -> None:
    assert lcm_types.command_t.__module__ == "rc10.lcm_types.command_t"


def test_everything_public_is_there() -> None:
    assert all(hasattr(rc10, name) for name in rc10.__all__)
