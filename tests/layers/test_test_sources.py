"""Each source with tests of GoogleTest is one that tests/CMakeLists.txt compiles."""

from __future__ import annotations

import re
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
TESTS = REPO / "tests"
# Not of this tree's programs: an old release's, and those of an installed prefix.
ELSEWHERE = {"package", "install"}
MACRO = re.compile(r"^(TYPED_)?TEST(_[FP])?\(", re.MULTILINE)


def layers() -> set[str]:
    text = (TESTS / "CMakeLists.txt").read_text()
    loop = re.search(r"foreach\(layer ([\w ]+)\)", text)
    assert loop is not None
    return {*loop[1].split(), *re.findall(r"rc10_layer_test\((\w+)", text)} - {"layer"}


def is_compiled(source: Path) -> bool:
    """By the globs of rc10_layer_test()."""
    folder, *rooms, name = source.relative_to(TESTS).parts
    return folder in layers() and len(rooms) <= 1 and name.endswith("_test.cpp")


def test_no_test_is_left_out_of_the_build() -> None:
    with_tests = [
        source
        for source in TESTS.rglob("*.cpp")
        if source.relative_to(TESTS).parts[0] not in ELSEWHERE
        and MACRO.search(source.read_text(errors="replace"))
    ]
    assert len(with_tests) > 300
    assert [source for source in with_tests if not is_compiled(source)] == []


def test_a_file_of_another_name_or_place_is_seen() -> None:
    assert is_compiled(TESTS / "motor" / "guarding" / "a_test.cpp")
    for place in ("motor/a_tests.cpp", "motor/guarding/deep/a_test.cpp", "new/a_test.cpp"):
        assert not is_compiled(TESTS / place)
