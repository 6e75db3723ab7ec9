"""Numbers of the protocol print as their words, and count as numbers."""

from __future__ import annotations

import pytest

from rc10.diagnostics import BusStatus
from rc10.events import Severity
from rc10.setpoints import Mode
from rc10.state import Acting, Condition, Limit, MotorStatus, RobotStatus, StopCause
from rc10.words import Word, WordSet


@pytest.mark.parametrize(
    "words", [BusStatus, Severity, Mode, Acting, MotorStatus, RobotStatus, StopCause]
)
def test_a_number_of_the_protocol_prints_as_its_word(words: type[Word]) -> None:
    for word in words:
        assert str(word) == f"{word}" == word.name
        assert f"{word:d}" == str(int(word))
        assert f"{word:>12}" == word.name.rjust(12)


@pytest.mark.parametrize("words", [Limit, Condition])
def test_a_set_prints_the_words_that_it_has(words: type[WordSet]) -> None:
    first, second = list(words)[:2]
    assert f"{words(0)}" == "none"
    assert str(first) == first.name
    assert str(first | second) == f"{first.name}|{second.name}"
    assert f"{first | second:d}" == str(int(first) + int(second))


def test_a_set_prints_bits_without_a_word_as_a_number() -> None:
    assert str(Limit(int(Limit.CURRENT) | 1 << 20)) == f"CURRENT|{1 << 20}"


def test_a_word_is_the_number_that_it_was() -> None:
    assert int(MotorStatus.ACTIVE) == 3
    assert {3: "on"}[MotorStatus.ACTIVE] == "on"
    assert MotorStatus(3) is MotorStatus.ACTIVE
