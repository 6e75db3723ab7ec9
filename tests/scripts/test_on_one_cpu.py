"""Each guest of the tests on a processor of its own: tests/kernel/on-one-cpu."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
COMMAND = str(REPO / "tests" / "kernel" / "on-one-cpu")
# Says which processors it may use, and ends with its input.
SAYS = ["sh", "-c", "sed -n 's/^Cpus_allowed_list:\t//p' /proc/self/status; exec cat"]


def start(cache: Path) -> tuple[subprocess.Popen[str], str]:
    process = subprocess.Popen(
        [COMMAND, *SAYS],
        text=True,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        env={**os.environ, "RC10_CACHE": str(cache)},
    )
    assert process.stdout is not None
    return process, process.stdout.readline().strip()


def end(process: subprocess.Popen[str]) -> None:
    process.communicate("")
    assert process.returncode == 0


def test_commands_share_no_processor_while_one_is_left_and_then_may_use_all(
    tmp_path: Path,
) -> None:
    allowed = os.sched_getaffinity(0)
    running = [start(tmp_path) for _ in allowed]
    one_more, its_processors = start(tmp_path)
    for process, _ in [*running, (one_more, "")]:
        end(process)
    assert sorted(int(processor) for _, processor in running) == sorted(allowed)
    status = Path("/proc/self/status").read_text()
    assert its_processors == status.split("Cpus_allowed_list:")[1].split()[0]


def test_a_processor_is_given_back_at_the_end_of_a_command(tmp_path: Path) -> None:
    first, its_processor = start(tmp_path)
    end(first)
    second, the_next_ones = start(tmp_path)
    end(second)
    assert its_processor.isdigit()
    assert its_processor == the_next_ones


def test_the_status_of_the_command_is_passed_on(tmp_path: Path) -> None:
    environment = {**os.environ, "RC10_CACHE": str(tmp_path)}
    done = subprocess.run([COMMAND, "sh", "-c", "exit 7"], env=environment, check=False)
    assert done.returncode == 7
