"""Names and words of strangers act on no terminal."""

from __future__ import annotations

import pytest

import rc10
from rc10.command_line import run
from rc10.printable import printable


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("front_left", "front_left"),
        ("Größe 3 左轮 🤖", "Größe 3 左轮 🤖"),
        ("\x1b[2Jhero", "?[2Jhero"),
        ("one\ntwo\r\tthree\0", "one?two??three?"),
        ("\x7f\x80\x9b31m", "???31m"),
        ("\u202ereversed\u2066\u061c\u200f", "?reversed???"),
        ("a\u2028b\u2029c", "a?b?c"),
        (b"caf\xe9".decode(errors="surrogateescape"), "caf?"),
        ("\ud83d", "?"),
    ],
)
def test_each_character_that_acts_is_a_question_mark(text: str, shown: str) -> None:
    assert printable(text) == shown
    shown.encode()  # any terminal takes it


def test_an_error_is_one_line_whatever_it_quotes() -> None:
    error = rc10.RequestRefused("enable", "wheel", "held by '\x1b]0;owned\x07\n2026 error'")
    assert str(error) == "enable wheel: refused: held by '?]0;owned??2026 error'"
    assert error.message == "held by '\x1b]0;owned\x07\n2026 error'"  # as it was said
    assert str(rc10.LinkError("no\nroute")) == "no?route"


def test_a_tool_ends_with_one_line_that_acts_on_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    def fail() -> None:
        raise OSError("several robots: \x1b[31mhero\n")

    with pytest.raises(SystemExit) as ended:
        run("stream", fail)
    assert ended.value.code == 1
    assert capsys.readouterr().err == "stream: several robots: ?[31mhero?\n"
