"""A misspelt word of a script is told with the word that was meant; nothing is done."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

REPO = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("test.sh hots", "test.sh: no part 'hots'; did you mean host?"),
        ("test.sh nightli", "test.sh: no part 'nightli'; did you mean nightly?"),
        ("test.sh gripper", "test.sh: no part 'gripper'\n"),
        ("install-deps.sh biuld", "install-deps: no group 'biuld'; did you mean build?"),
        ("demo.sh --second 3", "demo: no option '--second'; did you mean --seconds?"),
        ("demo.sh 10", "demo: no option '10'; did you mean --seconds 10?"),
        (
            "demo.sh --seconds abc",
            "--seconds takes a whole number of seconds, at most 999999, not 'abc'",
        ),
        ("demo.sh --seconds", "--seconds takes a whole number of seconds, at most 999999, not ''"),
        ("package.sh --am64", "package: no option '--am64'; did you mean --arm64?"),
        ("venv.sh clent", "venv: no part 'clent': usage: scripts/venv.sh [client]"),
        ("web.sh chek", "web: no part 'chek': usage: scripts/web.sh [check]"),
    ],
)
def test_the_word_that_was_meant_is_told(words: str, told: str) -> None:
    script, *rest = words.split()
    done = subprocess.run(
        [REPO / "scripts" / script, *rest], capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert told in done.stderr
