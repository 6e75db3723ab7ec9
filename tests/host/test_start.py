"""Start of rc10ctl at once: few libraries, few system calls, nothing that waits.

Its time is measured in docs/measuring.md, and not asserted.
"""

from __future__ import annotations

import os
import re
import subprocess
from typing import TYPE_CHECKING

from hostlib.daemon import BIN

if TYPE_CHECKING:
    from pathlib import Path

    from hostlib import Daemon

# Neither LCM nor its GLib, no logging, no Python: to load them takes longer than the work itself.
LIBRARIES = {
    "libyaml-cpp",
    "libmd",
    "libstdc++",
    "libm",
    "libgcc_s",
    "libc",
}
# A third more than were counted: loading, and for `list` finding the robot and one question to it.
MOST_CALLS_TO_START = 113
MOST_CALLS_TO_LIST = 133
WAITS = {"nanosleep", "clock_nanosleep", "select", "pselect6", "clone", "clone3", "vfork", "fork"}
CALL = re.compile(r"^(\w+)\(", re.MULTILINE)


def calls(folder: Path, *words: str, env: dict[str, str] | None = None) -> list[str]:
    """The system calls of rc10ctl, in their order."""
    log = folder / "strace"
    subprocess.run(
        ["strace", "-qq", "-o", log, BIN / "rc10ctl", *words],
        env={**os.environ, **(env or {})},
        capture_output=True,
        check=True,
    )
    return CALL.findall(log.read_text())


def test_it_links_what_it_needs_and_no_more() -> None:
    told = subprocess.run(["ldd", BIN / "rc10ctl"], capture_output=True, text=True, check=True)
    linked = set(re.findall(r"^\s*(\S+?)\.so\S* => /", told.stdout, re.MULTILINE))
    assert linked == LIBRARIES


def test_it_starts_in_few_system_calls(tmp_path: Path) -> None:
    made = calls(tmp_path, "--version")
    assert len(made) <= MOST_CALLS_TO_START, made


def test_list_is_one_connection_and_waits_for_nothing_else(daemon: Daemon, tmp_path: Path) -> None:
    made = calls(tmp_path, "list", env=daemon.env)
    assert len(made) <= MOST_CALLS_TO_LIST, made
    assert made.count("connect") == 1
    assert made.count("poll") <= 1  # for rc10d's answer
    assert not WAITS & set(made)


def test_every_program_is_moved_to_a_random_address_and_bound_before_it_runs() -> None:
    programs = [program for program in sorted(BIN.glob("rc10*")) if program.is_file()]
    assert len(programs) >= 6
    for program in programs:
        told = subprocess.run(
            ["readelf", "--wide", "--file-header", "--program-headers", "--dynamic", program],
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        assert re.search(r"Type: +DYN", told), program
        assert re.search(r"FLAGS.*\bNOW\b", told), program
        assert "GNU_RELRO" in told, program
        assert re.search(r"GNU_STACK.* RW ", told), program
