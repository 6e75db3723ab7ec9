"""One motor by hand on the page: held, let go, and its gains."""

from __future__ import annotations

import json
import threading
from typing import TYPE_CHECKING

import pytest
from again import again_where_it_let_go_by_itself
from hostlib import Daemon
from hostlib.daemon import CONFIG, Motor
from playwright.sync_api import Browser, Locator, Page, expect

from conftest import Studio

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

# rc10-web's lease, and a tick in which it ends.
LEASE_US = 150_000 + 1_000


def button(page: Page) -> Locator:
    return page.get_by_role("button", name="counter-clockwise", exact=True)


def press(page: Page) -> None:
    button(page).hover()
    page.mouse.down()


def turns(studio: Studio) -> Motor:
    return studio.daemon.wait_motor(
        "yaw", lambda m: m["acting"] == "target" and m["target"] == 20, "it is held"
    )


def rests(studio: Studio) -> Motor:
    return studio.daemon.wait_motor(
        "yaw", lambda m: m["acting"] == "nothing" and m["owner"] == "", "it is let go"
    )


class Watch:
    """The oldest command that moved yaw, in every state that rc10d publishes meanwhile."""

    def __init__(self, daemon: Daemon) -> None:
        self.oldest_us = 0
        self._feed = daemon.drive("watch", "--json", "--hz", "100")
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._follow, daemon=True)
        self._thread.start()

    def _follow(self) -> None:
        while not self._end.is_set():
            state = json.loads(self._feed.wait_line(r"^\{.*\}$", 20.0)[0])
            [yaw] = [motor for motor in state["motors"] if motor["name"] == "yaw"]
            if yaw["acting"] == "target" and yaw["target"] != 0:
                self.oldest_us = max(self.oldest_us, yaw["command_age_us"])

    def end(self) -> int:
        self._end.set()
        self._thread.join(30)
        self._feed.stop()
        return self.oldest_us


@pytest.fixture
def watch(studio: Studio) -> Iterator[Watch]:
    running = Watch(studio.daemon)
    yield running
    assert running.end() <= LEASE_US


@again_where_it_let_go_by_itself
def test_a_held_button_moves_the_motor_and_its_release_ends_that(
    moving: Page, studio: Studio, watch: Watch
) -> None:
    press(moving)
    assert turns(studio)["owner"] == "web-1 127.0.0.1"
    expect(button(moving)).to_have_class("jog held")
    moving.mouse.up()
    rests(studio)
    assert watch.oldest_us >= 0
    moving.get_by_role("button", name="clockwise", exact=True).hover()
    moving.mouse.down()
    studio.daemon.wait_motor("yaw", lambda m: m["target"] == -20, "the other way")
    moving.mouse.up()
    rests(studio)


@again_where_it_let_go_by_itself
def test_an_arrow_key_holds_it_too(moving: Page, studio: Studio, watch: Watch) -> None:
    moving.get_by_role("group", name="Hold a button").focus()
    moving.keyboard.down("ArrowRight")
    turns(studio)
    moving.keyboard.up("ArrowRight")
    rests(studio)
    assert watch.oldest_us >= 0


ENDS: dict[str, tuple[Callable[[Page], object], str]] = {
    "blur": (
        lambda page: page.evaluate("window.dispatchEvent(new Event('blur'))"),
        "page was left",
    ),
    "hidden": (
        lambda page: page.evaluate(
            "Object.defineProperty(document, 'hidden', {value: true, configurable: true});"
            "document.dispatchEvent(new Event('visibilitychange'))"
        ),
        "page was left",
    ),
    "second finger": (
        lambda page: page.evaluate(
            "window.dispatchEvent(new PointerEvent('pointerdown', {pointerId: 77, bubbles: true}))"
        ),
        "something else was pressed",
    ),
    "cancelled pointer": (
        lambda page: page.evaluate(
            "document.querySelector('.jog.held')"
            ".dispatchEvent(new PointerEvent('pointercancel', {bubbles: true}))"
        ),
        "page was left",
    ),
    "another key": (
        lambda page: page.evaluate(
            "window.dispatchEvent(new KeyboardEvent('keydown', {key: ' ', bubbles: true}))"
        ),
        "something else was pressed",
    ),
    "the other arrow": (
        lambda page: page.evaluate(
            "document.querySelector('.jog-buttons')"
            ".dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowLeft', bubbles: true}))"
        ),
        "something else was pressed",
    ),
}


@pytest.mark.parametrize("end", list(ENDS))
@again_where_it_let_go_by_itself
def test_it_is_let_go_by_all_that_is_not_holding(
    moving: Page, studio: Studio, watch: Watch, end: str
) -> None:
    act, words = ENDS[end]
    press(moving)
    turns(studio)
    act(moving)
    rests(studio)
    expect(moving.locator(".jogs [role=status]")).to_contain_text(words)
    # The finger is still there: that moves nothing any more.
    assert studio.daemon.state()["motors"][2]["owner"] == ""
    moving.mouse.up()
    assert watch.oldest_us >= 0


@again_where_it_let_go_by_itself
def test_a_key_is_let_go_wherever_the_focus_has_gone(
    moving: Page, studio: Studio, watch: Watch
) -> None:
    button(moving).click()  # the focus is in a button of the group
    rests(studio)
    moving.keyboard.down("ArrowRight")
    turns(studio)
    moving.locator("#tab-move").focus()
    rests(studio)
    moving.keyboard.up("ArrowRight")
    # And where the focus stays, a click beside it is another pointer.
    button(moving).focus()
    moving.keyboard.down("ArrowRight")
    turns(studio)
    moving.locator("h1").click()
    rests(studio)
    moving.keyboard.up("ArrowRight")
    assert watch.oldest_us >= 0


@again_where_it_let_go_by_itself
def test_only_the_first_button_of_a_mouse_holds(moving: Page, studio: Studio) -> None:
    button(moving).hover()
    moving.mouse.down(button="right")
    moving.mouse.up(button="right")
    press(moving)
    turns(studio)
    # No pointerup comes while another button is down.
    moving.mouse.down(button="right")
    rests(studio)
    moving.mouse.up()
    moving.mouse.up(button="right")


@again_where_it_let_go_by_itself
def test_a_page_that_is_gone_lets_go(chromium: Browser, studio: Studio, watch: Watch) -> None:
    context = chromium.new_context()
    gone = context.new_page()
    gone.goto(studio.url)
    gone.locator("#tab-move").click()
    gone.get_by_label("Motor").select_option("yaw")
    studio.daemon.must("enable", "yaw")
    expect(gone.locator(".badge.status")).to_have_text("ACTIVE")
    press(gone)
    turns(studio)
    context.close()
    rests(studio)
    assert watch.oldest_us >= 0


@again_where_it_let_go_by_itself
def test_a_page_that_stands_still_lets_go(moving: Page, studio: Studio, watch: Watch) -> None:
    press(moving)
    turns(studio)
    # Its timers stand still: nothing is renewed, and nobody says that it was let go.
    moving.evaluate("{ const end = performance.now() + 600; while (performance.now() < end); }")
    rests(studio)
    expect(moving.locator(".jogs [role=status]")).to_contain_text("stood still")
    moving.mouse.up()
    assert watch.oldest_us >= 0


@again_where_it_let_go_by_itself
def test_of_two_pages_the_second_sees_who_has_the_motor(
    moving: Page, chromium: Browser, studio: Studio
) -> None:
    context = chromium.new_context()
    second = context.new_page()
    second.goto(studio.url)
    second.locator("#tab-move").click()
    second.get_by_label("Motor").select_option("yaw")
    press(moving)
    turns(studio)
    expect(second.get_by_text("by web-1 127.0.0.1")).to_be_visible()
    press(second)
    expect(second.locator(".jogs [role=status]")).to_contain_text("commanded by web-1 127.0.0.1")
    assert turns(studio)["owner"] == "web-1 127.0.0.1"
    second.mouse.up()
    moving.mouse.up()
    rests(studio)
    context.close()


@again_where_it_let_go_by_itself
def test_the_size_and_the_mode_are_those_that_were_entered(moving: Page, studio: Studio) -> None:
    jogs = moving.locator(".jogs")
    # A repetition finds the mode in which the one before has ended.
    jogs.get_by_label("mode").select_option("velocity")
    jogs.get_by_label("rpm").fill("35")
    jogs.get_by_label("rpm").blur()
    press(moving)
    studio.daemon.wait_motor("yaw", lambda m: m["target"] == 35, "35 rpm")
    moving.mouse.up()
    rests(studio)
    jogs.get_by_label("mode").select_option("current")
    press(moving)
    studio.daemon.wait_motor(
        "yaw", lambda m: m["mode"] == "current" and m["target"] == 0.5, "half an ampere"
    )
    moving.mouse.up()
    rests(studio)


def gain(studio: Studio, key: str = "velocity_pid.kp_a_per_rpm") -> float:
    lines = json.loads(studio.daemon.must("gains", "yaw", "--json"))
    return float(lines["gains"][key])


def test_gains_are_applied_undone_and_kept_as_lines(moving: Page, studio: Studio) -> None:
    gains = moving.locator(".gains")
    field = gains.get_by_label("velocity_pid.kp")
    before = gain(studio)
    expect(field).to_have_value(f"{before:g}")
    apply = gains.get_by_role("button", name="Apply")
    expect(apply).to_be_disabled()
    field.fill("0.25")
    lines = [copy.get_attribute("title") or "" for copy in gains.locator(".copy").all()]
    assert lines[0].endswith("rc10ctl gains yaw velocity_pid.kp_a_per_rpm=0.25")
    assert lines[1].endswith('robot.set_gains("yaw", {"velocity_pid.kp_a_per_rpm": 0.25})')
    apply.click()
    expect(gains.get_by_role("button", name="Undo (1)")).to_be_enabled()
    assert gain(studio) == 0.25
    gains.get_by_text("Lines for the robot").click()
    expect(gains.locator("pre")).to_contain_text("kp_a_per_rpm: 0.25")
    gains.get_by_role("button", name="Undo (1)").click()
    expect(field).to_have_value(f"{before:g}")
    assert gain(studio) == before
    # Nothing of it is applied where one is wrong.
    field.fill("-1")
    apply.click()
    expect(gains.get_by_role("alert")).to_contain_text("velocity_pid.kp_a_per_rpm")
    assert gain(studio) == before


def test_undo_leaves_what_somebody_else_has_changed(moving: Page, studio: Studio) -> None:
    gains = moving.locator(".gains")
    field = gains.get_by_role("spinbutton", name="velocity_pid.kp_a_per_rpm")
    before = gain(studio)
    for kp in ("0.25", "0.26"):
        field.fill(kp)
        gains.get_by_role("button", name="Apply").click()
        expect(gains.get_by_role("button", name="Apply")).to_be_disabled()
    expect(gains.get_by_role("button", name="Undo (2)")).to_be_enabled()
    studio.daemon.must("gains", "yaw", "velocity.ki=3.5")
    expect(gains.get_by_role("spinbutton", name="velocity_pid.ki_a_per_rpm_s")).to_have_value("3.5")
    gains.get_by_text("History").click()
    gains.get_by_role("listitem").nth(1).get_by_role("button").click()
    expect(field).to_have_value(f"{before:g}")
    assert gain(studio) == before
    assert gain(studio, "velocity_pid.ki_a_per_rpm_s") == 3.5
    # Gains that are as they were before are undone, too.
    field.fill("0.25")
    gains.get_by_role("button", name="Apply").click()
    expect(gains.get_by_role("button", name="Undo (1)")).to_be_enabled()
    studio.daemon.must("gains", "yaw", f"velocity.kp={before}")
    expect(field).to_have_value(f"{before:g}")
    gains.get_by_role("button", name="Undo (1)").click()
    expect(gains.get_by_role("button", name="Undo", exact=True)).to_be_disabled()
    expect(gains.get_by_role("alert")).to_have_count(0)


def test_locked_gains_are_refused_with_the_line(chromium: Browser) -> None:
    with Daemon(CONFIG.format(realtime="preferred") + "tuning: locked\n") as daemon:
        daemon.wait_ready()
        studio = Studio(daemon)
        context = chromium.new_context(locale="en-GB")
        page = context.new_page()
        page.goto(studio.url)
        page.locator("#tab-move").click()
        page.get_by_label("Motor").select_option("yaw")
        gains = page.locator(".gains")
        gains.get_by_label("velocity_pid.kp").fill("0.25")
        gains.get_by_role("button", name="Apply").click()
        expect(gains.get_by_role("alert")).to_contain_text("tuning: locked")
        context.close()
        studio.web.stop()


def test_a_motor_that_a_page_enabled_rests_when_the_page_is_gone(
    chromium: Browser, studio: Studio
) -> None:
    with chromium.new_context(locale="en-GB") as context:
        page = context.new_page()
        page.goto(studio.url)
        page.locator("#tab-move").click()
        page.get_by_label("Motor").select_option("yaw")
        page.get_by_role("button", name="Enable", exact=True).click()
        expect(page.locator(".badge.status")).to_have_text("ACTIVE")
    studio.daemon.wait_motor("yaw", lambda m: m["status"] == "READY", "disabled")
