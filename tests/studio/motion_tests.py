"""Steps of tests of motion on the page, patient with a machine that pauses."""

from __future__ import annotations

import re
import time
from typing import TYPE_CHECKING

from hostlib.stalls import stood_still_since
from playwright.sync_api import Locator, Page, expect

from conftest import PATIENCE_MS, Studio

if TYPE_CHECKING:
    from collections.abc import Callable


def tune(page: Page) -> Locator:
    """The form of a test of the wheel, patient with a machine that pauses."""
    page.locator("#tab-tune").click()
    page.get_by_role("combobox", name="Motor").select_option("wheel")
    form = page.get_by_role("region", name="Test of motion")
    for label, value in (
        ("current at most", 12),
        ("speed at most", 1000),
        ("age of feedback at most", 2000),
        ("silence of this page at most", 1000),
    ):
        form.get_by_label(label).fill(str(value))
    return form


def start(form: Locator) -> None:
    form.get_by_role("button", name="Start", exact=True).click()


def ended(form: Locator, text: str) -> None:
    # A test of some seconds, and a machine that draws each of them slowly.
    expect(form.locator(".told")).to_contain_text(text, timeout=3 * PATIENCE_MS)


def stood_still(told: Locator) -> bool:
    """The machine was too busy to hear the page, or to renew a target in time."""
    return bool(re.search(r"\(silence\)|too busy", told.inner_text()))


def runs_to(form: Locator, text: str, begin: Callable[[Locator], None] = start) -> int:
    """Starts a test, which ends so; one during which the machine stood still is run again: runs."""
    told = form.locator(".told")
    runs = 0
    while True:
        runs += 1
        begin_s = time.monotonic()
        begin(form)
        told.wait_for(timeout=3 * PATIENCE_MS)
        quiet = not stood_still(told) or not stood_still_since(begin_s, "a test of motion")
        if quiet or runs == 5:
            break
    expect(told).to_contain_text(text)
    return runs


def measures(proposal: Locator) -> Locator:
    """Measures; one during which the machine stood still is run again."""
    measure = proposal.get_by_role("button", name="Measure")
    told = proposal.locator("p[role=status]")
    for _ in range(5):
        begin_s = time.monotonic()
        measure.click()
        expect(measure).to_be_disabled()
        expect(measure).to_be_enabled(timeout=3 * PATIENCE_MS)
        if told.count() > 0 or not stood_still_since(begin_s, "a measurement"):
            break
    return told


def rests(studio: Studio) -> None:
    studio.daemon.wait_motor(
        "wheel", lambda m: m["acting"] == "nothing" and m["owner"] == "", "it is let go"
    )


def sweep(form: Locator, studio: Studio) -> None:
    """A long sweep, under way."""
    form.get_by_label("kind", exact=True).select_option("sweep")
    form.get_by_label("amplitude").fill("20")
    form.get_by_label("around").fill("60")
    form.get_by_label("lasts").fill("60")
    told = form.locator(".told")

    def ended_already() -> bool:
        return told.count() > 0 and stood_still(told)

    for _ in range(5):
        begin_s = time.monotonic()
        start(form)
        expect(told).to_have_count(0)
        studio.daemon.wait_motor(
            "wheel", lambda m: float(m["velocity_rpm"]) > 50.0 or ended_already(), "turns"
        )
        if not ended_already() or not stood_still_since(begin_s, "a sweep"):
            break
    expect(form.get_by_role("timer")).to_contain_text("/ 62.0 s")


def sweep_ends(form: Locator, studio: Studio, end: Callable[[], object], *texts: str) -> None:
    """A sweep that is ended, and says so; one during which the machine stood still is run again."""
    told = form.locator(".told")
    for _ in range(5):
        begin_s = time.monotonic()
        sweep(form, studio)
        end()
        told.wait_for(timeout=3 * PATIENCE_MS)
        if not stood_still(told) or not stood_still_since(begin_s, "the end of a sweep"):
            break
        rests(studio)
        studio.daemon.wait_motor("wheel", lambda m: abs(float(m["velocity_rpm"])) < 1.0, "stands")
        studio.daemon.must("clear")
        studio.daemon.must("enable", "wheel")
        expect(form.page.locator(".badge.status")).to_have_text("ACTIVE")
    for text in texts:
        ended(form, text)
