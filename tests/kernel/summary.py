"""Adds up pytest's reports; the last line it prints is "N passed, N failed, N skipped".

As a program: summary.py NAME STATUS REPORT, for one report and pytest's exit status.
"""

from __future__ import annotations

import os
import sys
import xml.etree.ElementTree as ET
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable


class Counts(NamedTuple):
    passed: int = 0
    failed: int = 0
    skipped: int = 0

    def __str__(self) -> str:
        return f"{self.passed} passed, {self.failed} failed, {self.skipped} skipped"


def count_file(name: str, status: int, report: Path, some: bool = False) -> Counts:
    """The counts of one guest; one that died without a report is one failure.

    some: it was told which tests of the file to run, and may have found none.
    """
    counts = Counts()
    if report.exists():
        for suite in ET.parse(report).iter("testsuite"):
            tests, failures, errors, skipped = (
                int(suite.get(key, 0)) for key in ("tests", "failures", "errors", "skipped")
            )
            failed = failures + errors
            counts = Counts(tests - failed - skipped, failed, skipped)
        for case in ET.parse(report).iter("testcase"):
            if (reason := case.find("skipped")) is not None:
                print(f"SKIPPED {name}: {case.get('name')}: {reason.get('message')}")
    # 5: no test, as where pytest was told to leave every one of this file out
    died = status not in ((0, 5) if some else (0,)) or not report.exists()
    if died and counts.failed == 0:
        print(f"FAILED {name}: the guest returned {status}, report: {report.exists()}")
        counts = counts._replace(failed=1)
    return counts


def add(counts: Iterable[Counts]) -> Counts:
    return Counts(*(sum(column) for column in zip(Counts(), *counts, strict=True)))


def finish(files: Iterable[Counts]) -> int:
    """Print the last line and return the exit status of the test part."""
    total = add(files)
    bad = total.failed > 0 or total.passed == 0
    if total.skipped > 0 and os.environ.get("CI") == "true":
        print("in CI nothing may be skipped")
        bad = True
    print(total)
    return int(bad)


if __name__ == "__main__":
    sys.exit(finish([count_file(sys.argv[1], int(sys.argv[2]), Path(sys.argv[3]))]))
