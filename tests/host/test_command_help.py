"""Man pages know each option of their program; that of rc10ctl and its completion each verb."""

from __future__ import annotations

import os
import re
import subprocess
from typing import TYPE_CHECKING

import pytest
from hostlib.command_help import help_of, verbs
from hostlib.daemon import BIN, REPO

if TYPE_CHECKING:
    from hostlib import Daemon

MAN = REPO / "docs" / "man"
# All that are installed.
PROGRAMS = (
    "rc10d",
    "rc10-lcm",
    "rc10ctl",
    "rc10-stop",
    "rc10-guard",
    "rc10-irq",
    "rc10-sim",
    "rc10-web",
)
COMPLETION = REPO / "completions" / "rc10ctl.bash"


def page_of(program: str) -> str:
    return (MAN / f"{program}.1").read_text().replace("\\-", "-")


def options(*words: str, program: str = "rc10ctl") -> set[str]:
    """Long options: each begins a line, or follows a short or another one there."""
    lines = re.findall(
        r"^ +((?:-\w, ?)?--[a-z].*)$", help_of(*words, program=program), re.MULTILINE
    )
    found = {
        option
        for line in lines
        for option in re.findall(r"--[a-z][a-z-]*", re.split(r" {2,}", line)[0])
    }
    return found - {"--help"}


def complete(*words: str, env: dict[str, str] | None = None) -> list[str]:
    """Completions of bash for the last word."""
    program = [str(BIN / "rc10ctl"), *words]
    quoted = " ".join(f"'{word}'" for word in program)
    script = (
        f"source '{COMPLETION}'; COMP_WORDS=({quoted}); COMP_CWORD={len(words)}; "
        "_rc10ctl; printf '%s\\n' \"${COMPREPLY[@]}\""
    )
    done = subprocess.run(
        ["bash", "-c", script],
        capture_output=True,
        text=True,
        check=True,
        env={**os.environ, **(env or {})},
    )
    assert not done.stderr
    return done.stdout.split()


def test_there_are_the_verbs() -> None:
    assert {"list", "watch", "doctor", "scan", "jog", "commission"} <= set(verbs())


@pytest.mark.parametrize("verb", ["", *verbs()])
def test_the_man_page_has_each_verb_with_its_options(verb: str) -> None:
    page = page_of("rc10ctl")
    words = [verb] if verb else []
    if verb:
        assert re.search(rf"^(\\fB|\.B ){verb}\b", page, re.MULTILINE), verb
    for option in options(*words):
        assert re.search(rf"{option}\b", page), f"{verb} {option}"


@pytest.mark.parametrize("program", PROGRAMS)
def test_the_man_page_has_each_option_of_its_program(program: str) -> None:
    page = page_of(program)
    named = options(program=program)
    assert "--version" in named
    for option in named:
        assert re.search(rf"{option}\b", page), option


def test_each_installed_program_has_its_man_page() -> None:
    installed = re.search(
        r"install\(TARGETS (.*?) RUNTIME", (REPO / "cmake/Install.cmake").read_text()
    )
    assert installed
    assert tuple(installed[1].split()) == PROGRAMS
    assert {page.stem for page in MAN.iterdir()} == set(PROGRAMS)


@pytest.mark.parametrize("program", PROGRAMS)
def test_the_man_page_is_good_roff(program: str) -> None:
    done = subprocess.run(
        ["groff", "-man", "-Tutf8", "-ww", MAN / f"{program}.1"],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stderr == ""
    assert program in done.stdout.replace("\u2010", "-")


def test_every_verb_is_completed() -> None:
    assert set(complete("")) == set(verbs())
    assert complete("doc") == ["doctor"]


def test_options_of_a_verb_are_completed() -> None:
    assert options("watch") <= set(complete("watch", "--"))
    assert complete("doctor", "--lat") == ["--latency-seconds"]


def test_motors_of_the_running_robot_are_completed(daemon: Daemon) -> None:
    assert complete("enable", "", env=daemon.env) == ["wheel", "other", "yaw"]
    assert complete("set", "wheel", "vel", env=daemon.env) == ["velocity"]
    assert complete("gains", "w", env=daemon.env) == ["wheel"]
    assert complete("gains", "wheel", "angle_pid.kp", env=daemon.env) == [
        "angle_pid.kp_rpm_per_deg="
    ]


def test_without_rc10d_the_way_to_start_it_is_told() -> None:
    for verb in (
        ["list"],
        ["stats"],
        ["watch"],
        ["enable"],
        ["gains", "x"],
        ["jog", "x"],
        ["commission", "x"],
    ):
        done = subprocess.run(
            [BIN / "rc10ctl", *verb, "--robot", "nobody"],
            capture_output=True,
            text=True,
            check=False,
            stdin=subprocess.DEVNULL,
        )
        assert done.returncode == 3, verb
        assert "systemctl start rc10d" in done.stderr
