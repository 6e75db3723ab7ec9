"""The first time of a motor on the page, by clicks, with the hand of a simulated one."""

from __future__ import annotations

import os
import re
import signal
from pathlib import Path

import pytest
from hostlib.daemon import ARM
from hostlib.program import eventually
from playwright.sync_api import Browser, Locator, Page, Playwright, expect

from conftest import CHROMIUM, PATIENCE_MS, QUIET, Studio

# Feedback may be as old as a busy machine makes it.
WHEEL = """
      - {name: wheel, model: M3508, id: 1, zero: power_on, feedback_timeout_ms: 1000, current_limit_a: 5,
         simulated: {inertia_kg_m2: 0.01}}
"""
JOINT = """
      - {name: elbow, model: DM4310, id: 3, master_id: 19, feedback_timeout_ms: 1000,
         simulated: {inertia_kg_m2: 0.05, coulomb_nm: 0.2}}
"""


@pytest.fixture
def robot() -> str:
    return ARM + WHEEL + JOINT


@pytest.fixture
def card(page: Page) -> Locator:
    page.locator("#tab-commission").click()
    return page.locator(".card.step")


def choose(page: Page, motor: str) -> None:
    page.get_by_role("combobox", name="Motor").select_option(motor)


def go_to(page: Page, step: str) -> None:
    page.get_by_role("list", name="Commission").get_by_role("button", name=step).click()


def press(card: Locator, name: str | re.Pattern[str]) -> None:
    card.get_by_role("button", name=name).first.click()


def told(card: Locator) -> Locator:
    return card.get_by_role("status")


def angle(studio: Studio, motor: str) -> float:
    motors = studio.daemon.state()["motors"]
    return float(next(each for each in motors if each["name"] == motor)["total_angle_deg"])


def by_hand(studio: Studio, card: Locator, motor: str, button: str, deg: float) -> None:
    """The simulated hand, until it has let go."""
    to_deg = angle(studio, motor) + deg
    press(card, button)
    studio.daemon.wait_motor(
        motor,
        lambda m: abs(float(m["total_angle_deg"]) - to_deg) < 4 and abs(float(m["velocity_rpm"])) < 0.5,
        "the hand has turned it",
    )


def rests(studio: Studio, motor: str) -> None:
    studio.daemon.wait_motor(
        motor,
        lambda m: m["status"] == "READY" and m["acting"] == "nothing" and m["owner"] == "",
        "it is disabled, and at rest",
    )


def held(page: Page, studio: Studio, card: Locator, motor: str, label: str, words: str) -> None:
    """A held button, until the test ends; one during which the machine stood still is run again."""
    for _ in range(5):
        press(card, "Enable it alone")
        button = card.get_by_role("button", name=label)
        expect(button).to_be_enabled()
        button.hover()
        page.mouse.down()
        ended = told(card).or_(card.get_by_text("Nothing was judged"))
        ended.first.wait_for(timeout=3 * PATIENCE_MS)
        page.mouse.up()
        rests(studio, motor)
        if "(silence)" not in card.inner_text():
            break
    expect(told(card)).to_contain_text(words)


def turned_by_hand(studio: Studio, card: Locator, motor: str) -> None:
    press(card, "Begin")
    by_hand(studio, card, motor, "+360°", 360)
    press(card, "The mark is back")


def test_a_wheel_is_commissioned_by_clicks(page: Page, studio: Studio, card: Locator) -> None:
    choose(page, "wheel")
    expect(card.get_by_role("row", name=re.compile("^wheel"))).to_contain_text("0x201 at 1000 Hz")
    press(card, re.compile("say id 1"))
    expect(told(card)).to_contain_text("wheel is heard as id 1 on arm")
    press(card, "Next")
    turned_by_hand(studio, card, "wheel")
    expect(told(card)).to_contain_text("name, direction and ratio are right")
    press(card, "Next")
    expect(card).to_contain_text("zero: power_on")
    press(card, "Set")
    expect(told(card)).to_contain_text("reads 0.0° there now")
    assert abs(angle(studio, "wheel")) < 1
    press(card, "Next")
    press(card, "It has no ends")
    expect(told(card)).to_contain_text("no limits")
    press(card, "Next")
    held(page, studio, card, "wheel", "Hold to spin", "the right way")
    press(card, "Next")
    held(page, studio, card, "wheel", "Hold to step", "of 20.0 rpm")
    press(card, "Next")
    report = card.get_by_role("group", name="Report")
    expect(report.locator("tr.good")).to_have_count(6)
    expect(report).to_contain_text("The file needs no change.")


def test_a_joint_ends_in_limits_and_a_zero_for_the_file(
    page: Page, studio: Studio, card: Locator
) -> None:
    choose(page, "elbow")
    press(card, re.compile("say id 3"))
    press(card, "Next")
    turned_by_hand(studio, card, "elbow")
    expect(told(card)).to_contain_text("are right")
    press(card, "Next")
    expect(card).to_contain_text("An absolute encoder")
    card.get_by_label("It stands at").fill("30")
    press(card, "Set")
    expect(told(card)).to_contain_text("zero_deg in the file keeps it")
    press(card, "Next")
    by_hand(studio, card, "elbow", "−90°", -90)
    press(card, "Lower end is here")
    for _ in range(2):
        by_hand(studio, card, "elbow", "+90°", 90)
    press(card, "Upper end is here")
    press(card, "Take both")
    expect(told(card)).to_contain_text("travel")
    expect(card).to_contain_text("right turn at power-up")
    by_hand(studio, card, "elbow", "−90°", -90)
    press(card, "Next")
    card.get_by_label("current", exact=True).fill("0.5")
    held(page, studio, card, "elbow", "Hold to spin", "the right way")
    go_to(page, "Limits")
    now = angle(studio, "elbow")
    by_hand(studio, card, "elbow", "−15°", -15)
    assert angle(studio, "elbow") < now
    go_to(page, "First step")
    held(page, studio, card, "elbow", "Hold to step", "deg")
    press(card, "Next")
    lines = card.get_by_label("Lines for the file, of", exact=True)
    for key in ("zero_deg", "angle_min_deg", "angle_max_deg"):
        expect(lines).to_contain_text(key)
    with page.expect_download() as saved:
        press(card, "Save the report")
    assert "angle_min_deg: " in Path(saved.value.path()).read_text()
    press(card, "Put them into the Configuration")
    editor = page.get_by_label("Text of the configuration")
    expect(editor).to_contain_text(re.compile(r"name: elbow, .*angle_max_deg: "))
    expect(page.locator(".verdict-badge")).to_contain_text("rc10d accepts it")
