"""Parts and sets of scripts/test.sh: one list in the scripts, the budget and CONTRIBUTING.md."""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path

import pytest
import run_parts

REPO = Path(__file__).resolve().parents[2]
PARTS = REPO / "scripts" / "test"
SETS = ("default", "ci", "all", "nightly")
PAGE = (REPO / "CONTRIBUTING.md").read_text()


def output_of(*words: str) -> str:
    return subprocess.run(
        [REPO / "scripts" / words[0], *words[1:]], capture_output=True, text=True, check=True
    ).stdout


# Lines of the help: a part with its description, a set with its parts.
HELP = dict(re.findall(r"^  (\w+) +(.*)$", output_of("test.sh", "--help"), re.MULTILINE))
SET = {name: HELP[name].split() for name in SETS}
NAMES = sorted(HELP.keys() - set(SETS))


def text_of(part: str) -> str:
    """Script of a part, with that of the part it ends as."""
    text = (PARTS / f"{part}.sh").read_text()
    ends_as = re.search(r'exec .*/(\w+)\.sh"$', text)
    return text + text_of(ends_as[1]) if ends_as else text


def first_column(title: str) -> set[str]:
    """Names in the first cells of the table whose first title this is."""
    table = re.search(rf"^\| {title} \|.*\n\|[-|]+\n((?:\|.*\n)+)", PAGE, re.MULTILINE)
    assert table is not None
    cells = [row.split("|")[1] for row in table[1].splitlines()]
    return {name for cell in cells for name in re.findall(r"`(\w+)`", cell)}


def test_each_part_is_a_script_and_each_script_a_part() -> None:
    assert sorted(script.stem for script in PARTS.glob("*.sh")) == NAMES


@pytest.mark.parametrize("part", NAMES)
def test_a_part_says_what_packages_it_needs(part: str) -> None:
    """Without a word of it, scripts/install-deps.sh installs all."""
    needs = re.findall(r"^need (.+)$", (PARTS / f"{part}.sh").read_text(), re.MULTILINE)
    assert len(needs) == 1
    assert output_of("install-deps.sh", "--list", *needs[0].split())


@pytest.mark.parametrize("part", NAMES)
def test_a_part_ends_with_its_counts(part: str) -> None:
    """Without them those of its last suite would be taken for its own."""
    assert text_of(part).rstrip().endswith("finish")


def test_a_part_needs_what_the_part_does_that_it_ends_as() -> None:
    for part in NAMES:
        needs = set(re.findall(r"^need (.+)$", text_of(part), re.MULTILINE))
        assert len(needs) == 1, part


def test_parts_of_a_merge_wait_for_the_dev_build_if_they_use_it() -> None:
    """Those of nightly, which are run alone, build no more than they use."""
    users = {part for part in NAMES if re.search(r"must_build dev\b", text_of(part))}
    assert users - set(SET["nightly"]) - {"build"} == run_parts.TESTS_OF_DEV


def test_the_cores_are_those_of_parts() -> None:
    assert run_parts.CORES.keys() <= set(NAMES)


def test_each_part_of_a_merge_has_a_budget() -> None:
    budget = json.loads(run_parts.BUDGET.read_text())
    assert budget["parts"].keys() == set(NAMES) - set(SET["nightly"])
    assert budget["sets"].keys() <= set(SETS)


def test_the_page_has_each_part_and_each_set() -> None:
    assert first_column("part") == set(NAMES)
    assert first_column("set") == set(SETS)


def test_the_page_says_which_parts_a_set_has() -> None:
    rows = dict(re.findall(r"^\| `(\w+)` \| (.*?) \|", PAGE, re.MULTILINE))
    for name in ("default", "ci", "nightly"):
        named = [word for word in re.findall(r"`(\w+)`", rows[name]) if word in HELP]
        parts = [part for word in named for part in SET.get(word, [word])]
        assert sorted(parts) == sorted(SET[name]), name
    assert rows["all"].startswith("all but `tidy` and those of `nightly`")
    assert set(SET["all"]) == set(NAMES) - set(SET["nightly"]) - {"build", "tidy"}


def test_a_fresh_debian_for_an_unknown_thing_is_refused() -> None:
    done = subprocess.run(
        [PARTS / "fresh.sh"],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "RC10_FRESH": "page"},
    )
    assert done.returncode == 1
    assert "no RC10_FRESH=page: demo, default, ci, all or pages" in done.stdout
    assert done.stdout.splitlines()[-1] == "0 passed, 1 failed, 0 skipped"


@pytest.mark.parametrize(
    ("words", "name"),
    [((), "default"), (("all",), "all"), (("lint",), "lint"), (("default", "soak"), "")],
)
def test_a_run_of_several_words_has_no_name(
    words: tuple[str, ...], name: str, tmp_path: Path
) -> None:
    """Times and costs of a set are not those of the set with other parts."""
    lib = tmp_path / "scripts" / "lib"
    lib.mkdir(parents=True)
    for source in (REPO / "scripts" / "lib").glob("*.sh"):
        (lib / source.name).write_text(source.read_text())
    (tmp_path / "scripts" / "test").symlink_to(PARTS)
    (lib / "run_parts.py").write_text("import sys\nprint(*sys.argv[1:3], sep='|')\n")
    for script in ("install-deps.sh", "test.sh"):
        copy = tmp_path / "scripts" / script
        source = REPO / "scripts" / script
        copy.write_text("#!/bin/sh\n" if script == "install-deps.sh" else source.read_text())
        copy.chmod(0o755)
    done = subprocess.run(
        [tmp_path / "scripts" / "test.sh", *words], capture_output=True, text=True, check=True
    )
    assert done.stdout.splitlines()[-1] == f"--name|{name}"


@pytest.mark.parametrize("name", ["default", "ci", "all"])
def test_the_table_of_sets_quotes_the_budget(name: str) -> None:
    budget = json.loads((PARTS / "budget.json").read_text())
    cpu_s = sum(budget["parts"][part]["cpu_s"] for part in ["build", *SET[name]])
    cold_min, warm_min = (round(seconds / 60) for seconds in budget["sets"][name].values())
    (row,) = re.findall(rf"^\| `{name}` \|.*$", PAGE, re.MULTILINE)
    assert row.endswith(f"| {cold_min} ({cpu_s:,} CPU-seconds) | {warm_min} |")


@pytest.mark.parametrize(
    ("page", "words"),
    [
        ("README.md", " {} minutes the first time"),
        ("README.zh-CN.md", "第一次 {} 分钟"),
        ("docs/quick-start.md", " {} minutes as long as nothing has been compiled"),
        ("docs/quick-start.zh-CN.md", "在什么都没编译过时要 {} 分钟"),
    ],
)
def test_a_newcomers_page_quotes_the_budget(page: str, words: str) -> None:
    budget = json.loads((PARTS / "budget.json").read_text())
    cold_min = round(budget["sets"]["default"]["cold_s"] / 60)
    assert words.format(cold_min) in (REPO / page).read_text()
