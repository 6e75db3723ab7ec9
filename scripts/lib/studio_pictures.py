#!/usr/bin/env python3
"""Makes docs/images/studio*.png: the page of rc10-web in Chromium.

scripts/demo.sh                                    # in another terminal; it prints the address
.venv/bin/python scripts/lib/studio_pictures.py [http://localhost:8010/]

The picture of the part Move needs a robot whose motors nobody commands: in place of the demo
`rc10d -c config/demo.yaml` and `rc10-web`, and the word `move` behind the address.
"""

from __future__ import annotations

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
    page.screenshot(path=IMAGES / "studio.png")
    page.locator("#tab-plots").click()
    page.wait_for_timeout(SPAN_MS)
    page.screenshot(path=IMAGES / "studio-plot.png")


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


def main() -> None:
    """Takes the pictures of what runs there."""
    address = sys.argv[1] if len(sys.argv) > 1 else "http://localhost:8010/"
    take = picture_of_a_held_motor if sys.argv[2:] == ["move"] else pictures_of_the_demo
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=[*OPTIONS])
        page = browser.new_page(viewport={"width": 1280, "height": 800}, locale="en-GB")
        page.goto(address)
        take(page)
        browser.close()


if __name__ == "__main__":
    main()
