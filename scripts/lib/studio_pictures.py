#!/usr/bin/env python3
"""Makes docs/images/studio*.png: the page of rc10-web in Chromium.

scripts/demo.sh                                    # in another terminal; it prints the address
.venv/bin/python scripts/lib/studio_pictures.py [http://localhost:8010/]

The pictures of the parts Move, Tune and Commission need a robot whose motors nobody commands: in
place of the demo `rc10d -c config/demo.yaml` and `rc10-web`, and the word `move`, `tune` or
`commission` behind the address. The word `configuration` there makes only the picture of that part.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

from playwright.sync_api import Page, sync_playwright

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
CHROMIUM = "/usr/bin/chromium"
OPTIONS = ("--no-sandbox", "--disable-gpu", "--disable-background-networking")
SPAN_MS = 10_500.0
SETTLE_MS = 2_500.0


def pictures_of_the_demo(page: Page) -> None:
    """The overview, and ten seconds of two signals."""
    page.get_by_role("article", name="yaw").wait_for()
    page.set_viewport_size({"width": 1280, "height": 1090})
    page.wait_for_timeout(SETTLE_MS)
    page.screenshot(path=IMAGES / "studio.png")
    page.set_viewport_size({"width": 1280, "height": 800})
    page.locator("#tab-plots").click()
    page.wait_for_timeout(SPAN_MS)
    page.screenshot(path=IMAGES / "studio-plot.png")
    picture_of_the_configuration(page)


def picture_of_a_held_motor(page: Page) -> None:
    """The part Move while a button is held."""
    page.locator("#tab-move").click()
    page.get_by_label("Motor").select_option("yaw")
    page.get_by_role("button", name="Enable", exact=True).click()
    page.get_by_role("button", name="counter-clockwise", exact=True).hover()
    page.wait_for_timeout(SETTLE_MS)
    page.mouse.down()
    page.wait_for_timeout(SETTLE_MS)
    page.screenshot(path=IMAGES / "studio-move.png")
    page.mouse.up()


def picture_of_a_test(page: Page) -> None:
    """The part Tune after two steps with different gains."""
    page.locator("#tab-tune").click()
    page.get_by_role("combobox", name="Motor").select_option("yaw")
    page.get_by_role("button", name="Enable", exact=True).click()
    page.locator(".badge.active").wait_for()
    form = page.get_by_role("region", name="Test of motion")
    form.get_by_label("current at most").fill("3")
    kp = page.get_by_label("velocity_pid.kp", exact=False).first
    for gain in ("", "0.02"):
        if gain:
            kp.fill(gain)
            page.get_by_role("button", name="Apply").click()
        form.get_by_role("button", name="Start", exact=True).click()
        form.get_by_role("status").filter(has_text="Done").wait_for(timeout=4 * SPAN_MS)
        page.wait_for_timeout(SETTLE_MS)
    page.set_viewport_size({"width": 1280, "height": 1020})
    page.get_by_role("region", name="Tests", exact=True).scroll_into_view_if_needed()
    page.wait_for_timeout(SETTLE_MS)
    page.screenshot(path=IMAGES / "studio-tune.png")


def picture_of_a_first_spin(page: Page) -> None:
    """The part Commission after a scan, and while a wheel spins for the first time."""
    page.locator("#tab-commission").click()
    page.get_by_label("Motor").select_option("feeder")  # no loop in its fallbacks
    steps = page.get_by_role("list", name="Commission")
    card = page.locator(".card.step")
    card.get_by_role("button", name="Scan this bus").click()
    card.get_by_role("group", name="Drives that were heard").wait_for()
    page.set_viewport_size({"width": 1280, "height": 1020})
    page.screenshot(path=IMAGES / "studio-scan.png")
    page.set_viewport_size({"width": 1280, "height": 800})
    card.get_by_role("button", name="say id").click()
    steps.get_by_role("button", name="Zero").click()
    card.get_by_role("button", name="Set").click()
    card.get_by_role("status").wait_for()
    steps.get_by_role("button", name="Limits").click()
    card.get_by_role("button", name="It has no ends").click()
    steps.get_by_role("button", name="Direction").click()
    card.get_by_role("button", name="Begin").click()
    card.get_by_role("button", name="+360").click()
    page.wait_for_timeout(SETTLE_MS)
    card.get_by_role("button", name="The mark is back").click()
    steps.get_by_role("button", name="First spin").click()
    card.get_by_role("button", name="Enable it alone").click()
    page.locator(".badge.active").wait_for()
    card.get_by_role("button", name="Hold to spin").hover()
    page.mouse.down()
    page.get_by_role("timer").filter(has_text=re.compile(r"^0\.[4-9] /")).wait_for()
    page.screenshot(path=IMAGES / "studio-commission.png")
    page.mouse.up()


def picture_of_the_configuration(page: Page) -> None:
    """Two wheels with one id: the message at its line, the key's help, the buses; the end."""
    page.locator("#tab-configuration").click()
    page.locator(".verdict-badge", has_text="rc10d accepts it").wait_for()
    page.locator(".cm-line", has_text="name: front_right").click()
    page.keyboard.press("Home")
    for _ in range(len("- {name: front_right, profile: wheel, id: ")):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowRight")
    page.keyboard.type("1")
    page.locator(".config-problems").wait_for()
    page.set_viewport_size({"width": 1280, "height": 1020})
    page.evaluate(
        """() => {
          const editor = document.querySelector('.config-editor').shadowRoot;
          editor.querySelector('.cm-scroller').scrollLeft = 0;
        }"""
    )
    page.screenshot(path=IMAGES / "studio-configuration.png")
    page.keyboard.press("Control+Z")
    page.locator(".verdict-badge", has_text="rc10d accepts it").wait_for()
    page.get_by_text("To install it").click()
    page.locator(".notes", has_text="To install it").scroll_into_view_if_needed()
    page.wait_for_timeout(SETTLE_MS)
    page.screenshot(path=IMAGES / "studio-install.png")


def main() -> None:
    """Takes the pictures of what runs there."""
    address = sys.argv[1] if len(sys.argv) > 1 else "http://localhost:8010/"
    take = {
        "move": picture_of_a_held_motor,
        "tune": picture_of_a_test,
        "commission": picture_of_a_first_spin,
        "configuration": picture_of_the_configuration,
    }.get(sys.argv[2] if len(sys.argv) > 2 else "", pictures_of_the_demo)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=[*OPTIONS])
        page = browser.new_page(viewport={"width": 1280, "height": 800}, locale="en-GB")
        page.goto(address)
        take(page)
        browser.close()


if __name__ == "__main__":
    main()
