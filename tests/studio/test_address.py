"""The picture that rc10ctl web draws, read as a phone reads it."""

from __future__ import annotations

import os
import subprocess

import pytest
from hostlib.daemon import BIN, REPO
from playwright.sync_api import Browser, Page, expect

from conftest import PATIENCE_MS, Studio

# Addresses of a network that nobody has; on loopback, so that it stays here.
ELSEWHERE = "198.51.100.7"
# Each text of an element, however soon another one follows.
TEXTS = """(element) => {
  window.texts = [];
  new MutationObserver(() => window.texts.push(element.textContent.trim()))
    .observe(element, {childList: true, characterData: true, subtree: true});
}"""
# Half blocks to an image, light where there is ink, and what a reader finds in it.
READ = """([lines]) => {
  const size = 8;
  const width = lines[0].length;
  const data = new Uint8ClampedArray(4 * width * size * 2 * lines.length * size).fill(255);
  for (let y = 0; y < 2 * lines.length * size; ++y)
    for (let x = 0; x < width * size; ++x) {
      const row = Math.floor(y / size);
      const ink = lines[row >> 1][Math.floor(x / size)];
      const light = ink === '█' || ink === (row % 2 === 0 ? '▀' : '▄');
      data.fill(light ? 255 : 0, 4 * (y * width * size + x), 4 * (y * width * size + x) + 3);
    }
  return jsQR(data, width * size, 2 * lines.length * size)?.data ?? null;
}"""


@pytest.fixture
def words() -> tuple[str, ...]:
    """For others too."""
    subprocess.run(["ip", "address", "replace", f"{ELSEWHERE}/32", "dev", "lo"], check=True)
    return ("--listen", "0.0.0.0")


def test_a_phone_that_reads_the_code_looks_at_the_robot(chromium: Browser, studio: Studio) -> None:
    told = subprocess.run(
        [BIN / "rc10ctl", "web", "--port", str(studio.port)],
        env={**os.environ, **studio.daemon.env, "LC_ALL": "C.UTF-8"},
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    urls = [line.removeprefix("on others: ") for line in told.splitlines() if "on others" in line]
    picture = [line for line in told.splitlines() if set(line) <= set(" ▀▄█")]
    context = chromium.new_context(viewport={"width": 390, "height": 844}, locale="en-GB")
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.evaluate((REPO / "web" / "node_modules" / "jsqr" / "dist" / "jsQR.js").read_text())
    assert page.evaluate(READ, [picture]) == urls[0]
    (url,) = [url for url in urls if ELSEWHERE in url]
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(url)
    expect(page.locator(".badge.connection")).to_have_text("live")
    expect(page.get_by_role("article", name="wheel", exact=True)).to_be_visible()
    expect(page.get_by_text("looks and stops only")).to_be_visible()
    # The token is in no address that the browser asks for.
    token = url.split("#")[1]
    assert [one for one in asked if token in one.split("#")[0]] == []
    context.close()


def test_a_browser_on_another_computer_complains_of_nothing(
    chromium: Browser, studio: Studio
) -> None:
    token = studio.daemon.run_dir.joinpath("web-token").read_text().strip()
    with chromium.new_context(locale="en-GB") as context:
        page = context.new_page()
        told: list[str] = []
        page.on("console", lambda message: told.append(message.text))
        page.goto(f"http://{ELSEWHERE}:{studio.port}/#{token}")
        expect(page.locator(".badge.connection")).to_have_text("live")
        assert told == []
        # Where the browser honours it, no other page has a handle to this one.
        answer = page.goto(studio.url)
        assert answer is not None
        assert answer.header_value("Cross-Origin-Opener-Policy") == "same-origin"
        expect(page.locator(".badge.connection")).to_have_text("live")
        assert told == []


def elsewhere(chromium: Browser, studio: Studio, fragment: str = "") -> Page:
    context = chromium.new_context(viewport={"width": 390, "height": 844}, locale="en-GB")
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.goto(f"http://{ELSEWHERE}:{studio.port}/{fragment}")
    return page


def test_a_wrong_token_is_said_to_be_wrong_and_the_right_one_outlives_the_connection(
    chromium: Browser, studio: Studio
) -> None:
    page = elsewhere(chromium, studio)
    expect(page.get_by_role("alert")).to_have_count(0)
    page.get_by_label("Token").fill("wrong")
    page.get_by_role("button", name="Show").click()
    expect(page.get_by_role("alert")).to_have_text("This is not its token.")
    page.get_by_label("Token").fill((studio.daemon.run_dir / "web-token").read_text().strip())
    page.get_by_role("button", name="Show").click()
    wheel = page.get_by_role("article", name="wheel", exact=True)
    expect(wheel).to_be_visible()
    # As after a walk out of the network's reach: nobody types it again.
    studio.web.stop()
    expect(wheel).to_have_count(0)
    studio.start(studio.port)
    expect(wheel).to_be_visible()
    page.context.close()


def test_lines_are_copied_without_encryption_too_and_the_page_says_so(
    chromium: Browser, studio: Studio
) -> None:
    token = (studio.daemon.run_dir / "web-token").read_text().strip()
    page = elsewhere(chromium, studio, f"#{token}")
    assert page.evaluate("isSecureContext") is False
    wheel = page.get_by_role("article", name="wheel", exact=True)
    wheel.locator(".actions .copied").first.evaluate(TEXTS)
    wheel.locator(".actions .copy").first.click()
    page.wait_for_function("() => window.texts.includes('copied')")
    page.locator("#tab-plots").click()
    field = page.get_by_label("Choose up to 12 signals")
    field.press("Control+v")
    expect(field).to_have_value("rc10ctl enable wheel")
    page.context.close()
