"""References of the pages lead somewhere."""

from __future__ import annotations

import fnmatch
import re
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


TRANSLATED = [page for page in PAGES if page.name.endswith(".zh-CN.md")]


def original_of(page: Page) -> Page:
    return read(page.path.with_name(page.path.name.replace(".zh-CN", "")))


def test_a_translation_has_the_commands_of_its_original() -> None:
    assert len(TRANSLATED) >= 3
    for page in TRANSLATED:
        assert page.shell == original_of(page).shell, page.name


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
