"""rc10d's command line: what it prints and how it ends, without running a robot."""

from __future__ import annotations

import json
import re
import subprocess
from pathlib import Path

import pytest
from hostlib.daemon import BIN, REPO

EXAMPLES = sorted(REPO.glob("config/*.yaml"))

THREE_MISTAKES = """
robot: host
buses:
  - name: chassis
    type: sim
    motors:
      - {name: wheel, model: M3508, id: 9}
      - {name: other, model: M3509, id: 2}
      - {name: third, model: M3508, id: 3, curent_limit_a: 5}
"""


def rc10d(*words: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [BIN / "rc10d", *words], capture_output=True, text=True, timeout=60, check=False
    )


def test_the_version_is_printed() -> None:
    done = rc10d("--version")
    assert done.returncode == 0
    assert re.fullmatch(r"rc10d \d+\.\d+\.\d+\n", done.stdout)


def test_help_explains_the_exit_status() -> None:
    done = rc10d("--help")
    assert done.returncode == 0
    assert "Exit status" in done.stdout


def test_schema_is_that_of_the_examples() -> None:
    done = rc10d("--schema")
    assert done.returncode == 0
    schema = json.loads(done.stdout)
    assert "robot" in schema["$defs"]["robot"]["properties"]
    assert schema == json.loads((REPO / "config" / "rc10d.schema.json").read_text())


@pytest.mark.parametrize("config", EXAMPLES, ids=lambda path: path.name)
def test_every_example_is_good(config: Path) -> None:
    done = rc10d("--check", config)
    assert done.returncode == 0, done.stderr
    assert "error" not in done.stderr
    assert re.match(rf"robot +{config.stem}\b", done.stdout)


def test_there_are_examples() -> None:
    assert EXAMPLES


@pytest.mark.parametrize("option", ["--check", "-c"])
def test_a_bad_configuration_is_refused_with_all_its_errors(tmp_path: Path, option: str) -> None:
    config = tmp_path / "bad.yaml"
    config.write_text(THREE_MISTAKES)
    done = rc10d(option, config)
    assert done.returncode == 2
    for line, word in ((7, "id"), (8, "M3509"), (9, "curent_limit_a")):
        # file, line, column, and what is wrong there
        assert re.search(rf"{config}:{line}:\d+: .*{word}", done.stderr), done.stderr


def test_rc10ctl_says_the_same_with_the_exit_status_of_its_own_table(tmp_path: Path) -> None:
    # 2 is "do not start it again" to the service; to rc10ctl it is wrong usage, and 1 a wrong file.
    config = tmp_path / "bad.yaml"
    config.write_text(THREE_MISTAKES)

    def check(*words: str | Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [BIN / "rc10ctl", "check", *words], capture_output=True, text=True, check=False
        )

    done = check(config)
    assert done.returncode == 1
    assert done.stderr == rc10d("--check", config).stderr
    assert check().returncode == 2
    assert check(EXAMPLES[0]).returncode == 0


def test_a_missing_configuration_is_named(tmp_path: Path) -> None:
    done = rc10d("-c", tmp_path / "none.yaml")
    assert done.returncode == 2
    assert "none.yaml" in done.stderr


@pytest.mark.parametrize("words", [[], ["--no-such-option"], ["--check"]])
def test_bad_usage_ends_with_status_2(words: list[str]) -> None:
    done = rc10d(*words)
    assert done.returncode == 2
    assert done.stderr


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--chekc"], "there is no option '--chekc'; did you mean --check?"),
        (["check", EXAMPLES[0]], "there is no verb 'check'; did you mean --check?"),
        ([EXAMPLES[0]], "; -c FILE runs a robot, --check FILE checks one"),
    ],
)
def test_the_option_that_was_meant_is_told(words: list[str | Path], told: str) -> None:
    done = rc10d(*words)
    assert done.returncode == 2
    assert told in done.stderr


def test_the_guard_tells_the_option_that_was_meant() -> None:
    done = subprocess.run(
        [BIN / "rc10-guard", "--until-unusd"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert "did you mean --until-unused?" in done.stderr
