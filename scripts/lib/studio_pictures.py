#!/usr/bin/env python3
"""Makes docs/images/studio*.png: the page of rc10-web in Chromium, while the demo runs.

scripts/demo.sh                                    # in another terminal; it prints the address
.venv/bin/python scripts/lib/studio_pictures.py [http://localhost:8010/]
"""

from __future__ import annotations

import sys
from pathlib import Path

from playwright.sync_api import sync_playwright

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
CHROMIUM = "/usr/bin/chromium"
OPTIONS = ("--no-sandbox", "--disable-gpu", "--disable-background-networking")
SPAN_MS = 10_500.0


def main() -> None:
    """Takes a picture of the overview, and one of ten seconds of two signals."""
    address = sys.argv[1] if len(sys.argv) > 1 else "http://localhost:8010/"
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=[*OPTIONS])
        page = browser.new_page(viewport={"width": 1280, "height": 800}, locale="en-GB")
        page.goto(address)
        page.get_by_role("article", name="yaw").wait_for()
        page.screenshot(path=IMAGES / "studio.png")
        page.locator("#tab-plots").click()
        page.wait_for_timeout(SPAN_MS)
        page.screenshot(path=IMAGES / "studio-plot.png")
        browser.close()


if __name__ == "__main__":
    main()
