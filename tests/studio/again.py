"""Repetition of tests of a held button, whose lease of 150 ms a busy machine may not renew."""

from __future__ import annotations

import functools
import re
import time
from typing import TYPE_CHECKING

from hostlib.stalls import stood_still_since
from playwright.sync_api import Browser, Error, Locator, Page

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


# By word of the page or of rc10-web: it stood still for longer than a lease, or one of them or
# rc10d did.
BY_ITSELF = re.compile(
    "stood still|connection was lost|does not take this page|no word of this page|does not answer"
)


def let_go_by_itself(page: Page) -> Locator:
    """Words of a page on a hold that the machine has ended; they stay until the next one."""
    return page.locator(".jogs [role=status]", has_text=BY_ITSELF)


def any_let_go_by_itself(browser: Browser) -> bool:
    pages = [page for context in browser.contexts for page in context.pages]
    return any(let_go_by_itself(page).count() for page in pages)


def let_go(page: Page) -> None:
    page.mouse.up()
    for key in ("ArrowRight", "ArrowLeft"):
        page.keyboard.up(key)


def again_where_it_let_go_by_itself(test: Callable[..., None]) -> Callable[..., None]:
    """A failure counts unless the page says that the machine ended a hold, and it did stand still.

    So does that of the last repetition.
    """

    @functools.wraps(test)
    def run(**fixtures: object) -> None:
        browser = browser_of(fixtures)
        before = list(browser.contexts)
        for _ in range(TIMES):
            begin_s = time.monotonic()
            try:
                return test(**fixtures)
            except (AssertionError, Error):
                if not any_let_go_by_itself(browser):
                    raise
                if not stood_still_since(begin_s, test.__name__):
                    raise
            for context in browser.contexts:
                if context not in before:
                    context.close()
            for context in before:
                for page in context.pages:
                    let_go(page)
        return test(**fixtures)

    return run
