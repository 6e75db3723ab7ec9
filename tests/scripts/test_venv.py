"""scripts/venv.sh and scripts/lib/pinned_venv ask for what is wanted, and for nothing else."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]
# In the places of venv and pip: what is asked for is written down, and nothing is downloaded.
VENV = """
import os, shutil, sys
shutil.rmtree(sys.argv[-1] + "/bin", ignore_errors=True)
os.makedirs(sys.argv[-1] + "/bin")
os.symlink(sys.executable, sys.argv[-1] + "/bin/python")
# With the fakes, which are among the packages of the user.
open(sys.argv[-1] + "/pyvenv.cfg", "w").write("include-system-site-packages = true\\n")
"""
PIP = """
import json, os, re, sys
lines = [word.partition("=")[2] for word in sys.argv if word.startswith("--requirement=")]
text = "".join(open(file).read() for file in lines)
asked = {
    "hashes": "--require-hashes" in sys.argv,
    "editable": "--editable" in sys.argv,
    "names": sorted(name.lower() for name in re.findall(r"^([\\w.-]+)==", text, re.MULTILINE)),
}
with open(os.environ["CALLS"], "a") as calls:
    calls.write(json.dumps(asked) + "\\n")
sys.exit("no network" if "OFFLINE" in os.environ else 0)
"""


class Environment:
    def __init__(self, folder: Path) -> None:
        self._folder = folder
        for name, text in (("venv", VENV), ("pip", PIP)):
            (folder / "fakes" / name).mkdir(parents=True)
            (folder / "fakes" / name / "__init__.py").touch()
            (folder / "fakes" / name / "__main__.py").write_text(text)
        packages = folder / "user" / "lib" / f"python{sys.version_info[0]}.{sys.version_info[1]}"
        start = packages / "site-packages" / "usercustomize.py"
        start.parent.mkdir(parents=True)
        start.write_text(f"import sys\nsys.path.insert(0, {str(folder / 'fakes')!r})\n")

    def make(self, *words: str) -> list[dict[str, object]]:
        """Requests to pip of venv.sh."""
        printed, calls = self.run(REPO / "scripts" / "venv.sh", *words)
        assert printed == str(self._folder / "venv" / "bin" / "python")
        return calls

    def run(self, *command: str | Path) -> tuple[str, list[dict[str, object]]]:
        """Last line printed, and requests to pip."""
        calls = self._folder / "calls"
        calls.write_text("")
        done = subprocess.run(
            command,
            capture_output=True,
            text=True,
            check=True,
            env={
                **os.environ,
                "CALLS": str(calls),
                "PYTHONUSERBASE": str(self._folder / "user"),
                "RC10_VENV": str(self._folder / "venv"),
            },
        )
        asked_for = [json.loads(line) for line in calls.read_text().splitlines()]
        return done.stdout.splitlines()[-1], asked_for


def requirements(*files: str) -> list[str]:
    lines = [line for file in files for line in (REPO / file).read_text().splitlines()]
    return sorted(line.partition("==")[0].strip().lower() for line in lines if "==" in line)


CLIENT = requirements("python/requirements.txt")
OTHERS = requirements("python/requirements-dev.txt", "scripts/requirements.txt")
ITSELF = {"hashes": False, "editable": True, "names": []}


def asked(names: list[str]) -> dict[str, object]:
    return {"hashes": True, "editable": False, "names": names}


@pytest.fixture
def environment(tmp_path: Path) -> Environment:
    return Environment(tmp_path)


def test_a_robot_program_needs_no_more_than_the_client(environment: Environment) -> None:
    assert environment.make("client") == [asked(CLIENT), ITSELF]
    assert not set(CLIENT) & set(OTHERS)


def test_what_is_there_is_not_asked_for_again(environment: Environment) -> None:
    environment.make("client")
    assert environment.make("client") == []
    assert environment.make() == [asked(OTHERS)]
    assert environment.make() == []
    assert environment.make("client") == [], "all has it"


@pytest.mark.parametrize("name", ["thesis.tex", "pyvenv.cfg"])
def test_a_folder_of_somebody_else_is_not_emptied(
    name: str, environment: Environment, tmp_path: Path
) -> None:
    """Also an environment that its owner made for other work."""
    file = tmp_path / "venv" / name
    file.parent.mkdir()
    file.write_text("years of work")
    with pytest.raises(subprocess.CalledProcessError) as refused:
        environment.make("client")
    assert "has files that this script did not make" in refused.value.stderr
    assert file.read_text() == "years of work"


def test_an_environment_that_a_run_with_sudo_has_made_is_named_with_the_remedy(
    environment: Environment, tmp_path: Path, stranger: list[str]
) -> None:
    environment.make("client")
    (tmp_path / "venv" / "bin").chmod(0o555)
    environment.run(*stranger, REPO / "scripts" / "venv.sh", "client")  # as it is, it serves
    with pytest.raises(subprocess.CalledProcessError) as refused:
        environment.run(*stranger, REPO / "scripts" / "venv.sh")
    venv = tmp_path / "venv"
    remedy = f"sudo chown -R \"$USER\" '{venv}'"
    assert f"{venv}/bin belongs to another user: {remedy}\n" in refused.value.stderr


def test_one_that_was_interrupted_is_made_anew(environment: Environment, tmp_path: Path) -> None:
    environment.make("client")
    (tmp_path / "venv" / ".inputs").write_text("")
    (tmp_path / "venv" / "half").touch()
    assert environment.make("client") == [asked(CLIENT), ITSELF]
    assert not (tmp_path / "venv" / "half").exists()


def test_one_that_works_stays_until_another_one_does(
    environment: Environment, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The network may be away; and the owner may have added something."""
    environment.make("client")
    (tmp_path / "venv" / ".inputs").write_text("of before\n")
    added = tmp_path / "venv" / "added"
    added.write_text("by its owner")
    monkeypatch.setenv("OFFLINE", "yes")
    with pytest.raises(subprocess.CalledProcessError) as refused:
        environment.make("client")
    assert "anew: what it is made from has changed" in refused.value.stderr
    assert "is as it was before" in refused.value.stderr
    assert added.read_text() == "by its owner"
    assert (tmp_path / "venv" / "bin" / "python").exists()
    monkeypatch.delenv("OFFLINE")
    assert environment.make("client") == [asked(CLIENT), ITSELF]
    left = [path.name for path in (tmp_path / "venv").iterdir()]
    assert sorted(left) == [
        ".inputs",
        ".requirements",
        "bin",
        "pyvenv.cfg",
    ]


@pytest.mark.parametrize(("moved", "successor"), [(False, ""), (True, ""), (True, "half\n")])
def test_one_that_works_is_found_again_after_a_kill(
    moved: bool, successor: str, environment: Environment, tmp_path: Path
) -> None:
    """While it was moved away, while its successor was made, while more was added to that."""
    environment.make("client")
    venv = tmp_path / "venv"
    before = venv / ".before"
    before.mkdir()
    (venv / ".inputs").rename(before / ".inputs")
    (venv / ".inputs").write_text(successor)
    (venv / "bin").rename(before / "bin")
    if moved:
        (venv / "pyvenv.cfg").rename(before / "pyvenv.cfg")
        (before / ".moved").touch()
        (venv / "half").touch()
    assert environment.make("client") == []
    assert sorted(path.name for path in venv.iterdir() if path.name != ".requirements") == [
        ".inputs",
        "bin",
        "pyvenv.cfg",
    ]


def test_packages_of_the_caller_are_not_taken_for_installed_ones(
    environment: Environment, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A sourced ROS workspace names its packages so."""
    (tmp_path / "workspace").mkdir()
    (tmp_path / "workspace" / "pip.py").write_text("raise SystemExit('of the workspace')\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path / "workspace"))
    assert environment.make("client") == [asked(CLIENT), ITSELF]


def test_tests_and_tools_need_all(environment: Environment) -> None:
    assert environment.make() == [asked(CLIENT), ITSELF, asked(OTHERS)]


def test_a_pin_that_changes_makes_a_pinned_environment_anew(
    environment: Environment, tmp_path: Path
) -> None:
    pins = tmp_path / "requirements.txt"
    make = (REPO / "scripts" / "lib" / "pinned_venv", tmp_path / "tools", pins)
    for name in ("old", "new"):
        pins.write_text(f"{name}==1 --hash=sha256:0\n")
        assert environment.run(*make) == (str(tmp_path / "tools" / "bin"), [asked([name])])
        assert environment.run(*make) == (str(tmp_path / "tools" / "bin"), [])
