"""The page in a real Chromium, against a running rc10d: see scripts/test/web.sh."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from hostlib import Daemon, Program, check_environment
from hostlib.daemon import BIN, CONFIG, REPO
from playwright.sync_api import Browser, Locator, Page, Playwright, expect, sync_playwright
from recorded import Box, record

# Debian's Chromium, which asks nobody on the internet for anything.
CHROMIUM = "/usr/bin/chromium"
QUIET = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
PATIENCE_MS = 20_000.0
expect.set_options(timeout=PATIENCE_MS)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    reason = check_environment()
    for item in items:
        if reason is not None:
            item.add_marker(pytest.mark.skip(reason=reason))


class Studio:
    """rc10d, rc10-web, and the address of the page."""

    def __init__(self, daemon: Daemon, *words: str) -> None:
        self.daemon = daemon
        self.words = words
        self.start()

    def start(self, port: int = 0) -> None:
        self.web = Program(
            BIN / "rc10-web",
            "--page",
            REPO / "build" / "web",
            "--port",
            str(port),
            *self.words,
            env=self.daemon.env,
        )
        told = self.web.wait_line(r"http://[^:]+:(\d+)/(?:#\w+)?$")
        self.port = int(told[1])
        self.url = f"http://localhost:{self.port}/"


@pytest.fixture
def words() -> tuple[str, ...]:
    """More words for rc10-web: a file of tests may have others."""
    return ()


@pytest.fixture
def robot() -> str:
    """The robot's file: a file of tests may have another."""
    return CONFIG.format(realtime="preferred")


@pytest.fixture
def studio(words: tuple[str, ...], robot: str) -> Iterator[Studio]:
    with Daemon(robot) as daemon:
        daemon.wait_ready()
        running = Studio(daemon, *words)
        yield running
        running.web.stop()


@pytest.fixture(scope="session")
def playwright() -> Iterator[Playwright]:
    assert Path(CHROMIUM).exists(), "scripts/install-deps.sh web"
    with sync_playwright() as playwright:
        yield playwright


@pytest.fixture(scope="session")
def chromium(playwright: Playwright) -> Iterator[Browser]:
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=[*QUIET])
    yield browser
    browser.close()


# Complaints of the browser about a page: scripts and styles that its policy forbids, failures.
EXPECTED = re.compile(r"WebSocket connection|ERR_CONNECTION_REFUSED")


@pytest.fixture(scope="session")
def box() -> Box:
    """The recording that the tests of the black box read, damage and forge."""
    return record()


@contextlib.contextmanager
def opened_page(chromium: Browser, studio: Studio) -> Iterator[Page]:
    """The page; nothing in it may have gone wrong at the end."""
    context = chromium.new_context(viewport={"width": 1280, "height": 860}, locale="en-GB")
    context.set_default_timeout(PATIENCE_MS)
    opened = context.new_page()
    problems: list[str] = []
    opened.on("pageerror", lambda error: problems.append(str(error)))
    opened.on(
        "console",
        lambda message: problems.append(message.text) if message.type == "error" else None,
    )
    opened.goto(studio.url)
    yield opened
    context.close()
    assert [text for text in problems if not EXPECTED.search(text)] == []


@pytest.fixture
def page(chromium: Browser, studio: Studio) -> Iterator[Page]:
    """The page, open, of a robot that runs."""
    with opened_page(chromium, studio) as opened:
        opened.get_by_role("article", name="wheel").wait_for()
        yield opened


@pytest.fixture
def card(page: Page) -> Locator:
    """The step of the part "Commission" that is open."""
    page.locator("#tab-commission").click()
    return page.locator(".card.step")


@pytest.fixture
def moving(page: Page, studio: Studio) -> Page:
    """The part "Move" with yaw, which is ACTIVE."""
    page.locator("#tab-move").click()
    page.get_by_label("Motor").select_option("yaw")
    studio.daemon.must("enable", "yaw")
    expect(page.locator(".badge.status")).to_have_text("ACTIVE")
    return page
