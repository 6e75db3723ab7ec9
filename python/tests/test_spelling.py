"""A misspelt word is told with the word that was meant."""

from __future__ import annotations

import subprocess
import sys

import pytest

from rc10.spelling import did_you_mean


@pytest.mark.parametrize(
    ("typed", "told"),
    [
        ("whel", "; did you mean wheel?"),
        ("WHEEL", "; did you mean wheel?"),
        ("front-left", "; did you mean front_left?"),
        ("gripper", ""),
    ],
)
def test_the_nearest_name_is_suggested(typed: str, told: str) -> None:
    assert did_you_mean(typed, ["wheel", "front_left"]) == told


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("rc10.step wheel velocty 3", "did you mean velocity?"),
        ("rc10.step wheel velocity 3 --enabel", "no option '--enabel'; did you mean --enable?"),
        ("rc10.plot --secnds 3", "no option '--secnds'; did you mean --seconds?"),
        ("rc10.stream --vofo udp://a:1 a.target", "did you mean --vofa?"),
        ("rc10.export a.log --only msap", "did you mean mcap?"),
        ("rc10.fakes --motr M3508:1", "did you mean --motor?"),
        ("rc10.fakes --motor M350:1", "did you mean M3508?"),
        ("rc10.fakes --motor DM431:1", "did you mean DM4310?"),
        ("rc10.fakes --motor ODrive_S2:1", "did you mean ODrive_S1?"),
        ("rc10.fakes --motor RMD-X8-2:1", "did you mean RMD-X8-2"),
        ("rc10.fakes --motor AK80-7:1", "did you mean AK80-"),
        ("rc10.fakes --motor AK80-9:1:servoo", "did you mean servo?"),
    ],
)
def test_a_tool_suggests_what_was_meant(words: str, told: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", *words.split()], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert told in done.stderr


def test_the_beginning_of_an_option_is_the_option() -> None:
    done = subprocess.run(
        [sys.executable, "-m", "rc10.plot", "--sec", "x"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert "argument --seconds: invalid float value: 'x'" in done.stderr
