"""Where a checkbox stands beside its text."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser
from test_studio import open_tab

from conftest import PATIENCE_MS, Studio

# Distances in px between the middles of checkbox and text, in each label that is shown.
OFFSETS = """
labels => labels.filter((label) => label.offsetParent !== null).map((label) => {
  const box = label.querySelector('input').getBoundingClientRect();
  const range = document.createRange();
  const walker = document.createTreeWalker(label, NodeFilter.SHOW_TEXT);
  const rects = [];
  while (walker.nextNode()) {
    range.selectNodeContents(walker.currentNode);
    rects.push(...range.getClientRects());
  }
  const top = Math.min(...rects.map((rect) => rect.top));
  const bottom = Math.max(...rects.map((rect) => rect.bottom));
  return (top + bottom) / 2 - (box.top + box.bottom) / 2;
})
"""


@pytest.mark.parametrize("width", [375, 1280])
def test_a_checkbox_is_level_with_its_text(chromium: Browser, studio: Studio, width: int) -> None:
    context = chromium.new_context(viewport={"width": width, "height": 860}, locale="en-GB")
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.goto(studio.url)
    for tab, least in (("plots", 2), ("move", 1), ("tune", 1)):
        open_tab(page, tab)
        labels = page.locator("label:has(> input[type='checkbox'])")
        labels.first.wait_for()
        offsets = labels.evaluate_all(OFFSETS)
        assert len(offsets) >= least
        assert max(abs(offset) for offset in offsets) <= 2, (tab, offsets)
    context.close()
