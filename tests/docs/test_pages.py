"""References of the pages lead somewhere."""

from __future__ import annotations

import fnmatch
import re
from itertools import zip_longest
from pathlib import Path

import pytest
from pages import (
    REPO,
    Page,
    anchors,
    columns,
    known_tests,
    messages,
    pages,
    read,
    source_texts,
)

VERB = re.compile(r"\brc10ctl(?: --json| --(?:robot|socket) \S+)* ([a-z][a-z-]*)\b(?![.:/=])")
PAGES = pages()
by_name = pytest.mark.parametrize("page", PAGES, ids=[page.name for page in PAGES])


@by_name
def test_every_link_leads_to_a_file_and_a_heading(page: Page) -> None:
    broken = []
    for link in page.links:
        file, _, anchor = link.partition("#")
        target = (page.path.parent / file).resolve() if file else page.path
        if not target.exists():
            broken.append(f"{link}: no such file")
        elif anchor and anchor not in anchors(target):
            broken.append(
                f"{link}: no such heading; there are {', '.join(sorted(anchors(target)))}"
            )
    assert broken == []


def verbs() -> set[str]:
    manual = (REPO / "docs/man/rc10ctl.1").read_text(encoding="utf-8").replace("\\-", "-")
    return set(re.findall(r"^(?:\.B |\\fB)([a-z][a-z-]*)", manual, re.M))


@by_name
def test_every_verb_of_rc10ctl_is_in_its_manual(page: Page) -> None:
    used = {verb for code in page.code for verb in VERB.findall(code)}
    assert used - verbs() == set()


def test_every_page_is_in_the_index() -> None:
    index = REPO / "docs/index.md"
    listed = {(index.parent / link.partition("#")[0]).resolve() for link in read(index).links}
    # A folder with a list of its own is listed there.
    for path in [path for path in listed if path.name == "README.md"]:
        links = read(path).links if path.is_relative_to(REPO / "docs") else []
        listed |= {(path.parent / link.partition("#")[0]).resolve() for link in links}
    written = {page.path for page in PAGES if page.path.is_relative_to(REPO / "docs")}
    assert written - listed - {index} == set()


def test_both_readmes_lead_to_the_index() -> None:
    assert "docs/index.md" in read(REPO / "README.md").links
    assert "docs/index.md" in read(REPO / "README.zh-CN.md").links


def test_first_pages_are_read_in_minutes() -> None:
    assert len((REPO / "ARCHITECTURE.md").read_text(encoding="utf-8").split()) <= 1500
    assert len((REPO / "README.md").read_text(encoding="utf-8").splitlines()) <= 150


TRANSLATED = [page for page in PAGES if page.name.endswith(".zh-CN.md")]


def original_of(page: Page) -> Page:
    return read(page.path.with_name(page.path.name.replace(".zh-CN", "")))


by_translation = pytest.mark.parametrize("page", TRANSLATED, ids=[page.name for page in TRANSLATED])


def differences(page: Page, original: Page) -> list[str]:
    """Headings, code and tables that one of two languages has, and the other has not."""
    found = []
    if page.outline != original.outline:
        found.append(f"headings {page.outline}, not {original.outline}")
    if page.shell != original.shell:
        found.append(f"commands {page.shell}, not {original.shell}")
    for mine, its in zip_longest(page.other_code, original.other_code):
        if mine != its:
            found.append(f"code {mine!r}, not {its!r}")
    for number, (mine, its) in enumerate(zip_longest(page.tables, original.tables, fillvalue=[])):
        for row, (one, other) in enumerate(zip_longest(mine, its)):
            if one != other:
                found.append(f"table {number + 1}, row {row + 1}: {one}, not {other}")
    return found


@by_translation
def test_a_translation_has_the_headings_code_and_tables_of_its_original(page: Page) -> None:
    assert differences(page, original_of(page)) == []


@by_translation
def test_a_page_leads_to_its_other_language(page: Page) -> None:
    assert page.path.name.replace(".zh-CN", "") in page.links


def test_what_a_reader_of_chinese_needs_is_there_in_chinese() -> None:
    names = {page.path.name.removesuffix(".zh-CN.md") for page in TRANSLATED}
    assert names >= {
        "README",
        "quick-start",
        "first-motor",
        "studio",
        "porting-from-stm32",
        "robot-programs",
        "python",
        "tuning",
        "troubleshooting",
        "safety",
        "modules",
        "serial-devices",
    }


@pytest.mark.parametrize(
    ("there", "here"),
    [
        ("# A\n## B\n", "# A\n"),
        ("```sh\nrc10ctl list\n```\n", "```sh\nrc10ctl state\n```\n"),
        ("```yaml\nid: 1\n```\n", "```yaml\nid: 2\n```\n"),
        ("| a | b |\n|---|---|\n| `x` | y |\n", "| a | b |\n|---|---|\n| `z` | y |\n"),
        ("| a | b |\n|---|---|\n| x | y |\n", "| a | b |\n|---|---|\n"),
        ("| a | b |\n|---|---|\n", "| a |\n|---|\n"),
    ],
    ids=["heading", "command", "code", "code in a table", "row", "column"],
)
def test_a_difference_between_two_languages_is_found(there: str, here: str) -> None:
    path = REPO / "docs/page.md"
    assert differences(Page(path, here), Page(path, there)) != []


def test_words_and_comments_may_differ() -> None:
    path = REPO / "docs/page.md"
    there = "# A\n```yaml\nid: 1  # one\n```\n| `x` | word |\n|---|---|\n"
    here = "# 甲\n```yaml\nid: 1  # 一\n```\n| `x` | 词 |\n|---|---|\n"
    assert differences(Page(path, here), Page(path, there)) == []


def test_a_translation_has_the_robots_of_its_original() -> None:
    assert len(TRANSLATED) >= 3
    for page in TRANSLATED:
        original = original_of(page)
        without_comments = [re.sub(r" *#.*", "", text) for text in original.fences("yaml")]
        assert [re.sub(r" *#.*", "", text) for text in page.fences("yaml")] == without_comments


def test_troubleshooting_quotes_messages_that_exist() -> None:
    quoted = messages(read(REPO / "docs/troubleshooting.md"))
    assert len(quoted) > 50
    pieces = [piece.strip() for message in quoted for piece in re.split("…|: ", message)]
    unknown = [piece for piece in pieces if len(piece) > 2 and piece not in source_texts()]
    assert unknown == []


def constants(prefix: str) -> dict[str, int]:
    """Those of the LCM types whose names begin so, by the rest of the name."""
    texts = [path.read_text(encoding="utf-8") for path in (REPO / "lcm_types").glob("*.lcm")]
    found = [re.findall(rf"\bconst \w+ {prefix}_(\w+) *= *(\d+);", text) for text in texts]
    return {name: int(number) for pairs in found for name, number in pairs}


@pytest.mark.parametrize("prefix", ["ACTING", "CONDITION", "LIMIT", "MODE", "STATE", "STATUS"])
def test_the_contract_has_the_word_of_each_constant(prefix: str) -> None:
    words = set(re.findall(r"[A-Za-z][A-Za-z_-]+", read(REPO / "docs/lcm.md").text))
    names = constants(prefix)
    assert names
    # States of a bus are the words of `rc10ctl`.
    of_bus = {name for name in names if name.replace("_", "-").lower() in words}
    assert set(names) - words - (of_bus if prefix == "STATE" else set()) == set()


def test_the_contract_has_the_number_of_each_cause_of_a_stop() -> None:
    table = read(REPO / "docs/lcm.md").text.partition("| `stop_cause` |")[2].partition("\n\n")[0]
    numbers = {int(number) for number in re.findall(r"^\| (\d+) \|", table, re.M)}
    assert numbers == set(constants("STOP").values())


def missing_tests(page: Page) -> list[str]:
    """Those that the page names, and nobody wrote. It may leave out the suite, or end in `*`."""
    shaped = r"(\w+/)?[A-Z]\w*\*?\.[A-Z*][\w*/]*|test_\w+\*?|tests/\S+\.py"
    said = columns(page, "test") + [code for code in page.code if re.fullmatch(shaped, code)]
    known = known_tests()
    short = known | {name.partition(".")[2] for name in known}
    return [name for name in dict.fromkeys(said) if not fnmatch.filter(short, name)]


def test_every_test_that_proves_safety_exists() -> None:
    page = read(REPO / "docs/safety.md")
    assert len(columns(page, "test")) > 150
    assert missing_tests(page) == []
    changed = page.text.replace("`RestCheckTest.*`", "`RestChekTest.*`")
    assert missing_tests(Page(page.path, changed)) == ["RestChekTest.*"]


@by_name
def test_every_command_is_run_by_a_test_or_needs_hardware(page: Page) -> None:
    name = Path(page.name.replace(".zh-CN", "")).name
    for how, _ in page.shell:
        note = how.partition(" ")[2]
        if note not in ("", "hardware"):
            assert name in (REPO / note).read_text(encoding="utf-8"), f"{note} reads no {name}"


@by_name
def test_commands_behind_a_prompt_are_in_a_block_for_a_console(page: Page) -> None:
    assert [text for text in page.fences("") if re.search(r"^\$ ", text, re.M)] == []


def test_nothing_stands_twice_in_the_changelog() -> None:
    lines = [
        line for line in read(REPO / "CHANGELOG.md").text.splitlines() if line.startswith("- ")
    ]
    assert [line for line in set(lines) if lines.count(line) > 1] == []
