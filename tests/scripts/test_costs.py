"""The slowest tests and files are read from what their makers write down."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from costs import SLOWEST, Budget, compiled_files, measured_tests, pace, slowest

if TYPE_CHECKING:
    from pathlib import Path

BEGIN_S = 1_000.0
LOG = """# ninja log v5
0\t2500\t1001000000000\tsrc/app/new.cpp.o\t1a
0\t9000\t999000000000\tsrc/app/before_this_run.cpp.o\t1b
0\t8000\t1002000000000\tbin/rc10d\t1c
10\t30
"""


@pytest.fixture
def builds(tmp_path: Path) -> Path:
    (tmp_path / "dev").mkdir()
    (tmp_path / "dev" / ".ninja_log").write_text(LOG)
    return tmp_path


def test_a_file_counts_if_this_run_has_compiled_it(builds: Path) -> None:
    assert compiled_files(builds, BEGIN_S) == [(2.5, "dev/src/app/new.cpp.o")]


def test_a_file_that_was_compiled_twice_counts_as_the_last_time(builds: Path) -> None:
    log = builds / "dev" / ".ninja_log"
    log.write_text(LOG + "0\t700\t1003000000000\tsrc/app/new.cpp.o\t1a\n")
    assert compiled_files(builds, BEGIN_S) == [(0.7, "dev/src/app/new.cpp.o")]


def test_a_test_is_named_with_its_part(tmp_path: Path) -> None:
    (tmp_path / "host.costs").write_text("1.5\ttest_a: b\nnonsense\n12\ttest_c\n")
    assert measured_tests(tmp_path) == [(1.5, "host: test_a: b"), (12.0, "host: test_c")]


def test_the_slowest_come_first_and_the_others_not_at_all(tmp_path: Path, builds: Path) -> None:
    lines = [f"{number}\ttest_{number}\n" for number in range(1, SLOWEST + 3)]
    (tmp_path / "host.costs").write_text("".join(lines))
    tests, files = slowest(tmp_path, builds, BEGIN_S).strip().split("\n\n")
    title, *rows = tests.splitlines()
    assert title == "slowest tests"
    assert [row.split()[-1] for row in rows] == [f"test_{n}" for n in range(SLOWEST + 2, 2, -1)]
    assert files.splitlines() == ["slowest files", "     2.5 s  dev/src/app/new.cpp.o"]


def test_one_slow_compilation_does_not_make_a_slow_machine(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    budget = Budget("2 cores", 2.0, {}, {})
    compilations = iter((2.4, 9.0, 2.2))
    monkeypatch.setattr("costs.reference_cpu_s", lambda: next(compilations))
    assert pace(budget) == pytest.approx(1.2)


def test_where_nothing_was_measured_nothing_is_said(tmp_path: Path) -> None:
    assert slowest(tmp_path, tmp_path, BEGIN_S) == ""


@pytest.mark.parametrize("cost", ["0", "NaN", "-3"])
def test_a_budget_is_a_number_above_zero(tmp_path: Path, cost: str) -> None:
    file = tmp_path / "budget.json"
    part = f'{{"unit": {{"took_s": 1, "cpu_s": {cost}}}}}'
    file.write_text(f'{{"machine": "m", "reference_cpu_s": 3, "sets": {{}}, "parts": {part}}}')
    with pytest.raises(ValueError, match="a cost is a number above 0"):
        Budget.read(file)
