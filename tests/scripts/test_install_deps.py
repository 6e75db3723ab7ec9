"""scripts/install-deps.sh: told before it asks, and refused where it cannot end well."""

from __future__ import annotations

import json
import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]
INSTALL_DEPS = REPO / "scripts" / "install-deps.sh"
# Nothing is installed, nothing can be, and apt has no lists of packages.
BARE = {"dpkg-query": "", "apt-get": "exit 1", "sudo": "exit 1", "apt-cache": ""}

Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def run_with(tmp_path: Path) -> Run:
    """Runs a command with stand-ins for programs, by name and text, before its PATH."""

    def run(
        programs: dict[str, str], *command: str | Path, stdin: int | None = None
    ) -> subprocess.CompletedProcess[str]:
        for program, text in (BARE | programs).items():
            (tmp_path / program).write_text(f"#!/bin/bash\n{text}\n")
            (tmp_path / program).chmod(0o755)
        environment = os.environ | {
            "PATH": f"{tmp_path}:{os.environ['PATH']}",
            "CALLS": str(tmp_path / "calls"),
        }
        return subprocess.run(
            command, env=environment, stdin=stdin, capture_output=True, text=True, check=False
        )

    return run


def test_a_bare_machine_reads_what_comes_and_how_long_before_the_packages(run_with: Run) -> None:
    """Python, which says it otherwise, is among the packages."""
    done = run_with({}, REPO / "scripts" / "test.sh")
    budget = json.loads((REPO / "scripts" / "test" / "budget.json").read_text())
    cold_s = budget["sets"]["default"]["cold_s"]
    said = (
        f"rc10d's tests: unit kernel host pages. About {cold_s // 60}:{cold_s % 60:02} on 2 cores"
    )
    assert done.stdout.startswith(said)
    assert done.returncode != 0


@pytest.mark.parametrize(("part", "told"), [("vm", True), ("pages", False)])
def test_a_kernel_among_the_packages_is_told_before_they_are_installed(
    part: str, told: bool, run_with: Run
) -> None:
    done = run_with({}, REPO / "scripts" / "test.sh", part)
    assert ("PREEMPT_RT kernel, which GRUB may start" in done.stderr) == told


def test_packages_are_named_before_sudo_asks_for_the_password(run_with: Run) -> None:
    terminal, ours = os.openpty()
    programs = {"id": "echo 1000", "sudo": "echo ASKED >&2"}
    done = run_with(programs, INSTALL_DEPS, "--may-ask", "web", stdin=ours)
    os.close(terminal)
    os.close(ours)
    assert done.stderr.splitlines() == [
        "install-deps: this needs 2 Debian packages: chromium fonts-noto-cjk",
        "ASKED",
    ]
    assert done.returncode == 0


APT = """
echo "$*" | grep -o 'install \\|update' >>"$CALLS"
[ "$(grep -c update "$CALLS")" -lt 3 ] || exit 0
echo "E: Could not get lock /var/lib/apt/lists/lock. It is held by process 1"
exit 100
"""


def test_package_lists_that_another_apt_reads_are_waited_for(run_with: Run, tmp_path: Path) -> None:
    """A machine that was just started updates them by itself."""
    done = run_with({"id": "echo 0", "sleep": "", "apt-get": APT}, INSTALL_DEPS, "web")
    assert done.returncode == 0
    calls = (tmp_path / "calls").read_text().split()
    assert calls == ["install", "update", "update", "update", "install"]


# Has lists at once, or as soon as $CALLS tells of an update.
APT_CACHE = """
[ "$at_once" ] || grep -qs update "$CALLS" || exit 0
[ $# -gt 1 ] || { echo " 500 http://archive bookworm/main amd64 Packages"; exit; }
for package in "${@:2}"; do
    candidate=1.6.3-1+b3
    [ "$package" != libgpiod-dev ] || candidate=$gpiod
    [ "$package" != "$lacking" ] || candidate="(none)"
    [ "$package" != "$unheard" ] || continue
    printf '%s:\\n  Installed: (none)\\n  Candidate: %s\\n' "$package" "$candidate"
done
"""


def apt_cache(value: str = "", *, at_once: bool = True) -> str:
    return f"gpiod=1.6.3-1+b3 at_once={'yes' if at_once else ''} {value}\n{APT_CACHE}"


OTHER_RELEASES = [
    ("kernel", "unheard=linux-source-6.1", "no linux-source-6.1: those are packages of Debian 12"),
    ("web", "lacking=chromium", "no chromium: those are packages of Debian 12"),
    ("build", "gpiod=2.2.1-2", "libgpiod-dev here is 2.2.1-2"),
]
APT_WITHOUT_LISTS = """
echo "$*" | grep -o 'install \\|update' >>"$CALLS"
grep -q update "$CALLS"
"""


@pytest.mark.parametrize("at_once", [True, False], ids=["lists", "lists after an update"])
@pytest.mark.parametrize(("group", "value", "said"), OTHER_RELEASES)
def test_another_release_is_refused_as_soon_as_its_lists_are_known(
    group: str, value: str, said: str, at_once: bool, run_with: Run, tmp_path: Path
) -> None:
    cache = apt_cache(value, at_once=at_once)
    user = "echo 1000" if at_once else "echo 0"
    programs = {"id": user, "apt-get": APT_WITHOUT_LISTS, "apt-cache": cache}
    done = run_with(programs, INSTALL_DEPS, group)
    assert done.returncode == 1
    assert said in done.stderr.splitlines()[-1]
    calls = tmp_path / "calls"
    assert calls.exists() != at_once
    assert at_once or calls.read_text().split() == ["install", "update"]


def test_root_has_old_lists_updated_before_it_is_refused(run_with: Run, tmp_path: Path) -> None:
    cache = apt_cache("lacking=chromium")
    programs = {"id": "echo 0", "apt-get": APT_WITHOUT_LISTS, "apt-cache": cache}
    done = run_with(programs, INSTALL_DEPS, "web")
    assert done.returncode == 1
    assert "no chromium" in done.stderr
    assert (tmp_path / "calls").read_text().split() == ["install", "update"]


def test_another_release_is_refused_before_sudo_asks(run_with: Run) -> None:
    cache = apt_cache("lacking=chromium")
    programs = {"id": "echo 1000", "sudo": "echo ASKED >&2", "apt-cache": cache}
    done = run_with(programs, INSTALL_DEPS, "--may-ask", "web")
    assert done.returncode == 1
    assert "no chromium" in done.stderr
    assert "ASKED" not in done.stderr


def test_a_release_that_has_all_packages_is_asked_for_them(run_with: Run) -> None:
    programs = {"id": "echo 0", "apt-get": "", "apt-cache": apt_cache()}
    assert run_with(programs, INSTALL_DEPS).returncode == 0
