#!/usr/bin/python3
"""Mutation testing of the safety core: small changes of its sources, which unit tests must notice.

universalmutator makes the mutants of all files; a sample by seed is built and tested, each in a
copy of the project. One that does not compile counts for nothing. Those that live are told, but
for the ones that tests/mutants/equivalent.txt gives a reason for. The last line is "N passed,
N failed, N skipped": one test, which fails below 95 % of the rest.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import contextlib
import difflib
import hashlib
import math
import os
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from xml.etree import ElementTree as ET

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

REPO = Path(__file__).resolve().parents[2]
WORK = REPO / "build" / "mutants"
LEAST_KILLED = 0.95
# A mutant that never ends is noticed, too: by its CPU time, as the machine may be busy, or asleep.
TEST_CPU_S = 180
TEST_PATIENCE_S = 900
PROGRESS = 25
TESTS = ("motor_test", "daemon_test")
FILES = (
    "src/daemon/clients/admission.cpp",
    "src/daemon/supervision/states.hpp",
    "src/daemon/supervision/axis.cpp",
    "src/daemon/supervision/foreign_watch.cpp",
    "src/daemon/supervision/lease.hpp",
    "src/daemon/supervision/motor_group.cpp",
    "src/daemon/supervision/pending_enables.hpp",
    "src/daemon/supervision/supervisor.cpp",
    "src/daemon/supervision/supervisor_alone.cpp",
    "src/daemon/supervision/supervisor_groups.cpp",
    "src/daemon/supervision/supervisor_orders.cpp",
    "src/daemon/tick/scheduler.cpp",
    "src/motor/angle_reference.cpp",
    "src/motor/encoder.cpp",
    "src/motor/first_angle.cpp",
    "src/motor/guarding/fallback.hpp",
    "src/motor/guarding/motor_guard.cpp",
    "src/motor/guarding/reduced_motion.cpp",
    "src/motor/guarding/rest_check.cpp",
    "src/motor/guarding/target_shaper.cpp",
    "src/motor/spring_law.cpp",
)


# Key of a mutant, as equivalent.txt has it: file, old and new text of the line.
Key = tuple[str, str, str]


class Mutant(NamedTuple):
    """One changed line of one file."""

    file: str
    line: int
    before: str
    after: str
    text: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}\n  - {self.before}\n  + {self.after}"

    @property
    def key(self) -> Key:
        """As equivalent.txt has it."""
        return self.file, self.before, self.after


def mutants_of(file: str, mutate: Path) -> list[Mutant]:
    """Every mutant of one file that changes more than blanks and comments, once."""
    original = (REPO / file).read_text(encoding="utf-8")
    found: dict[tuple[int, str, str], Mutant] = {}
    with tempfile.TemporaryDirectory() as folder, tempfile.TemporaryDirectory() as sources:
        source = Path(sources, Path(file).name)
        source.write_text(shown(original), encoding="utf-8")
        subprocess.run(
            [mutate, source, "cpp", "--noCheck", "--mutantDir", folder],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        for path in sorted(Path(folder).iterdir()):
            text = as_written(path.read_text(encoding="utf-8"))
            changed = difference(original, text)
            if changed is not None:
                found.setdefault(changed, Mutant(file, *changed, text))
    return list(found.values())


# universalmutator takes `{-`, of Duration{-1}, for the begin of a comment that ends nowhere.
def shown(text: str) -> str:
    """A source as universalmutator gets it."""
    return text.replace("{-", "{ -")


def as_written(text: str) -> str:
    """The inverse of shown(): clang-format leaves no such blank."""
    return text.replace("{ -", "{-")


def difference(original: str, text: str) -> tuple[int, str, str] | None:
    """Number, old and new text of the one line that differs; None: nothing but a comment."""
    old, new = original.splitlines(), text.splitlines()
    for tag, first, last, other_first, other_last in difflib.SequenceMatcher(
        None, old, new, autojunk=False
    ).get_opcodes():
        if tag == "equal":
            continue
        before = " ".join(line.split("//")[0].strip() for line in old[first:last])
        after = " ".join(line.split("//")[0].strip() for line in new[other_first:other_last])
        return None if before == after or not before else (first + 1, before, after)
    return None


def sample_of(candidates: list[Mutant], seed: int, count: int) -> list[Mutant]:
    """So many by seed; what is added or taken away elsewhere changes nothing in the rest."""

    def rank(mutant: Mutant) -> bytes:
        return hashlib.sha256("\t".join((str(seed), *mutant.key)).encode()).digest()

    return sorted(candidates, key=rank)[:count]


def equivalent(text: str) -> set[Key]:
    """Those that are no other programs, of the text of equivalent.txt."""
    known = set()
    for line in text.splitlines():
        if line and not line.startswith("#"):
            file, before, after, _reason = line.split("\t")
            known.add((file, before, after))
    return known


def stale(known: set[Key], everything: Iterable[Mutant]) -> list[Key]:
    """Those that no mutant is any more: their line has changed."""
    return sorted(known - {mutant.key for mutant in everything})


class Tree:
    """A copy of the project with its tests, in which one mutant after the other is tried."""

    def __init__(self, number: int) -> None:
        self.root = WORK / f"tree-{number}"
        # Below the sources: ccache sees the same paths in each tree.
        self.build = self.root / "build"
        self.tests: dict[str, dict[Path, list[str]]] = {program: {} for program in TESTS}
        self.changed: Path | None = None
        listed = subprocess.run(
            ["git", "ls-files", "-co", "--exclude-standard", "-z"],
            cwd=REPO,
            check=True,
            capture_output=True,
        )
        names = [name for name in listed.stdout.decode().split("\0") if (REPO / name).is_file()]
        # CMake would find what has been moved or removed since.
        copies = {file for file in self.root.rglob("*") if file.is_file()}
        for old in copies - {self.root / name for name in names}:
            if self.build not in old.parents:
                old.unlink()
        for name in names:
            source, copy = REPO / name, self.root / name
            # Unchanged text keeps its time: it is not compiled again.
            if not copy.exists() or copy.read_bytes() != source.read_bytes():
                copy.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, copy)
        options = {
            "CMAKE_BUILD_TYPE": "Debug",
            # All tests then take half of their time, which is most of it.
            "CMAKE_CXX_FLAGS_DEBUG": "-O1",
            # One changed source compiles few others; a changed header few tests, together.
            "RC10_UNITY_BATCH": "8",
            "RC10_TEST_LAYERS": "motor;daemon",
            "RC10_WERROR": "OFF",
        }
        flags = [f"-D{key}={value}" for key, value in options.items()]
        self.run(["cmake", "-G", "Ninja", "-S", self.root, "-B", self.build, *flags], check=True)

    def run(
        self, command: list[str | Path], check: bool = False, timeout_s: float | None = None
    ) -> bool:
        """Whether it succeeded in time."""
        env = {**os.environ, "CCACHE_BASEDIR": str(self.root), "CCACHE_NOHASHDIR": "1"}
        with subprocess.Popen(
            command,
            cwd=self.root,
            env=env,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        ) as running:
            try:
                output, _ = running.communicate(timeout=timeout_s)
            except subprocess.TimeoutExpired:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(running.pid, signal.SIGKILL)
                running.communicate()
                if check:
                    sys.exit(f"mutants: {command[0]} took more than {timeout_s} s")
                return False
        if check and running.returncode != 0:
            sys.exit(output.decode(errors="replace"))
        return running.returncode == 0

    def compile(self, programs: Sequence[str] = TESTS, check: bool = False) -> bool:
        """Builds the tests, or some of their programs."""
        return self.run(["ninja", "-C", self.build, *programs], check)

    def list_tests(self) -> None:
        """Notes the names of all tests by the file that has them."""
        for program in TESTS:
            listed = self.build / f"{program}.xml"
            self.run(
                [
                    self.build / "tests" / program,
                    "--gtest_list_tests",
                    f"--gtest_output=xml:{listed}",
                ],
                check=True,
            )
            for suite in ET.parse(listed).getroot():
                for case in suite:
                    source = Path(case.attrib["file"]).relative_to(self.root)
                    name = f"{suite.attrib['name']}.{case.attrib['name']}"
                    self.tests[program].setdefault(source, []).append(name)

    def mirrored(self, program: str, file: str) -> list[str]:
        """Tests of a source: src/motor/encoder.cpp has those of tests/motor/encoder*_test.cpp."""
        source = Path(file)
        folder = Path("tests", *source.parent.parts[1:])
        return [
            name
            for path, names in self.tests[program].items()
            if path.parent == folder and path.name.startswith(source.stem)
            for name in names
        ]

    def passes(
        self, programs: Sequence[str] = TESTS, check: bool = False, only: str | None = None
    ) -> bool:
        """Whether all tests of these programs pass, or those of one source."""
        for program in programs:
            command: list[str | Path] = ["prlimit", f"--cpu={TEST_CPU_S}"]
            command += [self.build / "tests" / program]
            command += ["--gtest_fail_fast", "--gtest_brief=1"]
            if only is not None:
                command.append("--gtest_filter=" + ":".join(self.mirrored(program, only)))
            if not self.run(command, check, TEST_PATIENCE_S):
                return False
        return True

    def restore(self) -> None:
        """Undoes the last mutant."""
        if self.changed is not None:
            shutil.copyfile(REPO / self.changed, self.root / self.changed)
            self.changed = None

    def judge(self, mutant: Mutant) -> str:
        """`killed`, `lives`, or `invalid`: it does not compile."""
        # The next mutant of a file takes its place: its objects are compiled once, not twice.
        if self.changed != Path(mutant.file):
            self.restore()
        self.changed = Path(mutant.file)
        (self.root / mutant.file).write_text(mutant.text, encoding="utf-8")
        # Most are noticed by the tests of their own file, in one program.
        own = [program for program in TESTS if self.mirrored(program, mutant.file)]
        if own:
            if not self.compile(own):
                return "invalid"
            if not self.passes(own, only=mutant.file):
                return "killed"
        if not self.compile():
            return "invalid"
        return "lives" if self.passes() else "killed"


def part_of(text: str) -> tuple[int, int]:
    """K and N of K/N."""
    part, _, parts = text.partition("/")
    if not (part.isdecimal() and parts.isdecimal() and 1 <= int(part) <= int(parts)):
        raise argparse.ArgumentTypeError(f"{text}: give K/N, such as 1/3")
    return int(part), int(parts)


def arguments() -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--mutate", type=Path, required=True, help="universalmutator's program")
    parser.add_argument("--count", type=int, default=400, help="mutants that compile")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--part", type=part_of, default=(1, 1), help="K/N: one part of N of the sample"
    )
    parser.add_argument("--jobs", type=int, default=2)
    return parser.parse_args()


def main() -> int:
    """Tries a sample."""
    given = arguments()
    WORK.mkdir(parents=True, exist_ok=True)
    everything = [mutant for file in FILES for mutant in mutants_of(file, given.mutate)]
    known = equivalent((REPO / "tests/mutants/equivalent.txt").read_text(encoding="utf-8"))
    if gone := stale(known, everything):
        print(
            "tests/mutants/equivalent.txt: no mutant is that any more; mend or remove these lines:"
        )
        for file, before, after in gone:
            print(f"{file}\n  - {before}\n  + {after}")
        print("0 passed, 1 failed, 0 skipped")
        return 1
    candidates = [mutant for mutant in everything if mutant.key not in known]
    # Some do not compile.
    part, parts = given.part
    sample = sample_of(candidates, given.seed, 2 * given.count)[part - 1 :: parts]
    count = given.count // parts
    print(
        f"{len(everything)} mutants of {len(FILES)} files, {len(known)} known as equivalent",
        flush=True,
    )

    trees: queue.Queue[Tree] = queue.Queue()
    for number in range(given.jobs):
        tree = Tree(number)
        tree.compile(check=True)
        tree.list_tests()
        tree.passes(check=True)
        trees.put(tree)

    counts = {"killed": 0, "lives": 0, "invalid": 0}

    def judge(mutant: Mutant) -> tuple[Mutant, str]:
        tree = trees.get()
        try:
            return mutant, tree.judge(mutant)
        finally:
            trees.put(tree)

    tried = 0
    with concurrent.futures.ThreadPoolExecutor(given.jobs) as pool:
        # As many as are wanted; then, for those that did not compile, as many as may be.
        while tried < count and sample:
            tries_each = 1 + counts["invalid"] / max(tried, 1)
            wanted = math.ceil((count - tried) * tries_each)
            batch, sample = sample[:wanted], sample[wanted:]
            for mutant, verdict in pool.map(judge, sorted(batch, key=lambda each: each.file)):
                counts[verdict] += 1
                if verdict == "lives":
                    print(f"lives: {mutant}", flush=True)
                if sum(counts.values()) % PROGRESS == 0:
                    print(f"so far: {counts}", flush=True)
            tried = counts["killed"] + counts["lives"]
    share = counts["killed"] / tried if tried else 0.0
    killed, invalid = counts["killed"], counts["invalid"]
    print(f"{tried} tried, {killed} killed ({100 * share:.1f} %), {invalid} did not compile")
    failed = share < LEAST_KILLED or tried < count // 2
    print(f"{int(not failed)} passed, {int(failed)} failed, 0 skipped")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
