#!/usr/bin/python3
"""Runs a test runner that writes JUnit's XML; ends with "N passed, N failed, N skipped".

junit.py REPORT COMMAND...            the path REPORT is appended to the command
junit.py --folder FOLDER COMMAND...   the command's programs write their reports to this folder,
                                      each NAME.xml, and NAME.unfinished until its end;
                                      FOLDER.names has the names, of which
                                      --only PROGRAM and --but PROGRAM choose
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator
from pathlib import Path

# ctest names every test twice, when all is well too.
DULL = re.compile(r"^ +Start +\d+: |^ *\d+/\d+ Test +#\d+: .* Passed +[\d.]+ sec$")
BEGUN = re.compile(r"^\[ RUN      \] ")
PASSED = re.compile(r"^\[       OK \] ")


def telling(lines: Iterable[str]) -> Iterator[str]:
    """Without tests that passed and printed nothing: of GoogleTest two lines each."""
    begun = ""
    for line in lines:
        if DULL.match(line) or (begun and PASSED.match(line)):
            begun = ""
            continue
        yield begun
        begun = line if BEGUN.match(line) else ""
        if not begun:
            yield line
    yield begun


def run(command: list[str]) -> int:
    """Runs it, shows the lines that tell something, and returns its exit status."""
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, errors="replace") as process:
        assert process.stdout is not None
        for line in telling(process.stdout):
            print(line, end="", flush=True)
    return process.returncode


def label(case: ET.Element) -> str:
    return "::".join(filter(None, (case.get("classname"), case.get("name"))))


def why(case: ET.Element, skipped: ET.Element | None) -> str | None:
    # GoogleTest writes the place and the reason in two lines
    message = skipped.get("message") if skipped is not None else None
    return message.strip().splitlines()[-1] if message else case.get("status")


def write_costs(costs: str, cases: list[ET.Element]) -> None:
    """For the table of the slowest tests: see costs.py."""
    with Path(costs).open("a") as file:
        for case in cases:
            file.write(f"{case.get('time', 0)}\t{label(case)}\n")


def run_to(report: Path, command: list[str]) -> tuple[int, list[ET.Element]]:
    """Exit status and cases of a command that takes the path of its report."""
    report.unlink(missing_ok=True)
    status = run([*command, str(report)])
    return status, list(ET.parse(report).iter("testcase")) if report.exists() else []


def failure(name: str) -> ET.Element:
    case = ET.Element("testcase", name=name)
    ET.SubElement(case, "failure")
    return case


def cases_of(report: Path) -> list[ET.Element]:
    """Those of GoogleTest that were run or are switched off; a list of tests is no report."""
    cases = list(ET.parse(report).iter("testcase")) if report.exists() else []
    return [case for case in cases if case.get("status") in ("run", "notrun")]


def chosen(names: list[str], command: list[str]) -> tuple[list[str], list[str]]:
    """Names of the programs that --only or --but leaves, and the command without it."""
    if command[0] not in ("--only", "--but"):
        return names, command
    choice, program, *command = command
    return [
        name for name in names if (program_of(name) == program) == (choice == "--only")
    ], command


def program_of(name: str) -> str:
    """Program of a shard."""
    return name.partition(".")[0]


def run_in(folder: Path, command: list[str]) -> tuple[int, list[ET.Element]]:
    """Exit status and cases of a command whose programs write their reports to this folder.

    Each does so in shards, PROGRAM.0, PROGRAM.1 and so on, of which some may have no test.
    """
    names, command = chosen(folder.with_suffix(".names").read_text().split(), command)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    status = run(command)
    cases, empty = [], {program_of(name) for name in names}
    for name in names:
        of_shard = cases_of(folder / f"{name}.xml")
        cases += of_shard
        if of_shard:
            empty.discard(program_of(name))
        if (folder / f"{name}.unfinished").exists():
            cases.append(failure(f"{name}, which ended amidst its tests"))
        elif not (folder / f"{name}.xml").exists():
            cases.append(failure(f"{name}, which left no report"))
    return status, cases + [failure(f"{program}, which has no test") for program in sorted(empty)]


def tell(status: int, cases: list[ET.Element], command: list[str]) -> int:
    """Tells of each case that did not pass, and the counts; returns the status of this program."""
    passed = failed = skipped = 0
    for case in cases:
        if case.find("failure") is not None or case.find("error") is not None:
            failed += 1
            print(f"FAILED {label(case)}")
        elif (skip := case.find("skipped")) is not None or case.get("status") == "notrun":
            skipped += 1
            print(f"SKIPPED {label(case)}: {why(case, skip)}")
        else:
            passed += 1
    if status == 0 and failed:
        status = 1
    if costs := os.environ.get("RC10_COSTS"):
        write_costs(costs, cases)
    if status != 0 and failed == 0:
        failed = 1
        print(f"FAILED {Path(command[0]).name} ended with status {status}")
    if passed + failed + skipped == 0:
        failed = status = 1
        print(f"FAILED {Path(command[0]).name} ran no test")
    print(f"{passed} passed, {failed} failed, {skipped} skipped", flush=True)
    return status


def main(words: list[str]) -> int:
    in_folder = words[0] == "--folder"
    place, *command = words[1:] if in_folder else words
    status, cases = (run_in if in_folder else run_to)(Path(place), command)
    return tell(status, cases, command)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
