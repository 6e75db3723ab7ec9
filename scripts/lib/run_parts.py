#!/usr/bin/python3
"""Runs parts of the tests, side by side where one leaves cores free, and tells what they cost.

    run_parts.py [--name SET] PART...

A part is scripts/test/PART.sh; its last line is "N passed, N failed, N skipped", and so is that of
this program. What a part prints is shown if something of it failed, and kept in build/test-logs.
Python of Debian 12 alone, for nothing else is installed yet.
"""

from __future__ import annotations

import argparse
import contextlib
import fcntl
import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path

import costs
from descendants import descendants, end_descendants, keep_orphans, reap_orphans

REPO = Path(__file__).resolve().parents[2]
SCRIPTS = REPO / "scripts" / "test"
LOGS = REPO / "build" / "test-logs"
BUDGET = SCRIPTS / "budget.json"

COUNTS = re.compile(r"^(\d+) passed, (\d+) failed, (\d+) skipped$")
TOLD = re.compile(r"^(SKIPPED|NOTE) .*", re.MULTILINE)

# These run what the dev build has made.
TESTS_OF_DEV = {"unit", "kernel", "host", "faults", "vm", "soak", "web", "benchmarks"}
# Cores that a part keeps busy; 0: it waits most of its time. All others use every core.
# `web` waits for a browser most of its time; `pages` is short, and needs no build.
CORES = {"host": 0, "web": 0, "pages": 0, "lint": 1, "vm": 1, "package": 1}
JOBS = os.environ.get("RC10_JOBS", "")
ALL_CORES = min(
    len(os.sched_getaffinity(0)), int(JOBS) if re.fullmatch("[1-9][0-9]*", JOBS) else 1024
)
# Another build tree; filters of test runners, which would leave tests out without a word; folders
# and network of a robot; the repository that git names to a hook, which outranks any -C.
THE_CALLERS = re.compile(
    "(RC10_BUILD|RC10_RUN_DIR|RC10_STATE_DIR|LCM_DEFAULT_URL)$|GTEST_|TESTBRIDGE_|PYTEST_|CTEST_"
    "|GIT_(DIR|WORK_TREE|INDEX_FILE|COMMON_DIR|OBJECT_DIRECTORY|PREFIX)$"
)
ENDS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


@dataclass
class Part:
    """A part while it runs, and what came of it."""

    name: str
    passed: int = 0
    failed: int = 0
    skipped: int = 0
    begin_s: float = 0.0
    took_s: float = 0.0
    cpu_s: float = 0.0
    # Verdict of this program; empty: the part has told its failures itself.
    complaint: str = ""
    left_running: list[str] = field(default_factory=list)
    process: subprocess.Popen[bytes] | None = field(default=None, repr=False)

    @property
    def cores(self) -> int:
        return min(CORES.get(self.name, ALL_CORES), ALL_CORES)

    @property
    def log(self) -> Path:
        return LOGS / f"{self.name}.log"

    @property
    def about(self) -> str:
        return (SCRIPTS / f"{self.name}.sh").read_text().splitlines()[1].removeprefix("# ")

    def start(self, wanted: list[str]) -> None:
        """Starts it as one of the parts that are wanted."""
        self.begin_s = time.monotonic()
        environment = {
            **{key: value for key, value in os.environ.items() if not THE_CALLERS.match(key)},
            "RC10_COSTS": str(LOGS / f"{self.name}.costs"),
            "RC10_JOBS": str(max(self.cores, 1)),
            "RC10_PARTS": " ".join(wanted),
        }
        # Priority over parts that compute: a part that waits is woken in time.
        politely = ["nice", "-n", "5"] if self.cores else []
        with self.log.open("wb") as log:
            self.process = subprocess.Popen(
                [*politely, SCRIPTS / f"{self.name}.sh"],
                cwd=REPO,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=subprocess.STDOUT,
                process_group=0,
            )

    def reap(self) -> bool:
        """Status and costs of a part that has ended, and end of its group; False while it runs."""
        assert self.process is not None
        pid, status, usage = os.wait4(self.process.pid, os.WNOHANG)
        if pid == 0:
            return False
        self.process.returncode = os.waitstatus_to_exitcode(status)
        self.took_s = time.monotonic() - self.begin_s
        self.cpu_s = usage.ru_utime + usage.ru_stime
        self.left_running = names_in_group(self.process.pid)
        end_group(self.process)
        return True

    def judge(self) -> None:
        """Reads the counts in the last line, and complains of an end that contradicts them."""
        assert self.process is not None
        status = self.process.returncode
        lines = self.log.read_text(errors="replace").splitlines()
        counts = COUNTS.match(lines[-1] if lines else "")
        if counts is None:
            self.complaint = f"it ended with status {status} and without a result"
        else:
            self.passed, self.failed, self.skipped = map(int, counts.groups())
            if self.failed == 0 and (status != 0 or self.passed + self.skipped == 0):
                self.complaint = f"it ended with status {status}, {counts[0]}"
        if self.complaint:
            self.failed = 1

    def show(self) -> None:
        text = self.log.read_text(errors="replace")
        print(f"\n==== {self.name}: {self.about}")
        if self.failed:
            print(text, end="" if text.endswith("\n") else "\n")
            if self.complaint:
                print(f"FAILED {self.name}: {self.complaint}")
        else:
            for told in TOLD.finditer(text):
                print(told[0])
            print(f"{self.passed} passed, {self.failed} failed, {self.skipped} skipped")
        if self.left_running:
            print(f"NOTE {self.name} left processes running: {', '.join(self.left_running)}")
        sys.stdout.flush()


def names_in_group(group: int) -> list[str]:
    """Processes of a group that still run; a zombie waits for its parent only."""
    names = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):  # ended
            head, _, rest = stat.read_text(errors="replace").rpartition(")")
            state, _, of = rest.split()[:3]
            if int(of) == group and state not in "ZX":
                names.append(head.partition("(")[2])
    return sorted(names)


def names_of_descendants() -> list[str]:
    """Processes that parts have left in sessions of their own."""
    names = []
    for pid, process in descendants().items():
        with contextlib.suppress(OSError):  # ended
            if process.state not in "ZX":
                names.append(Path(f"/proc/{pid}/comm").read_text(errors="replace").strip())
    return sorted(names)


def end_group(process: subprocess.Popen[bytes]) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGTERM)


def as_minutes(seconds: float) -> str:
    return f"{int(seconds) // 60}:{int(seconds) % 60:02}"


class Run:
    """All the parts of one run."""

    def __init__(self, names: list[str], budget: costs.Budget) -> None:
        self.budget = budget
        self.names = list(dict.fromkeys(names))
        self.waiting = [Part(name) for name in self.names]
        self.running: list[Part] = []
        self.done: list[Part] = []
        self.begin_s = time.monotonic()

    def may_start(self, part: Part) -> bool:
        unfinished = [*self.running, *self.waiting]
        if part.name in TESTS_OF_DEV and any(other.name == "build" for other in unfinished):
            return False
        # Two parts that wait, at their priority, would take a core from all others.
        if part.cores == 0 and any(other.cores == 0 for other in self.running):
            return False
        return sum(other.cores for other in self.running) + part.cores <= ALL_CORES

    def start_what_may(self) -> None:
        for part in list(self.waiting):
            if self.may_start(part):
                self.waiting.remove(part)
                self.running.append(part)
                part.start(self.names)

    def status_line(self) -> str:
        shown = []
        for part in self.running:
            elapsed = as_minutes(time.monotonic() - part.begin_s)
            whole = self.budget.parts.get(part.name)
            shown.append(
                part.name
                + f" {elapsed}"
                + (f" of about {as_minutes(whole.took_s)}" if whole else "")
            )
        rest = f"; then {', '.join(part.name for part in self.waiting)}" if self.waiting else ""
        return " | ".join(shown) + rest

    def give_up_tests_of_dev(self) -> None:
        for part in [part for part in self.waiting if part.name in TESTS_OF_DEV]:
            self.waiting.remove(part)
            print(f"\n==== {part.name}\nFAILED {part.name}: not run, the dev build failed")
            part.failed = 1
            self.done.append(part)

    def go(self) -> None:
        terminal = sys.stderr.isatty()
        while self.waiting or self.running:
            self.start_what_may()
            reap_orphans({part.process.pid for part in self.running if part.process is not None})
            for part in [part for part in self.running if part.reap()]:
                part.judge()
                self.running.remove(part)
                self.done.append(part)
                if terminal:
                    print("\r\033[K", end="", file=sys.stderr, flush=True)
                part.show()
                if part.name == "build" and part.failed:
                    self.give_up_tests_of_dev()
            if terminal and self.running:
                columns = os.get_terminal_size(sys.stderr.fileno()).columns
                line = self.status_line()[: columns - 1]
                print(f"\r{line}\033[K", end="", file=sys.stderr, flush=True)
            time.sleep(0.2)

    def table(self) -> str:
        rows = [
            f"\n{'part':<10} {'passed':>7} {'failed':>7} {'skipped':>7} {'min:s':>7} {'CPU s':>7}"
        ]
        rows += [
            f"{part.name:<10} {part.passed:>7} {part.failed:>7} {part.skipped:>7} "
            f"{as_minutes(part.took_s):>7} {part.cpu_s:>7.0f}"
            for part in self.done
        ]
        took = as_minutes(time.monotonic() - self.begin_s)
        rows.append(f"{'together':<34} {took:>7} {sum(part.cpu_s for part in self.done):>7.0f}")
        return "\n".join(rows)


def with_build(names: list[str]) -> list[str]:
    """The dev build goes first where something is tested with it."""
    needed = "build" not in names and TESTS_OF_DEV.intersection(names)
    return (["build"] if needed else []) + names


def expected(names: list[str], chosen: str, budget: costs.Budget) -> str:
    """Duration of a run: as measured, or as the costs of its parts let expect."""
    if took := budget.sets.get(chosen):
        return (
            f" On {budget.machine}: {as_minutes(took.cold_s)} where nothing is compiled yet,"
            f" {as_minutes(took.warm_s)} afterwards."
        )
    parts = [budget.parts[name] for name in dict.fromkeys(names) if name in budget.parts]
    if len(parts) < len(set(names)):
        return " How long they take: CONTRIBUTING.md."
    cpu_s = sum(part.cpu_s for part in parts)
    # The build goes alone; beside others no run is shorter than its longest part.
    alone = budget.parts["build"] if "build" in names else costs.PartCost(0, 0)
    longest_s = max([part.took_s for part in parts if part is not alone], default=0)
    took_s = alone.took_s + max((cpu_s - alone.cpu_s) / ALL_CORES, longest_s)
    return (
        f" Where nothing is compiled yet, {cpu_s:.0f} CPU-seconds on {budget.machine}:"
        f" about {as_minutes(took_s)} on the {ALL_CORES} cores here."
    )


def greeting(names: list[str], chosen: str, budget: costs.Budget) -> str:
    text = f"rc10d's tests: {', '.join(names)}." + expected(names, chosen, budget)
    return text + f" The full output of each: {LOGS.relative_to(REPO)}/PART.log"


def take_signals() -> None:
    """As Ctrl-C, but for those that nohup keeps away."""
    for number in (signal.SIGTERM, signal.SIGHUP):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, signal.default_int_handler)


def ignore_further_signals() -> None:
    """A second Ctrl-C would leave processes of the first behind."""
    for number in ENDS:
        signal.signal(number, signal.SIG_IGN)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--name", default="")
    parser.add_argument("parts", nargs="+")
    arguments = parser.parse_args()
    budget = costs.Budget.read(BUDGET)
    names = with_build(arguments.parts)
    try:
        LOGS.mkdir(parents=True, exist_ok=True)
        lock = (LOGS / "lock").open("w")
    except PermissionError as error:
        remedy = 'it belongs to another user: sudo chown -R "$USER" . (in the clone)'
        print(f"test.sh: {error}: {remedy}", file=sys.stderr)
        return 2
    except OSError as error:
        print(f"test.sh: {error}", file=sys.stderr)
        return 2
    keep_orphans()
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        print("test.sh: another run of this clone is under way: let it end first", file=sys.stderr)
        return 2
    for old in LOGS.glob("*.costs"):
        old.unlink()
    print(greeting(names, arguments.name, budget), flush=True)
    run = Run(names, budget)
    begin = time.time()
    try:
        run.go()
    except KeyboardInterrupt:
        ignore_further_signals()
        end_descendants()
        print("\ninterrupted", file=sys.stderr)
        return 130
    except BaseException:
        ignore_further_signals()
        end_descendants()
        raise
    if left := names_of_descendants():
        print(f"\nNOTE processes of these parts still ran and were ended: {', '.join(left)}")
        end_descendants()
    print(run.table())
    # Statistics must not cost the result.
    try:
        print(costs.slowest(LOGS, REPO / "build", begin), end="")
        measured = os.environ.get("RC10_MEASURED")
        pace = costs.pace(budget) if measured or arguments.name == "all" else 1.0
        if arguments.name == "all":
            print(costs.compare(budget, {part.name: part.cpu_s for part in run.done}, pace), end="")
        if measured:
            took = {
                part.name: {"took_s": round(part.took_s / pace), "cpu_s": round(part.cpu_s / pace)}
                for part in run.done
            }
            Path(measured).write_text(json.dumps(took, indent=2) + "\n")
    except (OSError, ValueError, subprocess.CalledProcessError) as error:
        print(f"\nno statistics: {error}")
    passed, failed, skipped = (
        sum(getattr(part, name) for part in run.done) for name in ("passed", "failed", "skipped")
    )
    bad = failed > 0
    if skipped and os.environ.get("CI") == "true":
        print("in CI nothing may be skipped")
        bad = True
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return int(bad)


if __name__ == "__main__":
    take_signals()
    for stream in (sys.stdout, sys.stderr):
        assert isinstance(stream, io.TextIOWrapper)
        stream.reconfigure(errors="replace")
    sys.exit(main())
