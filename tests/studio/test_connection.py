"""The connection of the page, against a server of the test's own and with a clock that it turns."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import expect

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser, Page

    from conftest import Studio

# A server that is there or not; it greets, and answers each beat.
SERVER = """
    window.serverIsThere = false;
    window.sockets = [];
    window.WebSocket = class {
        static OPEN = 1;
        readyState = 0;
        constructor() {
            sockets.push(this);
            setTimeout(() => {
                this.readyState = serverIsThere ? 1 : 3;
                if (!serverIsThere) return this.onclose?.();
                this.onopen?.();
                this.say({type: 'hello', protocol: 3, version: '', right: 'look', name: 'web-1'});
            }, 10);
        }
        say(message) { this.onmessage?.({data: JSON.stringify(message)}); }
        send(text) {
            if (JSON.parse(text).type === 'clock') setTimeout(() => this.say({type: 'clock'}), 1);
        }
        close() { this.readyState = 3; }
    };
"""


@pytest.fixture
def lonely(chromium: Browser, studio: Studio) -> Iterator[Page]:
    """The page, whose files alone come from rc10-web."""
    context = chromium.new_context()
    page = context.new_page()
    page.add_init_script(SERVER)
    page.clock.install()
    page.goto(studio.url)
    page.locator(".badge.connection").wait_for()
    yield page
    context.close()


def open_sockets(page: Page) -> int:
    found: int = page.evaluate("sockets.filter((socket) => socket.readyState === 1).length")
    return found


@pytest.mark.parametrize("away_s", [1, 20, 600])
def test_a_server_that_was_away_gets_one_connection(lonely: Page, away_s: int) -> None:
    lonely.clock.run_for(away_s * 1000)
    assert open_sockets(lonely) == 0
    tried: int = lonely.evaluate("sockets.length")
    # Each pause is at most 5 s, and never shorter than half of one but for the first ones.
    assert away_s / 6 <= tried <= away_s / 5 + 6
    lonely.evaluate("serverIsThere = true")
    lonely.clock.run_for(30_000)
    assert open_sockets(lonely) == 1
    assert lonely.locator(".badge.connection").inner_text() == "live"


def test_a_server_that_falls_silent_is_left_for_one_new_connection(lonely: Page) -> None:
    lonely.evaluate("serverIsThere = true")
    lonely.clock.run_for(6_000)
    assert open_sockets(lonely) == 1
    lonely.evaluate("sockets.at(-1).send = () => {}")
    lonely.clock.run_for(10_000)
    assert open_sockets(lonely) == 1
    assert lonely.evaluate("sockets.filter((socket) => socket.readyState === 3).length") >= 1


def test_a_computer_that_slept_gets_a_new_connection(lonely: Page) -> None:
    """Its messages would seem to be late by as long as it slept."""
    lonely.evaluate("serverIsThere = true")
    lonely.clock.run_for(6_000)
    assert open_sockets(lonely) == 1
    before: int = lonely.evaluate("sockets.length")
    lonely.evaluate("{ const now = Date.now; Date.now = () => now() + 60_000; }")
    lonely.clock.run_for(6_000)
    assert open_sockets(lonely) == 1
    assert lonely.evaluate("sockets.length") == before + 1


def test_each_view_of_a_page_has_a_number_of_its_own(page: Page) -> None:
    views: list[int] = []

    def note(payload: str | bytes) -> None:
        told = json.loads(payload)
        if told["type"] == "view":
            views.append(told["view"])

    with page.expect_websocket() as connection:
        page.reload()
    connection.value.on("framesent", note)
    for part in ("plots", "move", "tune", "plots"):
        page.locator(f"#tab-{part}").click()
        expect(page.locator(".plot > .legend td.number").last).not_to_contain_text("\N{EN DASH}")
    # Each part has a view, and ends it.
    assert len(views) >= 7
    assert views == sorted(set(views))
