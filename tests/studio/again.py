"""Repetition of tests of a held button, whose lease of 150 ms a busy machine may not renew."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING

from playwright.sync_api import Browser, Page

if TYPE_CHECKING:
    from collections.abc import Callable

TIMES = 4


def browser_of(fixtures: dict[str, object]) -> Browser:
    for fixture in fixtures.values():
        if isinstance(fixture, Browser):
            return fixture
        if isinstance(fixture, Page) and fixture.context.browser is not None:
            return fixture.context.browser
    raise TypeError("a test of a held button has a Browser or a Page")


def stood_still(browser: Browser) -> bool:
    """A page let go of what it held, since it stood still for longer than a lease."""
    pages = [page for context in browser.contexts for page in context.pages]
    told = [page.locator(".jogs [role=status]").all_inner_texts() for page in pages]
    return any("stood still" in text for texts in told for text in texts)


def let_go(page: Page) -> None:
    page.mouse.up()
    for key in ("ArrowRight", "ArrowLeft"):
        page.keyboard.up(key)


def again_where_it_stood_still(test: Callable[..., None]) -> Callable[..., None]:
    """A failure counts where no page stood still meanwhile, or where each repetition fails."""

    @functools.wraps(test)
    def run(**fixtures: object) -> None:
        browser = browser_of(fixtures)
        before = list(browser.contexts)
        for _ in range(TIMES):
            try:
                return test(**fixtures)
            except AssertionError:
                if not stood_still(browser):
                    raise
            for context in browser.contexts:
                if context not in before:
                    context.close()
            for context in before:
                for page in context.pages:
                    let_go(page)
        return test(**fixtures)

    return run
