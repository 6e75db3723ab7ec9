"""The part "Configuration", where the robot allows its root helper to a page."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from pathlib import Path

import pytest
from hostlib.file_helper import FileHelper
from playwright.sync_api import Page, expect

from conftest import Studio


@pytest.fixture
def helper(tmp_path: Path) -> Iterator[FileHelper]:
    with FileHelper(tmp_path / "config.socket") as helper:
        yield helper


@pytest.fixture
def words(helper: FileHelper) -> tuple[str, ...]:
    return ("--config-socket", str(helper.path))


def test_a_changed_file_is_installed_over_the_one_that_was_shown(
    page: Page, studio: Studio, helper: FileHelper
) -> None:
    page.locator("#tab-configuration").click()
    page.get_by_text("To install it").click()
    install = page.get_by_role("button", name="Install on the robot")
    editor = page.get_by_label("Text of the configuration")
    expect(editor).to_contain_text("robot: host")
    shown = studio.daemon.config.read_text()
    editor.focus()
    page.keyboard.press("Control+End")
    # Nothing that rc10d refuses goes to the helper.
    page.keyboard.type("wheels: 4")
    expect(install).to_be_disabled()
    for _ in "wheels: 4":
        page.keyboard.press("Backspace")
    page.keyboard.type("# tuned")
    expect(page.get_by_text("changed", exact=True)).to_be_visible()
    expect(install).to_be_enabled()
    helper.answer = "done\n/etc/rc10d/robot.yaml is written"
    install.click()
    expect(page.get_by_text("/etc/rc10d/robot.yaml is written")).to_be_visible()
    expect(page.get_by_text("changed", exact=True)).to_have_count(0)
    first = helper.requests[-1]
    assert (first.verb, first.robot) == ("install", "host")
    assert first.replaces == hashlib.sha256(shown.encode()).hexdigest()
    assert first.text.endswith("# tuned")
    # The next one is over this one.
    editor.focus()
    page.keyboard.type("!")
    expect(page.get_by_text("changed", exact=True)).to_be_visible()
    expect(install).to_be_enabled()
    install.click()
    expect(page.get_by_text("changed", exact=True)).to_have_count(0)
    assert helper.requests[-1].replaces == hashlib.sha256(first.text.encode()).hexdigest()


def test_a_restart_that_is_refused_says_why(page: Page, helper: FileHelper) -> None:
    page.locator("#tab-configuration").click()
    page.get_by_text("To install it").click()
    helper.answer = "refused\nmotor 'wheel' is ACTIVE: a restart would let it go"
    page.get_by_role("button", name="Restart rc10d").click()
    expect(page.get_by_role("alert")).to_contain_text("motor 'wheel' is ACTIVE")
    assert helper.requests[-1].verb == "restart"
