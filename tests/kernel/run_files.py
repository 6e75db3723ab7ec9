"""Runs each test file in a guest of its own, some at a time, and adds the results up."""

from __future__ import annotations

import argparse
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import TYPE_CHECKING

import summary

if TYPE_CHECKING:
    from types import FrameType

HERE = Path(__file__).resolve().parent
REPO = HERE.parent.parent

# A test file may ask for options of run-guest: "# run-guest: --timeout 900"
OPTIONS = re.compile(r"^# run-guest: (.*)$", re.MULTILINE)

# A file that records something may be run in two guests, whose records must be equal:
# "# run-twice: bus.log", a file in $RC10_SCRATCH with lines of "TIME_NS WHAT".
TWICE = re.compile(r"^# run-twice: (\S+)$", re.MULTILINE)

# In virtual time reading the clock takes 1 us, and the guest kernel's own tick, which follows the
# host's signals, reads it now and then between two frames: in 1 of some 7,000 lines.
STAMP_PLAY_NS = 1000

guests: list[subprocess.Popen[str]] = []
stopped: list[int] = []

# Records that a test file leaves in $RC10_SCRATCH/records.jsonl go to $RC10_RECORDS/<file>.jsonl.


def time_limit_s(file: Path) -> int:
    """Real time that a file asks for: the longer it runs, the more."""
    asked = re.search(r"^# run-guest: .*--timeout (\d+)", file.read_text(), re.MULTILINE)
    return int(asked[1]) if asked else 300


def run_file(file: Path, pytest_options: list[str]) -> summary.Counts:
    """Run a file's tests in a guest, or in two if it asks for that."""
    twice = TWICE.search(file.read_text())
    if twice is None:
        return run_guest(file, pytest_options, None)[0]
    first, record = run_guest(file, pytest_options, twice[1])
    second, other_record = run_guest(file, pytest_options, twice[1])
    difference = first_difference(record.splitlines(), other_record.splitlines())
    same = difference is None
    print(f"== {file.name}: {twice[1]} of two guests {difference or 'is the same'}")
    return summary.add([first, second, summary.Counts(passed=int(same), failed=int(not same))])


def first_difference(record: list[str], other: list[str]) -> str | None:
    for number, (line, other_line) in enumerate(zip(record, other, strict=False), start=1):
        stamp, what = line.split(" ", 1)
        other_stamp, other_what = other_line.split(" ", 1)
        if what != other_what or abs(int(stamp) - int(other_stamp)) > STAMP_PLAY_NS:
            return f"DIFFERS in line {number}: {line!r} and {other_line!r}"
    if not record or len(record) != len(other):
        return f"DIFFERS: {len(record)} and {len(other)} lines"
    return None


def run_guest(
    file: Path, pytest_options: list[str], record: str | None
) -> tuple[summary.Counts, str]:
    """Run a file's tests in a guest; returns what it left in `record`, too."""
    if stopped:
        return summary.Counts(), ""
    found = OPTIONS.search(file.read_text())
    start = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="rc10-kernel-") as scratch:
        report = Path(scratch, "report.xml")
        command: list[str | Path] = [HERE / "run-guest"]
        command += shlex.split(found[1] if found else "")
        command += ["--scratch", scratch, "--", os.environ["RC10_PYTHON"], "-m", "pytest"]
        command += ["-p", "no:cacheprovider", "-v", "--color=no", f"--junitxml={report}"]
        command += [*pytest_options, file.relative_to(REPO)]
        guest = subprocess.Popen(
            command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
        )
        guests.append(guest)
        output, _ = guest.communicate()
        counts = summary.count_file(file.stem, guest.returncode, report, bool(pytest_options))
        left = Path(scratch, record) if record else None
        recorded = left.read_text() if left and left.exists() else ""
        found_out = Path(scratch, "records.jsonl")
        if found_out.exists() and (folder := os.environ.get("RC10_RECORDS")):
            shutil.copy(found_out, Path(folder, f"{file.stem}.jsonl"))
    seconds = time.monotonic() - start
    print(f"== {file.name}: {counts} in {seconds:.0f} s\n{output}", flush=True)
    if costs := os.environ.get("RC10_COSTS"):
        with Path(costs).open("a") as lines:
            lines.write(f"{seconds:.2f}\t{file.name}, a guest\n")
    return counts, recorded


def stop(number: int, _frame: FrameType | None) -> None:
    stopped.append(number)
    for guest in guests:
        if guest.poll() is None:
            guest.terminate()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    processors = len(os.sched_getaffinity(0))
    parser.add_argument("--jobs", type=int, default=int(os.environ.get("RC10_JOBS") or processors))
    parser.add_argument("files", nargs="*", type=Path)
    # Arguments after "--" are pytest's.
    end = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
    arguments = parser.parse_args(sys.argv[1:end])
    files = [file.resolve() for file in arguments.files] or sorted(HERE.glob("test_*.py"))
    # A long file that starts last would run alone.
    files.sort(key=time_limit_s, reverse=True)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    with ThreadPoolExecutor(arguments.jobs) as pool:
        counts = list(pool.map(lambda file: run_file(file, sys.argv[end + 1 :]), files))
    status = summary.finish(counts)
    return 128 + stopped[0] if stopped else status


if __name__ == "__main__":
    sys.exit(main())
