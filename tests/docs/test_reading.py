"""Errors in a page are found."""

from __future__ import annotations

from typing import TYPE_CHECKING

from pages import Page, anchors, messages
from test_pages import VERB

if TYPE_CHECKING:
    from pathlib import Path


def page(folder: Path, text: str) -> Page:
    path = folder / "page.md"
    path.write_text(text, encoding="utf-8")
    return Page(path, text)


def test_headings_have_the_anchors_of_github(tmp_path: Path) -> None:
    text = "# A step: `rc10.step`\n## Names (and ids)\n## Names (and ids)\n## 手动 启动\n"
    text += "```\n# no heading\n```\n"
    found = anchors(page(tmp_path, text).path)
    assert found == {"a-step-rc10step", "names-and-ids", "names-and-ids-1", "手动-启动"}


def test_links_are_found_outside_of_code(tmp_path: Path) -> None:
    text = "[a](a.md#b) ![c](c.png) `[d](d.md)` [e](https://e)\n```\n[f](f.md)\n```\n"
    assert page(tmp_path, text).links == ["a.md#b", "c.png"]


def test_verbs_are_found_behind_options() -> None:
    assert VERB.findall("sudo rc10ctl --robot hero --json stats; rc10ctl list") == ["stats", "list"]
    assert VERB.findall("rc10ctl: enable: 0 of 1; rc10ctl --help") == []


def test_messages_are_the_code_of_first_cells(tmp_path: Path) -> None:
    text = "| `a …` | `b` |\n|---|---|\n| ``c `d` ``, `e` | f |\n\n`g`\n"
    assert messages(page(tmp_path, text)) == ["a …", "c `d` ", "e"]
