"""Mutants: which are taken, which are known as equivalent, and which of those are no more."""

from __future__ import annotations

import argparse

import pytest
from mutants import (
    FILES,
    REPO,
    Mutant,
    as_written,
    difference,
    equivalent,
    part_of,
    sample_of,
    shown,
    stale,
)

ORIGINAL = "int a = 1;  // one\nint b = 2;\nint c = 3;\n"


def mutant(before: str, after: str, file: str = "a.cpp") -> Mutant:
    return Mutant(file, 1, before, after, "")


def test_a_difference_is_the_line_that_changed_without_blanks_and_comments() -> None:
    changed = ORIGINAL.replace("int b = 2;", "  int b = 3;  // two")
    assert difference(ORIGINAL, changed) == (2, "int b = 2;", "int b = 3;")
    assert difference(ORIGINAL, ORIGINAL.replace("a = 1", "a = -1")) == (
        1,
        "int a = 1;",
        "int a = -1;",
    )


@pytest.mark.parametrize(
    "text",
    [
        ORIGINAL,
        ORIGINAL.replace("// one", "// uno"),
        ORIGINAL.replace("int b", "   int b"),
        ORIGINAL.replace("// one", "// 1"),
        ORIGINAL + "int d = 4;\n",
    ],
)
def test_blanks_comments_and_added_lines_are_no_mutants(text: str) -> None:
    assert difference(ORIGINAL, text) is None


def test_a_line_that_is_taken_away_is_a_mutant() -> None:
    assert difference(ORIGINAL, ORIGINAL.replace("int b = 2;\n", "")) == (2, "int b = 2;", "")


# universalmutator mutates nothing behind a {-.
def test_a_brace_before_a_minus_is_hidden_and_comes_back() -> None:
    text = "Duration d{-1};\nint e = f(Envelope{-kNone, kNone});\n"
    assert "{-" not in shown(text)
    assert len(shown(text).splitlines()) == len(text.splitlines())
    assert as_written(shown(text)) == text
    for file in FILES:
        original = (REPO / file).read_text(encoding="utf-8")
        assert as_written(shown(original)) == original, file


def test_a_known_mutant_is_stale_when_its_line_is_another_or_in_another_file() -> None:
    text = "# comment\n\na.cpp\tx < 1\tx <= 1\tnever 1\nb.cpp\ty\tz\treason\n"
    known = equivalent(text)
    assert known == {("a.cpp", "x < 1", "x <= 1"), ("b.cpp", "y", "z")}
    both = [mutant("x < 1", "x <= 1"), mutant("y", "z", "b.cpp"), mutant("v", "w")]
    assert stale(known, both) == []
    assert stale(known, both[1:]) == [("a.cpp", "x < 1", "x <= 1")]
    assert stale(known, [both[0], mutant("y", "z", "c.cpp")]) == [("b.cpp", "y", "z")]


def test_equivalent_mutants_are_of_lines_that_are_there() -> None:
    text = (REPO / "tests/mutants/equivalent.txt").read_text(encoding="utf-8")
    for file, before, _ in equivalent(text):
        assert file in FILES
        lines = (REPO / file).read_text(encoding="utf-8").splitlines()
        assert before in {line.split("//")[0].strip() for line in lines}, (file, before)


def test_a_sample_is_the_same_by_seed_whatever_else_there_is() -> None:
    candidates = [mutant(f"x = {i}", f"x = {i + 1}") for i in range(100)]
    sample = sample_of(candidates, 1, 20)
    assert len(set(sample)) == 20
    assert sample_of(candidates[::-1], 1, 20) == sample
    assert sample_of(candidates, 2, 20) != sample
    # Others that are added push some out, and change no order.
    more = sample_of([*candidates, *(mutant(f"y = {i}", "") for i in range(20))], 1, 20)
    kept = [each for each in more if each in candidates]
    assert kept == sample[: len(kept)]
    assert len(kept) > 10
    assert sample_of(candidates, 1, 1000) == sample_of(candidates, 1, 100)


def test_a_part_is_one_of_several() -> None:
    assert part_of("2/3") == (2, 3)
    for wrong in ("0/3", "4/3", "2", "a/b", "1/-1"):
        with pytest.raises(argparse.ArgumentTypeError, match="give K/N"):
            part_of(wrong)
