"""Cost of tests and builds: the slowest of them, and what grew beyond its budget.

A test runner appends lines "SECONDS<TAB>NAME" to the file $RC10_COSTS.
"""

from __future__ import annotations

import json
import math
import re
import resource
import statistics
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

SLOWEST = 10
# A part that costs a third more than its budget is named.
GROWTH = 4 / 3
# Below this share of its budget a part has found its files compiled, here or in ccache.
COMPILED_BEFORE = 1 / 2


@dataclass(frozen=True)
class PartCost:
    """Cost of a part where nothing was compiled before."""

    took_s: float
    cpu_s: float


@dataclass(frozen=True)
class SetCost:
    """Time that a set of parts took from the command to the result, packages included."""

    cold_s: float
    warm_s: float


@dataclass(frozen=True)
class Budget:
    """scripts/test/budget.json: measured once, and compared with from then on."""

    machine: str
    reference_cpu_s: float
    sets: dict[str, SetCost]
    parts: dict[str, PartCost]

    @staticmethod
    def read(path: Path) -> Budget:
        raw = json.loads(path.read_text())
        costs = [*raw["sets"].values(), *raw["parts"].values()]
        numbers = [raw["reference_cpu_s"], *(number for cost in costs for number in cost.values())]
        if not all(math.isfinite(number) and number > 0 for number in numbers):
            raise ValueError(f"{path}: a cost is a number above 0")
        return Budget(
            raw["machine"],
            raw["reference_cpu_s"],
            {name: SetCost(**cost) for name, cost in raw["sets"].items()},
            {name: PartCost(**cost) for name, cost in raw["parts"].items()},
        )


def reference_cpu_s() -> float:
    """CPU-seconds of a compilation that never changes: how fast this machine is."""
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "reference.cpp")
        source.write_text('#include <regex>\nstd::regex pattern{"(a|b)*c"};\n')
        command = ["g++", "-std=c++20", "-O2", "-c", str(source), "-o", f"{folder}/reference.o"]
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def pace(budget: Budget) -> float:
    """So many times as long as where the budget was measured takes the same work here."""
    # One of three may run beside somebody else's work.
    return statistics.median(reference_cpu_s() for _ in range(3)) / budget.reference_cpu_s


def compare(budget: Budget, cpu_s: dict[str, float], slower: float) -> str:
    """Names each part that costs a third more than its budget, and those that cannot be judged.

    The budget is that of a run with nothing compiled yet: on compiled files, growth is hidden.
    """
    text = f"\nbudget (scripts/test/budget.json, times {slower:.2f}: the pace of this machine):\n"
    grown, warm = "", []
    for name, spent in cpu_s.items():
        allowed = budget.parts[name].cpu_s * slower if name in budget.parts else None
        if allowed is None:
            grown += f"  {name}: {spent:.0f} CPU s, and no budget\n"
        elif spent > allowed * GROWTH:
            grown += f"  GREW {name}: {spent:.0f} CPU s instead of {allowed:.0f}\n"
        elif spent < allowed * COMPILED_BEFORE:
            warm.append(name)
    judged = len(cpu_s) - len(warm)
    text += grown or (f"  none of {judged} parts grew by a third\n" if judged else "")
    if warm:
        text += f"  not judged, less than half of the budget, as after a build: {', '.join(warm)}\n"
    return text


def is_number(text: str) -> bool:
    return re.fullmatch(r"[0-9]+(\.[0-9]+)?", text) is not None


def measured_tests(logs: Path) -> list[tuple[float, str]]:
    tests = []
    for file in logs.glob("*.costs"):
        for line in file.read_text().splitlines():
            seconds, _, name = line.partition("\t")
            if is_number(seconds):
                tests.append((float(seconds), f"{file.stem}: {name}"))
    return tests


def compiled_files(builds: Path, since: float) -> list[tuple[float, str]]:
    """Files that Ninja has made since. Its log: start, end (ms), time of the file (ns), file."""
    files = {}
    for log in builds.glob("*/.ninja_log"):
        for line in log.read_text().splitlines()[1:]:
            fields = line.split("\t")
            if len(fields) < 5 or not all(map(is_number, fields[:3])):
                continue  # the end of a build that was interrupted
            begin, end, made_ns, output, *_ = fields
            if int(made_ns) / 1e9 >= since and output.endswith(".o"):
                files[f"{log.parent.name}/{output}"] = (int(end) - int(begin)) / 1000
    return [(seconds, name) for name, seconds in files.items()]


def slowest(logs: Path, builds: Path, since: float) -> str:
    text = ""
    for title, found in (
        ("slowest tests", measured_tests(logs)),
        ("slowest files", compiled_files(builds, since)),
    ):
        if found:
            text += f"\n{title}\n"
        for seconds, name in sorted(found, reverse=True)[:SLOWEST]:
            text += f"{seconds:8.1f} s  {name}\n"
    return text
