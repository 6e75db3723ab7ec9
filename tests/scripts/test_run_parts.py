"""Parts of the tests: what is run beside what, what counts, and what is shown."""

from __future__ import annotations

import os
import re
import select
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import descendants
import pytest
import run_parts
from costs import Budget, PartCost, SetCost, compare, pace

WriteParts = Callable[..., None]


@pytest.fixture
def write_parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> WriteParts:
    """Writes scripts of parts, by name and text, in the place of the real ones."""
    monkeypatch.setattr(run_parts, "SCRIPTS", tmp_path)
    monkeypatch.setattr(run_parts, "LOGS", tmp_path)
    monkeypatch.setattr(run_parts, "ALL_CORES", 2)

    def write(**texts: str) -> None:
        for name, text in texts.items():
            script = tmp_path / f"{name}.sh"
            script.write_text(f"#!/bin/sh\n# about {name}\n{text}\n")
            script.chmod(0o755)

    return write


def run(*names: str) -> dict[str, run_parts.Part]:
    parts = run_parts.Run(list(names), Budget("a test", 1.0, {}, {}))
    parts.go()
    return {part.name: part for part in parts.done}


def test_counts_are_those_of_the_last_line(write_parts: WriteParts) -> None:
    write_parts(lint="echo '9 passed, 9 failed, 9 skipped'; echo '3 passed, 0 failed, 1 skipped'")
    part = run("lint")["lint"]
    assert (part.passed, part.failed, part.skipped) == (3, 0, 1)


def test_a_part_knows_which_parts_run_beside_it(write_parts: WriteParts) -> None:
    count = """echo "$(echo "$RC10_PARTS" | wc -w) passed, 0 failed, 0 skipped\""""
    write_parts(build=count, kernel=count)
    assert [part.passed for part in run("build", "kernel").values()] == [2, 2]


@pytest.mark.parametrize(
    "text",
    [
        "echo nothing",
        "kill -9 $$",
        "echo '3 passed, 0 failed, 0 skipped'; exit 1",
        "echo '3 passed, 0 failed, 1 skipped'; exit 139",
        "echo '0 passed, 0 failed, 0 skipped'",
    ],
    ids=["no result", "killed", "a status that says no", "skips and a crash", "no test"],
)
def test_a_part_that_does_not_end_well_is_a_failure(write_parts: WriteParts, text: str) -> None:
    write_parts(lint=text)
    assert run("lint")["lint"].failed == 1


def test_what_a_part_prints_is_shown_only_if_it_failed(
    write_parts: WriteParts, capsys: pytest.CaptureFixture[str]
) -> None:
    write_parts(
        lint="echo quiet; echo 'SKIPPED why'; echo '1 passed, 0 failed, 1 skipped'",
        pages="echo loud; echo '0 passed, 1 failed, 0 skipped'",
    )
    run("lint", "pages")
    shown = capsys.readouterr().out
    assert "quiet" not in shown
    assert "SKIPPED why" in shown
    assert "loud" in shown


def test_without_a_build_its_tests_are_failures_and_not_run(
    write_parts: WriteParts, tmp_path: Path
) -> None:
    ok = "echo '1 passed, 0 failed, 0 skipped'"
    write_parts(build="exit 1", unit=f"touch {tmp_path}/ran; {ok}", lint=ok)
    parts = run("build", "unit", "lint")
    assert (parts["unit"].failed, parts["lint"].failed) == (1, 0)
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize(("ci", "status"), [("true", 1), ("", 0)])
def test_in_ci_a_skip_is_a_failure(
    write_parts: WriteParts,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    ci: str,
    status: int,
) -> None:
    write_parts(lint="echo '2 passed, 0 failed, 1 skipped'")
    monkeypatch.setattr(run_parts, "REPO", run_parts.LOGS)
    monkeypatch.setattr("sys.argv", ["run_parts.py", "lint"])
    monkeypatch.setenv("CI", ci)
    assert run_parts.main() == status
    shown = capsys.readouterr().out
    assert ("in CI nothing may be skipped" in shown) == bool(status)
    assert shown.splitlines()[-1] == "2 passed, 0 failed, 1 skipped"


def test_the_table_has_a_line_for_each_part_and_their_sum() -> None:
    parts = run_parts.Run(["lint"], Budget("a test", 1.0, {}, {}))
    parts.done = [
        run_parts.Part("lint", passed=2, skipped=1, took_s=75.0, cpu_s=61.2),
        run_parts.Part("pages", failed=3, took_s=9.0, cpu_s=10.4),
    ]
    head, *rows, last = [line.split() for line in parts.table().strip().splitlines()]
    assert head == ["part", "passed", "failed", "skipped", "min:s", "CPU", "s"]
    assert rows == [["lint", "2", "0", "1", "1:15", "61"], ["pages", "0", "3", "0", "0:09", "10"]]
    assert last == ["together", "0:00", "72"]


def test_what_waits_runs_beside_what_computes(write_parts: WriteParts, tmp_path: Path) -> None:
    # Each waits for the other: alone, neither would end.
    here, there = tmp_path / "here", tmp_path / "there"
    for fifo in (here, there):
        os.mkfifo(fifo)
    ok = "echo '1 passed, 0 failed, 0 skipped'"
    write_parts(
        kernel=f"echo > {here}; read line < {there}; {ok}",
        host=f"read line < {here}; echo > {there}; {ok}",
    )
    assert [part.passed for part in run("kernel", "host").values()] == [1, 1]


def test_a_browser_is_waited_for_beside_what_compiles() -> None:
    parts = run_parts.Run(["clang", "host", "web"], Budget("a test", 1.0, {}, {}))
    clang, host, web = parts.waiting
    parts.running = [clang]
    assert parts.may_start(host)
    assert parts.may_start(web)
    parts.running = [clang, host]
    assert not parts.may_start(web), "together they would take a core from it"
    parts.running = [web]
    assert parts.may_start(clang)


def test_tests_of_the_dev_build_wait_for_it(write_parts: WriteParts, tmp_path: Path) -> None:
    ok = "echo '1 passed, 0 failed, 0 skipped'"
    write_parts(build=f"touch {tmp_path}/built; {ok}", host=f"[ -e {tmp_path}/built ] && {ok}")
    assert run("build", "host")["host"].failed == 0
    assert run_parts.with_build(["host", "pages"]) == ["build", "host", "pages"]
    assert run_parts.with_build(["pages"]) == ["pages"]


def test_a_part_is_ended_with_what_it_has_started(write_parts: WriteParts, tmp_path: Path) -> None:
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    # In a session of its own, as programs under test are.
    write_parts(lint=f"setsid sh -c 'trap : TERM; exec sleep 30' >{fifo}; sleep 30")
    run_of_parts = os.fork()
    if run_of_parts == 0:
        descendants.keep_orphans()
        run_parts.Run(["lint"], Budget("a test", 1.0, {}, {})).start_what_may()
        with fifo.open():  # opened by both: it sleeps
            descendants.end_descendants()
        os._exit(0)
    with fifo.open() as end:
        assert select.select([end], [], [], 20)[0]
        assert end.read() == ""
    assert os.waitpid(run_of_parts, 0)[1] == 0


def test_what_ends_has_time_to_clear_up(write_parts: WriteParts, tmp_path: Path) -> None:
    begun, cleaning, go_on = tmp_path / "begun", tmp_path / "cleaning", tmp_path / "go_on"
    for fifo in (begun, cleaning, go_on):
        os.mkfifo(fifo)
    left = tmp_path / "left"
    left.touch()
    clean_up = f"echo >{cleaning}; read line <{go_on}; rm {left}"
    # A child that is still the shell's copy would lose the signal.
    child = f"sh -c 'echo >{begun}; exec sleep 30'"
    write_parts(lint=f"trap 'sh -c \"{clean_up}\"; exit' TERM; {child} & wait")
    # First `sleep` ends, then the clean-up is there at another look, and only then it goes on.
    wait_for_an_end = descendants.wait_for_an_end
    looks: list[set[int]] = []

    def wait(pids: set[int], timeout_s: float | None) -> None:
        looks.append(pids)
        if len(looks) == 2:
            cleaning.read_text()
            return
        if len(looks) == 3:
            go_on.write_text("go on")
        wait_for_an_end(pids, timeout_s)

    run_of_parts = os.fork()
    if run_of_parts == 0:
        descendants.keep_orphans()
        descendants.wait_for_an_end = wait
        run_parts.Run(["lint"], Budget("a test", 1.0, {}, {})).start_what_may()
        begun.read_text()
        descendants.end_descendants()
        os._exit(0)
    assert os.waitpid(run_of_parts, 0)[1] == 0
    assert not left.exists()


@pytest.mark.parametrize("name", ["RC10_RUN_DIR", "LCM_DEFAULT_URL", "GIT_DIR", "GTEST_FILTER"])
def test_settings_of_the_caller_are_not_those_of_its_tests(
    write_parts: WriteParts, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    monkeypatch.setenv(name, "/nowhere")
    write_parts(lint=f'echo "${{{name}-0}} passed, 1 failed, 0 skipped"')
    assert run("lint")["lint"].passed == 0
    assert run("lint")["lint"].failed == 1
    assert not run("lint")["lint"].complaint


MAIN = """
import os, pathlib, runpy, sys
sys.path.insert(0, sys.argv[1])
import run_parts
folder = pathlib.Path(sys.argv[2])
run_parts.REPO = run_parts.SCRIPTS = run_parts.LOGS = folder
run_parts.take_signals()
sys.argv = ["run_parts.py", "lint"]
sys.exit(run_parts.main())
"""


@pytest.mark.parametrize("ignored", [False, True], ids=["in a terminal", "under nohup"])
def test_the_end_of_a_terminal_ends_a_run_unless_nohup_keeps_it(
    write_parts: WriteParts, tmp_path: Path, ignored: bool
) -> None:
    begun, go_on = tmp_path / "begun", tmp_path / "go_on"
    for fifo in (begun, go_on):
        os.mkfifo(fifo)
    write_parts(lint=f"echo >{begun}; read line <{go_on}; echo '1 passed, 0 failed, 0 skipped'")
    scripts = Path(run_parts.__file__).parent
    action = signal.SIG_IGN if ignored else signal.SIG_DFL
    with subprocess.Popen(
        [sys.executable, "-c", MAIN, scripts, tmp_path],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        preexec_fn=lambda: signal.signal(signal.SIGHUP, action),
    ) as running:
        begun.read_text()
        running.send_signal(signal.SIGHUP)
        if ignored:
            go_on.write_text("\n")
        assert running.wait(60) == (0 if ignored else 130)


def test_a_part_that_leaves_processes_running_is_told(
    write_parts: WriteParts, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    ok = "echo '1 passed, 0 failed, 0 skipped'"
    write_parts(lint=f"sleep 30 >{fifo} & read line <{fifo}; {ok}", pages=ok)
    # By both ends, so that no open waits; a line is what lets the part end.
    with fifo.open("r+b", buffering=0) as end:
        end.write(b"\n")
        assert run("lint", "pages")["lint"].failed == 0
    shown = capsys.readouterr().out
    assert "NOTE lint left processes running: " in shown
    assert "pages left" not in shown


def test_a_part_that_grew_by_a_third_is_named() -> None:
    parts = {name: PartCost(took_s=1, cpu_s=100) for name in ("unit", "host")}
    budget = Budget("a machine of twice the speed", 2.0, {}, parts)
    text = compare(budget, {"unit": 260.0, "host": 270.0, "web": 1.0}, 2.0)
    assert "GREW host: 270 CPU s instead of 200" in text
    assert "unit" not in text
    assert "web: 1 CPU s, and no budget" in text


def test_the_pace_is_that_of_a_compilation(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("costs.reference_cpu_s", lambda: 4.0)
    assert pace(Budget("a machine of twice the speed", 2.0, {}, {})) == 2.0


def test_a_part_that_found_its_files_compiled_is_not_judged() -> None:
    budget = budget_of({}, build=600, clang=1000, host=200)
    text = compare(budget, {"build": 30.0, "clang": 499.0, "host": 190.0}, 1.0)
    assert "none of 1 parts grew by a third" in text
    assert "not judged, less than half of the budget, as after a build: build, clang" in text
    assert "not judged" not in compare(budget, {"build": 300.0, "host": 190.0}, 1.0)
    assert "grew" not in compare(budget, {"build": 30.0}, 1.0)


def test_what_a_part_leaves_in_a_session_of_its_own_is_told_and_ended(
    write_parts: WriteParts, tmp_path: Path
) -> None:
    fifo = tmp_path / "fifo"
    os.mkfifo(fifo)
    ok = "echo '1 passed, 0 failed, 0 skipped'"
    write_parts(lint=f"setsid sleep 30 >{fifo} & read line <{fifo}; {ok}")
    with fifo.open("r+b", buffering=0) as end:
        end.write(b"\n")
        done = subprocess.run(
            [sys.executable, "-c", MAIN, Path(run_parts.__file__).parent, tmp_path],
            capture_output=True,
            text=True,
            check=True,
            timeout=60,
        )
    assert "NOTE processes of these parts still ran and were ended: sleep" in done.stdout


def budget_of(sets: dict[str, SetCost], **cpu_s: float) -> Budget:
    parts = {name: PartCost(took_s=100, cpu_s=each) for name, each in cpu_s.items()}
    return Budget("a machine", 1.0, sets, parts)


def test_a_run_says_at_the_start_how_long_it_will_take(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_parts, "ALL_CORES", 2)
    budget = budget_of({"default": SetCost(cold_s=900, warm_s=360)}, build=300, clang=340)
    assert "On a machine: 15:00 where nothing" in run_parts.greeting(["build"], "default", budget)
    by_parts = run_parts.greeting(["build", "clang"], "all", budget)
    assert "640 CPU-seconds on a machine: about 4:30 on the 2 cores here" in by_parts
    monkeypatch.setattr(run_parts, "ALL_CORES", 64)
    alone = run_parts.greeting(["build", "clang"], "all", budget)
    assert "about 3:20 on" in alone, "the build, then the longest"
    on_request = run_parts.greeting(["build", "fresh"], "nightly", budget)
    assert "about" not in on_request
    assert "How long they take: CONTRIBUTING.md" in on_request


def test_each_set_knows_how_long_it_will_take() -> None:
    budget = Budget.read(run_parts.BUDGET)
    script = (run_parts.REPO / "scripts" / "test.sh").read_text()
    sets = dict(re.findall(r"^(default|ci|all)=\((.*)\)$", script, re.MULTILINE))
    assert set(sets) == {"default", "ci", "all"}
    for name, words in sets.items():
        parts = words.replace('"${default[@]}"', sets["default"]).split()
        assert run_parts.expected(run_parts.with_build(parts), name, budget)


def test_every_part_has_a_script_that_says_what_it_is() -> None:
    for name in run_parts.TESTS_OF_DEV | run_parts.CORES.keys():
        assert run_parts.Part(name).about
