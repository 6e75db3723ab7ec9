"""Steps of commissioning a motor on the page, by clicks, with the hand of a simulated one."""

from __future__ import annotations

import contextlib
import math
import re
import time
from collections.abc import Iterator
from typing import TYPE_CHECKING

from hostlib.program import eventually
from hostlib.stalls import stood_still_since
from playwright.sync_api import Locator, Page, expect
from playwright.sync_api import TimeoutError as StaysDisabled

from conftest import PATIENCE_MS, Studio

if TYPE_CHECKING:
    from collections.abc import Callable

MINUS = "\u2212"
# In the feedback of a machine that stood still: then the same is asked for once more.
NOT_JUDGED = "may hide a turn"
# Words of a test that such a machine has ended, or did not let be judged.
STOOD_STILL = re.compile(rf"\(silence\)|too busy|{NOT_JUDGED}")
# The button of a test under way.
HELD = re.compile(r"\bheld\b")
# Live angles after one turn, and after half of one the other way.
A_TURN = re.compile(r"^3[56]\d\.")
HALF_A_TURN_BACK = re.compile(rf"^{MINUS}1[78]\d\.")
# Feedback may be as old as a busy machine makes it.
WHEEL = """
      - {name: wheel, model: M3508, id: 1, zero: power_on, feedback_timeout_ms: 1000,
         current_limit_a: 5, simulated: {inertia_kg_m2: 0.01}}
"""
JOINT = """
      - {name: elbow, model: DM4310, id: 3, master_id: 19, feedback_timeout_ms: 1000,
         simulated: {inertia_kg_m2: 0.05, coulomb_nm: 0.2}}
"""


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


def stands(studio: Studio, motor: str) -> None:
    studio.daemon.wait_motor(motor, lambda m: abs(float(m["velocity_rpm"])) < 0.5, "it stands")


@contextlib.contextmanager
def turning(studio: Studio, motor: str, deg: int) -> Iterator[str]:
    """The button of the simulated hand, of a shaft that stands, until the hand has let go."""
    stands(studio, motor)
    to_deg = angle(studio, motor) + deg
    yield f"{'+' if deg > 0 else MINUS}{abs(deg)}°"
    studio.daemon.wait_motor(
        motor,
        lambda m: (
            abs(float(m["total_angle_deg"]) - to_deg) < 4 and abs(float(m["velocity_rpm"])) < 0.5
        ),
        "the hand has turned it",
    )


def by_hand(studio: Studio, card: Locator, motor: str, deg: int) -> None:
    with turning(studio, motor, deg) as button:
        press(card, button)


def knows_the_turn(card: Locator, turned: re.Pattern[str] = A_TURN) -> None:
    """A page that stood still would take the angles of before."""
    expect(card.locator(".live-angle")).to_have_text(turned)


def shown_deg(card: Locator) -> float:
    number = re.match(r"-?\d+\.\d", card.locator(".live-angle").inner_text().replace(MINUS, "-"))
    return math.nan if number is None else float(number[0])


def knows_the_angle(studio: Studio, card: Locator, motor: str) -> None:
    """A page that stood still would take the angle of before; the shaft stands."""
    eventually(lambda: abs(shown_deg(card) - angle(studio, motor)) < 0.5, "the page has its angle")


def take_end(studio: Studio, card: Locator, motor: str, name: str) -> None:
    knows_the_angle(studio, card, motor)
    press(card, name)


def rests(studio: Studio, motor: str) -> None:
    studio.daemon.wait_motor(
        motor,
        lambda m: m["status"] == "READY" and m["acting"] == "nothing" and m["owner"] == "",
        "it is disabled, and at rest",
    )


def held(
    page: Page,
    studio: Studio,
    card: Locator,
    motor: str,
    label: str,
    words: str,
    before_again: Callable[[], None] = lambda: None,
) -> None:
    """A held button, until the test ends; one during which the machine stood still is run again."""
    for _ in range(5):
        begin_s = time.monotonic()
        press(card, "Enable it alone")
        button = card.get_by_role("button", name=label)
        expect(button).to_be_enabled()
        button.hover()
        page.mouse.down()
        # Words of the one before stay until then.
        expect(button).not_to_have_class(HELD, timeout=3 * PATIENCE_MS)
        page.mouse.up()
        rests(studio, motor)
        if not STOOD_STILL.search(card.inner_text()) or not stood_still_since(begin_s, label):
            break
        before_again()
    expect(told(card)).to_contain_text(words)


def turned_by_hand(studio: Studio, card: Locator, motor: str) -> None:
    for _ in range(5):
        begin_s = time.monotonic()
        press(card, "Begin")
        by_hand(studio, card, motor, 360)
        knows_the_turn(card)
        press(card, "The mark is back")
        if NOT_JUDGED not in told(card).inner_text() or not stood_still_since(
            begin_s, "a turn by hand"
        ):
            break


def both_ends(card: Locator, ends: Callable[[], None], zero: Callable[[], None]) -> None:
    """Takes both ends; a machine that stood still loses the zero, and with it both: then anew."""
    take = card.get_by_role("button", name="Take both")
    for _ in range(5):
        begin_s = time.monotonic()
        with contextlib.suppress(StaysDisabled):
            ends()
        if take.is_enabled() or not stood_still_since(begin_s, "both ends"):
            break
        zero()
    take.click()


def zero_again(page: Page, card: Locator) -> None:
    go_to(page, "Zero")
    press(card, "Set")
    go_to(page, "Limits")
