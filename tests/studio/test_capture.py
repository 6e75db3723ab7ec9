"""Captures on the page: armed, triggered, compared, saved and opened again."""

from __future__ import annotations

import json
import time
from typing import TYPE_CHECKING, Any

import pytest
from again import again_where_it_let_go_by_itself, let_go_by_itself
from good_computer import as_on_a_good_computer
from hostlib.stalls import stood_still_since
from playwright.sync_api import Browser, Locator, Page, expect

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from conftest import Studio


@pytest.fixture
def panel(moving: Page) -> Locator:
    """The captures of yaw, which is ACTIVE and held by nobody."""
    found = moving.locator(".captures")
    expect(found.get_by_label("when").locator("option")).to_have_count(3)
    return found


# The target that the legend shows is none, or 0; the shaft may go on turning.
HAS_NO_TARGET = """() => [...document.querySelectorAll('.legend tr')]
  .filter((row) => row.textContent.includes('target'))
  .every((row) => !(parseFloat(row.querySelector('.number').textContent) >= 1))"""
SHAFT_STANDS = """() => [...document.querySelectorAll('.legend tr')]
  .filter((row) => row.textContent.includes('velocity_rpm'))
  .every((row) => {
    const rpm = row.querySelector('.number').textContent.replace('\N{MINUS SIGN}', '-');
    return Math.abs(parseFloat(rpm)) < 0.5;
  })"""


def press(page: Page) -> None:
    page.get_by_role("button", name="counter-clockwise", exact=True).hover()
    page.mouse.down()


def step(page: Page, panel: Locator, to_its_end: bool = True) -> None:
    """A step of 20 rpm, captured; one that the machine let go before its end may be removed."""
    before = panel.locator("tbody tr").count()
    newest = panel.locator("tbody tr").nth(before)
    while True:
        panel.get_by_role("button", name="Arm", exact=True).click()
        expect(panel.get_by_role("status")).to_have_text("armed: waits for the trigger")
        press(page)
        newest.or_(let_go_by_itself(page)).first.wait_for()
        held = let_go_by_itself(page).count() == 0
        page.mouse.up()
        if not held and "armed" in panel.get_by_role("status").inner_text():
            panel.get_by_role("button", name="Disarm", exact=True).click()
            page.wait_for_function(SHAFT_STANDS)
            continue
        expect(panel.locator("tbody tr")).to_have_count(before + 1)
        expect(panel.get_by_role("button", name="Arm", exact=True)).to_be_visible()
        if held or not to_its_end:
            return
        remove_last(page, panel)


def remove_last(page: Page, panel: Locator) -> None:
    """Its last capture; the next step begins from rest, too."""
    rows = panel.locator("tbody tr")
    before = rows.count()
    panel.get_by_role("button", name="Remove").last.click()
    expect(rows).to_have_count(before - 1)
    page.wait_for_function(SHAFT_STANDS)


def has_arrived(capture: dict[str, Any]) -> bool:
    """Its speed has followed its target, which was there to its end, and few ticks are missing."""
    target, measured, *_ = capture["values"]
    heard = [value for value in measured if value is not None]
    return 20.0 in target[-50:] and len(heard) > 1000 and max(heard) >= 18


def step_with(page: Page, panel: Locator, good: Callable[[dict[str, Any]], bool]) -> None:
    """A good step, captured; one in which the machine stood still is captured anew."""
    runs = 0
    while True:
        runs += 1
        begin_s = time.monotonic()
        step(page, panel)
        last = saved(page, panel)["captures"][-1]
        if good(last) or runs == 5 or not stood_still_since(begin_s, "a captured step"):
            return
        remove_last(page, panel)


def saved(page: Page, panel: Locator, name: str = "Save") -> dict[str, Any]:
    with page.expect_download() as download:
        panel.get_by_role("button", name=name, exact=True).click()
    content: dict[str, Any] = json.loads(download.value.path().read_text())
    return content


def test_a_step_is_captured_tick_by_tick_with_its_numbers_and_gains(
    page: Page, panel: Locator
) -> None:
    step_with(page, panel, has_arrived)
    row = panel.locator("tbody tr").first
    expect(row).to_contain_text("0.0 → 20.0 rpm")
    content = saved(page, panel)
    [capture] = content["captures"]
    assert content["format"] == "rc10 captures 1"
    assert capture["signals"] == ["yaw.target_shaped", "yaw.velocity_rpm", "yaw.current_a"]
    assert capture["units"] == ["rpm", "rpm", "A"]
    assert capture["period_s"] == 0.001
    assert capture["gains"]["velocity_pid.kp_a_per_rpm"] > 0
    assert len(capture["config_hash"]) == 64
    target, measured, _current = capture["values"]
    assert len(target) == len(measured) == 1200
    # The trigger is the tick in which the target crosses 5 rpm.
    at = round(capture["pre_s"] / capture["period_s"])
    assert target[at] >= 5
    assert target[at - 1] is None or target[at - 1] < 5
    assert max(value for value in measured if value is not None) >= 18


def test_their_picture_stays_while_states_arrive(page: Page, panel: Locator) -> None:
    with page.expect_websocket() as connection:
        page.reload()
    expect(page.locator(".badge.status")).to_have_text("ACTIVE")
    step(page, panel)
    picture = panel.locator(".overlay canvas").element_handle()
    for _ in range(5):
        connection.value.wait_for_event("framereceived", lambda payload: '"state"' in str(payload))
        page.evaluate("() => new Promise((done) => requestAnimationFrame(() => setTimeout(done)))")
    assert picture.evaluate("canvas => canvas.isConnected")


def test_captures_lie_over_one_another_and_can_be_named_and_removed(
    page: Page, panel: Locator
) -> None:
    step(page, panel)
    step(page, panel)
    expect(panel.locator(".overlay canvas")).to_be_visible()
    first = panel.locator("tbody tr").first
    first.get_by_label("name").fill("before")
    first.get_by_label("name").blur()
    expect(panel.get_by_role("checkbox", name="Show before")).to_be_checked()
    panel.get_by_role("button", name="Remove before").click()
    expect(panel.locator("tbody tr")).to_have_count(1)
    # The browser keeps the other.
    page.reload()
    page.locator("#tab-move").click()
    expect(page.locator(".captures tbody tr")).to_have_count(1)


def test_a_file_is_opened_by_a_page_without_a_robot(
    page: Page, panel: Locator, chromium: Browser, studio: Studio, tmp_path: Path
) -> None:
    step_with(page, panel, has_arrived)
    file = tmp_path / "captures.json"
    file.write_text(json.dumps(saved(page, panel)))
    studio.daemon.must("disable")
    context = chromium.new_context(locale="en-GB")
    other = context.new_page()
    other.goto(studio.url)
    other.locator("#tab-move").click()
    captures = other.locator(".captures")
    expect(captures.locator("tbody tr")).to_have_count(0)
    studio.daemon.kill()
    expect(other.get_by_role("region", name="rc10d is not running")).to_be_visible()
    captures.locator("input[type=file]").set_input_files(file)
    expect(captures.locator("tbody tr")).to_contain_text("0.0 → 20.0 rpm")
    context.close()
    studio.daemon.start()
    studio.daemon.wait_ready()


def a_step(**differing: object) -> dict[str, Any]:
    """A capture as a file has it."""
    return {
        "id": "1",
        "name": "step",
        "taken": "",
        "robot": "other",
        "config_hash": "",
        "gains": {},
        "signals": ["yaw.target_shaped", "yaw.velocity_rpm"],
        "units": ["rpm", "rpm"],
        "period_s": 0.001,
        "pre_s": 0.2,
        "values": [[0] * 200 + [20] * 300, [0] * 250 + [20] * 250],
        **differing,
    }


def opened(panel: Locator, file: Path, *captures: dict[str, Any]) -> None:
    file.write_text(json.dumps({"format": "rc10 captures 1", "captures": captures}))
    panel.locator("input[type=file]").set_input_files(file)


def test_captures_of_a_file_with_the_same_id_are_several(panel: Locator, tmp_path: Path) -> None:
    opened(panel, tmp_path / "same.json", a_step(name="a"), a_step(name="b"), a_step(name="c"))
    rows = panel.locator("tbody tr")
    expect(rows).to_have_count(3)
    rows.nth(1).get_by_label("name").fill("second")
    panel.get_by_role("button", name="Remove c").click()
    expect(panel.get_by_role("checkbox", name="Show a")).to_be_visible()
    expect(panel.get_by_role("checkbox", name="Show second")).to_be_visible()
    expect(rows).to_have_count(2)


def test_those_for_which_the_browser_has_no_room_are_each_written_once(
    page: Page, panel: Locator, tmp_path: Path
) -> None:
    long = [[0.123456789] * 20_000] * 2
    page.evaluate(
        """() => {
          const write = JSON.stringify;
          window.written = 0;
          JSON.stringify = (value) => {
            const text = write(value);
            window.written += text.length;
            return text;
          };
        }"""
    )
    captures = [a_step(id=str(i), values=long) for i in range(20)]
    opened(panel, tmp_path / "long.json", *captures)
    expect(panel.get_by_role("alert")).to_contain_text("has no room for the oldest of them (10)")
    assert page.evaluate("window.written") < 1.2 * len(json.dumps(captures, separators=(",", ":")))


def test_a_file_of_another_version_is_named_as_one(panel: Locator, tmp_path: Path) -> None:
    file = tmp_path / "later.json"
    file.write_text('{"format": "rc10 captures 2", "captures": []}')
    panel.locator("input[type=file]").set_input_files(file)
    expect(panel.get_by_role("alert")).to_contain_text("Another version of rc10 Studio")


@pytest.mark.parametrize(
    "content",
    [
        "",
        "{}",
        "[1]",
        '{"format":"rc10 captures 1","captures":[{}]}',
        '{"format":"rc10 captures 1","captures":[{"id":"<img src=x onerror=alert(1)>"}]}',
        '{"format":"rc10 captures 1","captures":7}',
    ],
)
def test_a_file_of_a_stranger_is_refused_in_words(
    panel: Locator, tmp_path: Path, content: str
) -> None:
    file = tmp_path / "stranger.json"
    file.write_text(content)
    panel.locator("input[type=file]").set_input_files(file)
    expect(panel.get_by_role("alert")).to_have_text(
        "This is no file of captures, or one of more than 200."
    )
    expect(panel.locator("tbody tr")).to_have_count(0)


def test_names_of_a_strangers_file_are_text(panel: Locator, page: Page, tmp_path: Path) -> None:
    hostile = '<img src=x onerror="window.hit=1">'
    capture = {
        "id": hostile,
        "name": hostile,
        "taken": hostile,
        "robot": hostile,
        "config_hash": "",
        "gains": {hostile: 1},
        "signals": [hostile, hostile],
        "units": [hostile, hostile],
        "period_s": 0.001,
        "pre_s": 0.001,
        "values": [[0, 1, 1], [0, 1, None]],
    }
    file = tmp_path / "hostile.json"
    file.write_text(json.dumps({"format": "rc10 captures 1", "captures": [capture]}))
    panel.locator("input[type=file]").set_input_files(file)
    expect(panel.locator("tbody tr")).to_have_count(1)
    assert page.evaluate("window.hit") is None


def test_an_event_triggers_and_the_ticks_before_it_are_there(
    page: Page, panel: Locator, studio: Studio
) -> None:
    # Ticks that a busy computer misses are a warning too.
    as_on_a_good_computer(page)
    expect(page.locator(".badge.status")).to_have_text("ACTIVE")
    panel.get_by_label("edge").select_option("event")
    panel.get_by_role("button", name="Arm", exact=True).click()
    expect(panel.get_by_role("status")).to_have_text("armed: waits for the trigger")
    studio.daemon.must("estop")
    expect(panel.locator("tbody tr")).to_have_count(1)
    [capture] = saved(page, panel)["captures"]
    assert capture["pre_s"] == pytest.approx(0.2, abs=0.002)
    assert len(capture["values"][1]) == 1200


def test_a_long_capture_is_whole(page: Page, panel: Locator) -> None:
    panel.get_by_label("after it").fill("4.2")
    # A busy computer leaves ticks out, others each time; a gap where pieces are joined is in all.
    for _ in range(5):
        step(page, panel, to_its_end=False)
        captures = [capture["values"][1] for capture in saved(page, panel)["captures"]]
        assert all(len(measured) == 4400 for measured in captures)
        gaps = [{i for i in range(4000, 4200) if measured[i] is None} for measured in captures]
        if not set.intersection(*gaps):
            return
    pytest.fail("a gap at the same place of each capture")


def test_an_angle_of_a_program_stands_on_the_axis_of_its_target(
    page: Page, panel: Locator, studio: Studio
) -> None:
    page.get_by_label("angle targets").check()
    expect(panel.get_by_label("when").locator("option")).to_have_count(4)
    panel.get_by_label("level").fill("60")
    panel.get_by_role("button", name="Arm", exact=True).click()
    expect(panel.get_by_role("status")).to_have_text("armed: waits for the trigger")
    with studio.daemon.drive("set", "yaw", "total_angle", "90", "--for", "60s"):
        expect(panel.locator("tbody tr")).to_contain_text("→ 90.0 °")


@again_where_it_let_go_by_itself
def test_what_is_armed_can_be_disarmed(page: Page, panel: Locator) -> None:
    panel.get_by_role("button", name="Arm", exact=True).click()
    panel.get_by_role("button", name="Disarm", exact=True).click()
    press(page)
    expect(page.locator(".jog.held")).to_be_visible()
    page.wait_for_function("document.querySelectorAll('.legend .number').length >= 3")
    page.mouse.up()
    # A step that the page hears of late must not trigger the next one.
    page.wait_for_function(HAS_NO_TARGET)
    # A capture takes a second: one that was under way would be there beside the next.
    step(page, panel)
    expect(panel.locator("tbody tr")).to_have_count(1)


FILL = """() => {
  for (let size = 1 << 22; size >= 1; size >>= 1) {
    try {
      while (true) localStorage.setItem('filler' + localStorage.length, 'x'.repeat(size));
    } catch {}
  }
}"""


def test_captures_beyond_the_browsers_room_are_counted_until_there_is_some(
    page: Page, panel: Locator
) -> None:
    page.evaluate(FILL)
    step(page, panel)
    expect(panel.get_by_role("alert")).to_contain_text("no room for the oldest of them (1)")
    step(page, panel)
    expect(panel.get_by_role("alert")).to_contain_text("no room for the oldest of them (2)")
    assert len(saved(page, panel)["captures"]) == 2
    page.evaluate("() => localStorage.clear()")
    panel.get_by_role("button", name="Remove yaw 1").click()
    expect(panel.get_by_role("alert")).to_have_count(0)
    page.reload()
    page.locator("#tab-move").click()
    expect(page.locator(".captures tbody tr")).to_have_count(1)
