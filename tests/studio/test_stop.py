"""STOP: in reach of everybody, and no more is said of it than is known."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from hostlib.stalls import stood_still_since
from playwright.sync_api import Page, expect

from conftest import Studio


@contextmanager
def standing_still(pid: int) -> Iterator[None]:
    """The process says nothing, and its connections stay open, as behind a cable that is out."""
    os.kill(pid, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(pid, signal.SIGCONT)


@pytest.mark.parametrize("way", ["Space", "Enter", "a click without a pointer"])
def test_stop_needs_no_pointer(page: Page, studio: Studio, way: str) -> None:
    stop = page.get_by_role("button", name="STOP")
    if way in ("Space", "Enter"):
        stop.press(way)
    else:  # of a screen reader, or by voice
        stop.evaluate("button => button.click()")
    studio.daemon.wait_state(lambda state: state["state"] == "ESTOP", "it is stopped")
    expect(page.locator(".stop-told")).to_have_text("stopped: confirmed")


def test_a_robot_that_is_stopped_again_is_confirmed_again(page: Page, studio: Studio) -> None:
    told = page.locator(".stop-told")
    for _ in range(2):
        page.get_by_role("button", name="STOP").click()
        expect(told).to_have_text("stopped: confirmed")
    studio.daemon.must("clear")
    expect(told).to_have_text("")


def test_escape_twice_stops_in_the_editor_too(page: Page, studio: Studio) -> None:
    page.locator("#tab-configuration").click()
    page.locator(".cm-line").first.click()
    for _ in range(5):
        begin_s = time.monotonic()
        for _ in range(2):
            page.keyboard.press("Escape")
        page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
        # Nothing: they were too far apart.
        asked = page.locator(".stop-told").inner_text() != ""
        if asked or not stood_still_since(begin_s, "a key that is pressed twice"):
            break
    studio.daemon.wait_state(lambda state: state["state"] == "ESTOP", "it is stopped")


def test_of_an_rc10d_that_stands_still_nothing_old_is_shown(page: Page, studio: Studio) -> None:
    badge = page.locator(".badge.connection")
    studio.daemon.must("estop")
    expect(page.locator(".stop-told")).to_have_text("stopped: confirmed")
    with standing_still(studio.daemon.pid):
        expect(badge).to_have_text("no word from rc10d")
        expect(page.locator(".badge.robot")).to_have_count(0)
        expect(page.locator(".stop-told")).to_have_text("")
        expect(page.locator(".card.motor")).to_have_count(0)
        page.locator("#tab-match").click()
        expect(page.locator(".verdict")).to_have_text("✗ Nothing is known of the robot")
        page.get_by_role("button", name="STOP").click()
        expect(page.locator(".stop-told")).to_have_text(
            "NOT CONFIRMED: use the real emergency stop"
        )
    expect(badge).to_have_text("live")
    expect(page.locator(".stop-told")).to_have_text("stopped: confirmed")


def test_a_silent_network_is_no_connection_and_comes_back_by_itself(
    page: Page, studio: Studio
) -> None:
    badge = page.locator(".badge.connection")
    with standing_still(studio.web.pid):
        expect(badge).to_have_text("no connection to rc10-web")
        expect(page.locator(".card.motor")).to_have_count(0)
    expect(badge).to_have_text("live")
    expect(page.get_by_role("article", name="wheel", exact=True)).to_be_visible()
