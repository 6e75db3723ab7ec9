"""scripts/lib/junit.py: results of test runners from their reports."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import junit
import pytest

REPO = Path(__file__).resolve().parents[2]

# As googletest writes it, with a report for the shard of a program.
CASES = """<testsuites><testsuite name="Wheel">
<testcase name="Turns" classname="Wheel" status="run" result="completed" time="0.25"/>
<testcase name="Stops" classname="Wheel" status="run" result="completed" time="0.01">
<failure message="x"/></testcase>
<testcase name="Waits" classname="Wheel" status="run" result="skipped" time="0">
<skipped message="wheel_test.cpp:7&#x0A;no wheel here&#x0A;"/></testcase>
<testcase name="Slips" classname="Wheel" status="notrun" result="suppressed" time="0"/>
</testsuite></testsuites>"""


def runner(folder: Path, does: str) -> Path:
    program = folder / "runner"
    program.write_text(f"#!/bin/sh\n{does}\n")
    program.chmod(0o755)
    return program


def tell(*words: object, costs: Path | None = None) -> tuple[int, list[str]]:
    done = subprocess.run(
        [REPO / "scripts" / "lib" / "junit.py", *map(str, words)],
        env={**os.environ, "RC10_COSTS": str(costs or os.devnull)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.stderr == ""
    return done.returncode, done.stdout.splitlines()


def reports_of(folder: Path, *names: str) -> Path:
    """Folder for the reports of these shards."""
    (folder / "reports.names").write_text("\n".join(names))
    return folder / "reports"


def test_reports_of_all_shards_are_counted(tmp_path: Path) -> None:
    reports = reports_of(tmp_path, "a", "b")
    (tmp_path / "report").write_text(CASES)
    copies = "".join(f"cp '{tmp_path}/report' '{reports}/{name}.xml'; " for name in "ab")
    costs = tmp_path / "costs"
    status, said = tell("--folder", reports, runner(tmp_path, f"{copies} exit 8"), costs=costs)
    assert status == 8
    assert said[-1] == "2 passed, 2 failed, 4 skipped"
    assert said.count("FAILED Wheel::Stops") == 2
    assert "SKIPPED Wheel::Waits: no wheel here" in said
    assert "SKIPPED Wheel::Slips: notrun" in said
    assert costs.read_text().splitlines()[0] == "0.25\tWheel::Turns"


def test_reports_of_an_earlier_run_do_not_count(tmp_path: Path) -> None:
    reports = reports_of(tmp_path, "a.0")
    reports.mkdir()
    (reports / "a.0.xml").write_text(CASES)
    status, said = tell("--folder", reports, runner(tmp_path, "exit 0"))
    assert status == 1
    assert "FAILED a.0, which left no report" in said
    assert said[-1] == "0 passed, 2 failed, 0 skipped"


@pytest.mark.parametrize(
    ("choice", "program", "missing"),
    [("--only", "a", False), ("--but", "b", False), ("--but", "a", True)],
)
def test_of_the_programs_those_that_are_chosen_have_to_report(
    choice: str, program: str, missing: bool, tmp_path: Path
) -> None:
    reports = reports_of(tmp_path, "a.0", "b.0")
    (tmp_path / "report").write_text(CASES.replace("<failure", "<properties"))
    does = runner(tmp_path, f"cp '{tmp_path}/report' '{reports}/a.0.xml'")
    status, said = tell("--folder", reports, choice, program, does)
    assert (status == 1) == missing
    assert ("FAILED b.0, which left no report" in said) == missing


def test_a_shard_without_a_report_has_failed(tmp_path: Path) -> None:
    """As where a program ends with status 0 before its tests begin."""
    reports = reports_of(tmp_path, "a.0", "a.1")
    (tmp_path / "report").write_text(CASES.replace("<failure", "<properties"))
    does = f"cp '{tmp_path}/report' '{reports}/a.0.xml'"
    status, said = tell("--folder", reports, runner(tmp_path, does))
    assert status == 1
    assert "FAILED a.1, which left no report" in said


def test_a_shard_may_be_empty_and_a_program_may_not(tmp_path: Path) -> None:
    reports = reports_of(tmp_path, "a.0", "a.1", "b.0", "b.1")
    (tmp_path / "report").write_text(CASES.replace("<failure", "<properties"))
    (tmp_path / "none").write_text("<testsuites/>")
    empty = "".join(f"cp '{tmp_path}/none' '{reports}/{n}.xml'; " for n in ("a.1", "b.0", "b.1"))
    does = f"{empty} cp '{tmp_path}/report' '{reports}/a.0.xml'"
    status, said = tell("--folder", reports, runner(tmp_path, does))
    assert status == 1
    assert [line for line in said if "FAILED" in line] == ["FAILED b, which has no test"]


def test_a_list_of_tests_is_no_report(tmp_path: Path) -> None:
    """GTEST_LIST_TESTS writes one, without a status."""
    reports = reports_of(tmp_path, "a.0")
    listed = re.sub(
        ' status="[a-z]+" result="[a-z]+"', "", CASES.replace("<failure", "<properties")
    )
    (tmp_path / "report").write_text(listed)
    status, _ = tell(
        "--folder", reports, runner(tmp_path, f"cp '{tmp_path}/report' '{reports}/a.0.xml'")
    )
    assert status == 1


def test_a_program_that_ends_amidst_its_tests_has_failed_whatever_its_status(
    tmp_path: Path,
) -> None:
    reports = reports_of(tmp_path, "a", "b.2", "b.1")
    (tmp_path / "report").write_text(CASES.replace("<failure", "<properties"))
    copies = "".join(f"cp '{tmp_path}/report' '{reports}/{name}.xml'; " for name in ("a", "b.1"))
    does = f"{copies} touch '{reports}/b.2.unfinished'"
    _, said = tell("--folder", reports, runner(tmp_path, does))
    assert "FAILED b.2, which ended amidst its tests" in said
    assert said[-1] == "4 passed, 1 failed, 4 skipped"


def test_a_status_without_a_failure_is_a_failure(tmp_path: Path) -> None:
    (tmp_path / "report").write_text(CASES.replace("<failure", "<properties"))
    does = f"cp '{tmp_path}/report' \"$1\"; exit 139"
    status, said = tell(tmp_path / "to.xml", runner(tmp_path, does))
    assert status == 139
    assert "FAILED runner ended with status 139" in said


def test_a_test_that_passed_in_silence_is_not_shown() -> None:
    begun, passed = "[ RUN      ] A.B\n", "[       OK ] A.B (0 ms)\n"
    ctest = ["      Start  1: a.0\n", " 1/80 Test  #1: a.0 ....... Passed    0.10 sec\n"]
    failed = [begun, "a.cpp:3: Failure\n", "[  FAILED  ] A.B (0 ms)\n"]
    warned = [begun, "a warning\n", passed]
    shown = junit.telling([*ctest, begun, passed, *failed, begun, passed, *warned, begun])
    assert list(filter(None, shown)) == [*failed, *warned, begun]
