"""The first time of a motor on the page, by clicks, with the hand of a simulated one."""

from __future__ import annotations

import json
import os
import re
import signal
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from commissioning import (
    HALF_A_TURN_BACK,
    HELD,
    JOINT,
    MINUS,
    NOT_JUDGED,
    STOOD_STILL,
    WHEEL,
    angle,
    both_ends,
    by_hand,
    choose,
    go_to,
    held,
    knows_the_turn,
    press,
    rests,
    take_end,
    told,
    turned_by_hand,
    zero_again,
)
from hostlib.daemon import ARM, REPO
from hostlib.stalls import stood_still_since
from playwright.sync_api import Locator, Page, Playwright, WebSocketRoute, expect

from conftest import CHROMIUM, PATIENCE_MS, QUIET, Studio

if TYPE_CHECKING:
    from collections.abc import Callable

# A button's memory of having been disabled, however shortly.
NOTE_DISABLED = """(button) => {
  button.wasDisabled = button.disabled;
  new MutationObserver(() => { button.wasDisabled ||= button.disabled; })
    .observe(button, {attributeFilter: ['disabled']});
}"""


@pytest.fixture
def robot() -> str:
    return ARM + WHEEL + JOINT


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


def test_after_a_gap_that_may_hide_a_turn_the_turn_by_hand_is_not_judged(
    page: Page, studio: Studio
) -> None:
    sockets: list[WebSocketRoute] = []

    def relay(socket: WebSocketRoute) -> None:
        socket.connect_to_server()
        sockets.append(socket)

    page.route_web_socket("**/link", relay)
    page.reload()
    page.locator("#tab-commission").click()
    card = page.locator(".card.step")
    choose(page, "wheel")
    press(card, re.compile("say id 1"))
    press(card, "Next")
    press(card, "Begin")
    lost = {
        "type": "event",
        "utime": 0,
        "mono_us": time.monotonic_ns() // 1000,
        "severity": "warning",
    }
    lost |= {"code": 102, "source": "wheel", "client": "", "text": "reference of the angle lost"}
    sockets[-1].send(json.dumps(lost))
    by_hand(studio, card, "wheel", 360)
    knows_the_turn(card)
    press(card, "The mark is back")
    expect(told(card)).to_contain_text("The feedback of wheel had a gap that may hide a turn")


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

    def ends() -> None:
        by_hand(studio, card, "elbow", -90)
        take_end(studio, card, "elbow", "Lower end is here")
        for _ in range(2):
            by_hand(studio, card, "elbow", 90)
        take_end(studio, card, "elbow", "Upper end is here")

    both_ends(card, ends, lambda: zero_again(page, card))
    expect(told(card)).to_contain_text("travel")
    expect(card).to_contain_text("right turn at power-up")
    by_hand(studio, card, "elbow", -90)
    press(card, "Next")
    card.get_by_label("current", exact=True).fill("0.5")
    held(page, studio, card, "elbow", "Hold to spin", "the right way")
    go_to(page, "Limits")
    by_hand(studio, card, "elbow", -15)
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


def test_the_first_step_of_a_short_travel_is_short(
    page: Page, studio: Studio, card: Locator
) -> None:
    choose(page, "elbow")
    zero_again(page, card)
    card.get_by_label("margin").fill("5")

    def ends() -> None:
        take_end(studio, card, "elbow", "Lower end is here")
        by_hand(studio, card, "elbow", 15)
        take_end(studio, card, "elbow", "Upper end is here")

    both_ends(card, ends, lambda: zero_again(page, card))
    expect(told(card)).to_contain_text("travel")
    # The other steps are as good as this one.
    page.evaluate(
        """() => {
          const key = "rc10.host/commission/elbow";
          const record = JSON.parse(localStorage.getItem(key));
          record.found.hand = record.found.spin = record.found.limits;
          localStorage.setItem(key, JSON.stringify(record));
        }"""
    )
    lines = page.evaluate('JSON.parse(localStorage.getItem("rc10.host/commission/elbow")).lines')
    quarter_deg = (lines["angle_max_deg"] - lines["angle_min_deg"]) / 4
    assert 0.2 < quarter_deg < 2.5, "a travel so short that ten degrees are too many"
    page.reload()
    page.locator("#tab-commission").click()
    go_to(page, "First step")
    # The hand turns it a little more or less than it was told.
    expect(card).to_contain_text(f"A step of the angle by {MINUS}")
    step = re.search(r"step -(\d+\.?\d*) ", card.inner_text())
    assert step is not None
    assert quarter_deg - 0.1 - 1e-9 <= float(step[1]) <= quarter_deg
    expect(card).to_contain_text(f"A step of the angle by {MINUS}{step[1]}°")


def test_an_angle_is_taken_of_a_shaft_that_stands(
    page: Page, studio: Studio, card: Locator
) -> None:
    choose(page, "elbow")
    for step, name in (
        ("Direction", "Begin"),
        ("Zero", "Set"),
        ("Limits", "Lower end is here"),
    ):
        go_to(page, step)
        button = card.get_by_role("button", name=name).first
        expect(button).to_be_enabled()
        button.evaluate(NOTE_DISABLED)
        studio.daemon.must("hand", "elbow", "--by", 360, "--rpm", 20)
        page.wait_for_function("(button) => button.wasDisabled", arg=button.element_handle())
        expect(button).to_be_enabled()


def ready_to_spin(page: Page, studio: Studio, card: Locator) -> None:
    choose(page, "wheel")
    go_to(page, "First spin")
    expect(card.get_by_role("alert")).to_contain_text("Direction, by hand · Limits, by hand")
    go_to(page, "Limits")
    press(card, "It has no ends")
    go_to(page, "Direction")
    turned_by_hand(studio, card, "wheel")
    expect(told(card)).to_contain_text("are right")
    go_to(page, "First spin")


def hold_to_spin(
    page: Page, studio: Studio, card: Locator, hold: Callable[[Locator], None]
) -> None:
    """A held button until the wheel is in the spin; where the machine stood still, once more."""
    button = card.get_by_role("button", name="Hold to spin")
    for _ in range(5):
        begin_s = time.monotonic()
        expect(button).to_be_enabled()
        expect(button).not_to_have_class(HELD)
        hold(button)
        try:
            studio.daemon.wait_motor(
                "wheel",
                lambda m: m["acting"] == "target" and str(m["owner"]).startswith("web-"),
                "it is in the spin",
            )
        except AssertionError:
            # It ended before anybody saw it, by itself or in silence.
            ended = STOOD_STILL.search(card.inner_text()) or told(card).count() > 0
            if not ended:
                raise
            if not stood_still_since(begin_s, "a spin"):
                raise
        else:
            return
        page.mouse.up()
        page.keyboard.up(" ")
        rests(studio, "wheel")
        press(card, "Enable it alone")
    raise AssertionError("five spins ended before they were seen")


def hold_by_mouse(page: Page) -> Callable[[Locator], None]:
    def hold(button: Locator) -> None:
        button.hover()
        page.mouse.down()

    return hold


def hold_by_key(page: Page) -> Callable[[Locator], None]:
    def hold(button: Locator) -> None:
        button.focus()
        page.keyboard.down(" ")

    return hold


def spinning(page: Page, studio: Studio) -> None:
    """The wheel in its first spin, under a finger that stays."""
    page.locator("#tab-commission").click()
    card = page.locator(".card.step")
    ready_to_spin(page, studio, card)
    press(card, "Enable it alone")
    expect(card).to_contain_text("no other motor can be enabled")
    refused = studio.daemon.ctl("enable", "elbow")
    assert "locked while" in refused.stdout + refused.stderr
    hold_to_spin(page, studio, card, hold_by_mouse(page))


ENDS: dict[str, Callable[[Page], object]] = {
    "release": lambda page: page.mouse.up(),
    "another part": lambda page: page.locator("#tab-events").click(),
    "another step": lambda page: go_to(page, "Zero"),
    "another motor": lambda page: choose(page, "elbow"),
    "blur": lambda page: page.evaluate("window.dispatchEvent(new Event('blur'))"),
    "another key": lambda page: page.keyboard.press("x"),
    "reload": lambda page: page.reload(),
}


@pytest.mark.parametrize("end", list(ENDS))
def test_all_that_is_not_holding_ends_a_spin_and_lets_the_motor_go(
    page: Page, studio: Studio, card: Locator, end: str
) -> None:
    expect(card).to_be_visible()
    spinning(page, studio)
    ENDS[end](page)
    rests(studio, "wheel")
    page.mouse.up()
    studio.daemon.must("enable", "elbow")


def test_a_key_holds_it_too_and_its_release_ends_it(
    page: Page, studio: Studio, card: Locator
) -> None:
    ready_to_spin(page, studio, card)
    for _ in range(5):
        begin_s = time.monotonic()
        press(card, "Enable it alone")
        hold_to_spin(page, studio, card, hold_by_key(page))
        page.keyboard.up(" ")
        rests(studio, "wheel")
        expect(card.get_by_role("button", name="Hold to spin")).not_to_have_class(HELD)
        # Or its time was over before.
        if "(interrupted)" in card.inner_text() or not stood_still_since(
            begin_s, "a spin that a key holds"
        ):
            break
    expect(card.get_by_text("Nothing was judged")).to_contain_text("(interrupted)")


def test_a_browser_that_is_killed_in_the_spin_leaves_rest_and_no_lock(
    playwright: Playwright, studio: Studio, tmp_path: Path
) -> None:
    context = playwright.chromium.launch_persistent_context(
        str(tmp_path), executable_path=CHROMIUM, args=[*QUIET], locale="en-GB"
    )
    page = context.pages[0]
    page.set_default_timeout(PATIENCE_MS)
    page.goto(studio.url)
    spinning(page, studio)
    os.kill(int((tmp_path / "SingletonLock").readlink().name.split("-")[-1]), signal.SIGKILL)
    rests(studio, "wheel")
    studio.daemon.must("enable", "elbow")


def test_a_server_that_is_killed_in_the_spin_leaves_no_torque(
    page: Page, studio: Studio, card: Locator
) -> None:
    expect(card).to_be_visible()
    spinning(page, studio)
    studio.web.signal(signal.SIGKILL)
    studio.daemon.wait_motor(
        "wheel", lambda m: m["acting"] == "nothing" and m["owner"] == "", "it is let go"
    )
    page.mouse.up()


@pytest.mark.parametrize("width", [390, 1280])
def test_each_step_fits_and_all_can_use_it(page: Page, card: Locator, width: int) -> None:
    page.set_viewport_size({"width": width, "height": 860})
    page.evaluate((REPO / "web" / "node_modules" / "axe-core" / "axe.min.js").read_text())
    for step in page.get_by_role("list", name="Commission").get_by_role("button").all():
        step.click()
        expect(card).to_have_attribute("aria-label", step.inner_text()[1:].strip())
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), (
            step.inner_text()
        )
        found = page.evaluate("axe.run().then((result) => result.violations)")
        serious = [
            (one["id"], [node["html"] for node in one["nodes"]][:3])
            for one in found
            if one["impact"] in ("serious", "critical")
        ]
        assert serious == [], step.inner_text()


def test_what_was_found_is_there_after_a_reload_and_old_with_another_run(
    page: Page, studio: Studio, card: Locator
) -> None:
    choose(page, "wheel")
    press(card, re.compile("say id 1"))
    go_to(page, "Zero")
    press(card, "Set")
    expect(told(card)).to_contain_text("reads 0.0°")
    page.reload()
    expect(told(card)).to_contain_text("reads 0.0°")
    steps = page.get_by_role("list", name="Commission")
    expect(steps.locator(".sign.good")).to_have_count(2)
    # It counts from another zero, and the id is that of the same file.
    studio.daemon.program.stop()
    studio.daemon.start()
    studio.daemon.wait_ready()
    expect(steps.locator(".sign.old")).to_have_count(1)
    expect(steps.locator(".sign.good")).to_have_count(1)
    expect(card).to_contain_text("repeat it")
    press(page.locator("main"), "Begin anew")
    expect(steps.locator(".sign.old")).to_have_count(0)


class TestAWrongFile:
    """Wrong direction, wrong ratio, swapped names, a fallback that keeps torque."""

    @pytest.fixture
    def robot(self) -> str:
        wheel = WHEEL.replace(
            "id: 1,", "id: 1, gear_ratio: 36, on_timeout: brake, on_disable: hold,"
        )
        return (
            ARM + wheel + "      - {name: other, model: M3508, id: 2, feedback_timeout_ms: 1000}\n"
        )

    def test_a_turn_by_hand_finds_it_and_the_lines_mend_it(
        self, page: Page, studio: Studio, card: Locator
    ) -> None:
        choose(page, "wheel")
        go_to(page, "Direction")
        # Its hand turns the other way, and as far as the file's ratio makes of it.
        for _ in range(5):
            begin_s = time.monotonic()
            press(card, "Begin")
            for _ in range(2):
                by_hand(studio, card, "wheel", -90)
            knows_the_turn(card, HALF_A_TURN_BACK)
            press(card, "The mark is back")
            if NOT_JUDGED not in told(card).inner_text() or not stood_still_since(
                begin_s, "half a turn by hand"
            ):
                break
        expect(told(card)).to_contain_text("instead of 360°")
        expect(told(card)).to_contain_text(re.compile(r"multiply gear_ratio by 0\.(49|50)\d"))
        go_to(page, "Lines")
        lines = card.get_by_label("Lines for the file, of", exact=True)
        expect(lines).to_have_text(re.compile(r"^direction: -1\ngear_ratio: 18(\.\d+)?$"))
        press(card, "Put them into the Configuration")
        editor = page.get_by_label("Text of the configuration")
        expect(editor).to_contain_text("name: wheel, direction: -1")
        expect(editor).to_contain_text(re.compile(r"gear_ratio: 18(\.\d+)?, on_timeout"))
        expect(page.locator(".verdict-badge")).to_contain_text("rc10d accepts it")

    def test_another_motor_that_turned_is_named(
        self, page: Page, studio: Studio, card: Locator
    ) -> None:
        choose(page, "wheel")
        go_to(page, "Direction")
        found = re.compile(r"other turned by 3\d\d\.\d°, and wheel did not")
        for _ in range(5):
            begin_s = time.monotonic()
            press(card, "Begin")
            studio.daemon.must("hand", "other", "--by", 360, "--rpm", 60)
            expect(card.locator(".live-angle")).to_have_text("0.0°")
            press(card, "The mark is back")
            # A page that stood still takes the angle of before.
            if found.search(told(card).inner_text()) or not stood_still_since(
                begin_s, "a turn of another motor"
            ):
                break
        expect(told(card)).to_contain_text(found)

    def test_it_does_not_spin_while_a_loop_would_act_at_its_end(
        self, page: Page, studio: Studio, card: Locator
    ) -> None:
        ready_to_spin(page, studio, card)
        alert = card.get_by_role("alert")
        expect(alert).to_contain_text("on_timeout: brake, on_disable: hold")
        expect(alert).to_contain_text("on_timeout: coast, on_disable: coast")
        expect(card.get_by_role("button", name="Hold to spin")).to_have_count(0)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("model", ["DM4310, id: 3, master_id: 19", "GM6020, id: 5"])
class TestTheZeroOfAnAbsoluteEncoder:
    """Its line for the file, by a second run of rc10d in which the shaft stands as in the first."""

    @pytest.fixture
    def robot(self, model: str, direction: int) -> str:
        return (
            ARM
            + f"""
      - {{name: wheel, model: {model}, direction: {direction}, zero_deg: 20,
         feedback_timeout_ms: 1000, simulated: {{initial_angle_deg: 50}}}}
"""
        )

    def test_the_line_keeps_it(self, page: Page, studio: Studio, card: Locator) -> None:
        # Somebody else has set it before.
        studio.daemon.ctl("zero", "wheel", "50")
        go_to(page, "Zero")
        for deg in ("15", "-70"):
            card.get_by_label("It stands at").fill(deg)
            press(card, "Set")
            expect(told(card)).to_contain_text(
                f"reads {deg.replace('-', MINUS)}.0° there now; zero_deg"
            )
            expect(card.locator(".live-angle")).to_have_text(f"{deg.replace('-', MINUS)}.0°")
        go_to(page, "Lines")
        line = card.get_by_label("Lines for the file, of", exact=True).inner_text()
        text = studio.daemon.config.read_text()
        studio.daemon.program.stop()
        studio.daemon.config.write_text(text.replace("zero_deg: 20", line))
        studio.daemon.start()
        studio.daemon.wait_ready()
        assert abs(angle(studio, "wheel") + 70) < 0.5
