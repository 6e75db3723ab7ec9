"""`clients` of the robot's file, by the token that a page shows."""

from __future__ import annotations

import hashlib

import pytest
from again import again_where_it_let_go_by_itself
from hostlib.daemon import CONFIG
from playwright.sync_api import Browser, Page, expect

from conftest import PATIENCE_MS, Studio

TOKEN = "wheelsonly22222222222222222222ab"
CONFIGURES = "configures3333333333333333333333"
HASHES = [hashlib.sha256(token.encode()).hexdigest() for token in (TOKEN, CONFIGURES)]
CLIENTS = f"""
clients:
  - {{token: {HASHES[0]}, may: [command], motors: [wheel]}}
  - {{token: {HASHES[1]}, may: [configure]}}
"""


@pytest.fixture
def robot() -> str:
    return CONFIG.format(realtime="preferred") + CLIENTS


def opened(chromium: Browser, url: str) -> Page:
    context = chromium.new_context(viewport={"width": 1280, "height": 860}, locale="en-GB")
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.goto(url)
    page.get_by_role("article", name="wheel", exact=True).wait_for()
    return page


def enable(page: Page, motor: str) -> None:
    card = page.get_by_role("article", name=motor, exact=True)
    card.get_by_role("button", name="Enable", exact=True).click()


def test_a_page_has_the_rights_of_its_token_and_without_one_it_looks_and_stops(
    chromium: Browser, studio: Studio
) -> None:
    without = opened(chromium, studio.url)
    enable(without, "wheel")
    refused = without.get_by_role("article", name="wheel", exact=True).get_by_role("alert")
    expect(refused).to_contain_text("may observe and stop, not command wheel")
    shows = opened(chromium, f"{studio.url}#{TOKEN}")
    enable(shows, "wheel")
    studio.daemon.wait_motor("wheel", lambda motor: motor["status"] == "ACTIVE", "enabled")
    enable(shows, "yaw")
    refused = shows.get_by_role("article", name="yaw", exact=True).get_by_role("alert")
    expect(refused).to_contain_text("may not command yaw: add it to `motors` at")
    line = 1 + studio.daemon.config.read_text().splitlines().index(CLIENTS.splitlines()[2])
    expect(refused).to_contain_text(f"robot.yaml:{line}")
    # An e-stop needs no right.
    without.get_by_role("button", name="STOP").click()
    studio.daemon.wait_state(lambda state: state["state"] == "ESTOP", "it is stopped")
    for page in (without, shows):
        page.context.close()


def test_a_token_of_no_entry_is_named_in_the_refusal(chromium: Browser, studio: Studio) -> None:
    page = opened(chromium, f"{studio.url}#{TOKEN[::-1]}")
    enable(page, "wheel")
    refused = page.get_by_role("article", name="wheel", exact=True).get_by_role("alert")
    expect(refused).to_contain_text("its token is in no entry of `clients`")
    page.context.close()


@pytest.mark.parametrize(("token", "shown"), [("", False), (TOKEN, False), (CONFIGURES, True)])
def test_hashes_of_tokens_are_shown_only_to_one_that_may_configure(
    chromium: Browser, studio: Studio, token: str, shown: bool
) -> None:
    page = opened(chromium, f"{studio.url}#{token}")
    sent: list[str] = []
    page.on("websocket", lambda link: link.on("framereceived", lambda data: sent.append(str(data))))
    page.reload()
    page.locator("#tab-configuration").click()
    text = page.get_by_label("Text of the configuration")
    expect(text).to_contain_text(HASHES[0] if shown else "token: hidden-01-")
    expect(page.locator(".verdict-badge")).to_contain_text("rc10d accepts it")
    expect(page.locator(".notice", has_text="hidden-01-")).to_have_count(0 if shown else 1)
    if not shown:
        assert not [data for data in sent for secret in HASHES if secret in data]
    page.context.close()


@again_where_it_let_go_by_itself
def test_a_held_button_without_the_right_says_why_nothing_moves(
    chromium: Browser, studio: Studio
) -> None:
    shows = opened(chromium, f"{studio.url}#{TOKEN}")
    (wheel,) = (each for each in studio.daemon.state()["motors"] if each["name"] == "wheel")
    # A repetition finds it enabled, and then a page has no button for that.
    if wheel["status"] != "ACTIVE":
        enable(shows, "wheel")
    studio.daemon.wait_motor("wheel", lambda motor: motor["status"] == "ACTIVE", "enabled")
    without = opened(chromium, studio.url)
    without.locator("#tab-move").click()
    without.get_by_label("Motor").select_option("wheel")
    without.get_by_role("button", name="counter-clockwise", exact=True).hover()
    without.mouse.down()
    told = without.locator(".jogs [role=status]")
    expect(told).to_contain_text("let go: rc10d does not take this page")
    expect(told).to_contain_text("may observe and stop, not command wheel")
    without.mouse.up()
    for page in (shows, without):
        page.context.close()
