#!/usr/bin/python3
"""Runs a test runner that writes JUnit's XML; ends with "N passed, N failed, N skipped".

junit.py REPORT COMMAND...      the path REPORT is appended to the command
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

# ctest names every test twice, when all is well too.
DULL = re.compile(r"^ +Start +\d+: |^ *\d+/\d+ Test +#\d+: .* Passed +[\d.]+ sec$")


def run(command: list[str]) -> int:
    """Runs it, shows its output without the dull lines, and returns its exit status."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, errors="replace") as process:
        assert process.stdout is not None
        for line in process.stdout:
            if not DULL.match(line):
                print(line, end="", flush=True)
    return process.returncode


def label(case: ET.Element) -> str:
    # ctest writes its name twice
    names = dict.fromkeys(filter(None, (case.get("classname"), case.get("name"))))
    return "::".join(names)


def why(case: ET.Element, skipped: ET.Element | None) -> str | None:
    # ctest knows only that it was; GoogleTest has printed the reason
    printed = re.search(r": Skipped\n(.+)", case.findtext("system-out") or "")
    message = skipped.get("message") if skipped is not None else None
    return printed[1] if printed else message or case.get("status")


def write_costs(costs: str, report: Path) -> None:
    """For the table of the slowest tests: see costs.py."""
    with Path(costs).open("a") as file:
        for case in ET.parse(report).iter("testcase"):
            file.write(f"{case.get('time', 0)}\t{label(case)}\n")


def main(report: Path, command: list[str]) -> int:
    report.unlink(missing_ok=True)
    status = run([*command, str(report)])
    passed = failed = skipped = 0
    for case in ET.parse(report).iter("testcase") if report.exists() else ():
        if case.find("failure") is not None or case.find("error") is not None:
            failed += 1
            print(f"FAILED {label(case)}")
        elif (skip := case.find("skipped")) is not None or case.get("status") == "disabled":
            skipped += 1
            print(f"SKIPPED {label(case)}: {why(case, skip)}")
        else:
            passed += 1
    if (costs := os.environ.get("RC10_COSTS")) and report.exists():
        write_costs(costs, report)
    if status != 0 and failed == 0:
        failed = 1
        print(f"FAILED {Path(command[0]).name} ended with status {status}")
    if passed + failed + skipped == 0:
        failed = status = 1
        print(f"FAILED {Path(command[0]).name} ran no test")
    print(f"{passed} passed, {failed} failed, {skipped} skipped", flush=True)
    return status


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2:]))
