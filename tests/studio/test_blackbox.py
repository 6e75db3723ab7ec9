"""The black box on the page: a recording of a robot, read, scrubbed, damaged and forged."""

from __future__ import annotations

import base64
import re
import struct
from typing import TYPE_CHECKING

import pytest
from hostlib.daemon import REPO
from playwright.sync_api import Browser, Page, expect
from recorded import Box, field_at, format_of, patched

from conftest import PATIENCE_MS, Studio

if TYPE_CHECKING:
    from pathlib import Path

# Offsets in src/blackbox/format.hpp: magic, version, pid, file_bytes.
VERSION_AT = 8
FILE_BYTES_AT = 16


@pytest.fixture
def part(page: Page) -> Page:
    page.locator("#tab-blackbox").click()
    return page


def opened(part: Page, folder: Path, content: bytes, name: str = "host.blackbox") -> Page:
    file = folder / name
    file.write_bytes(content)
    part.locator("input[type=file]").set_input_files(file)
    expect(part.locator(".reading")).to_have_text("")
    return part


def value_of(page: Page, motor: str, reading: str) -> float:
    cell = page.locator(".moment tr", has=page.get_by_role("rowheader", name=motor, exact=True))
    text = cell.locator(f".{reading}").inner_text()
    return float(text.split()[0].replace("\N{MINUS SIGN}", "-"))


def scrub(page: Page, seconds: float) -> float:
    """To the last tick before this moment, of which the microseconds are returned."""
    at_s: float = page.get_by_label("Moment").evaluate(
        """(slider, seconds) => {
            const [first, step] = [Number(slider.min), Number(slider.step)];
            slider.value = first + (Math.ceil((seconds - first) / step) - 1) * step;
            slider.dispatchEvent(new Event('input', {bubbles: true}));
            return Number(slider.value);
        }""",
        seconds,
    )
    return at_s * 1e6


def press(page: Page, button: str, times: int) -> None:
    """A button, all at once."""
    page.get_by_role("button", name=button).evaluate(
        "(button, times) => { for (let i = 0; i < times; ++i) button.click(); }", times
    )


def test_a_recording_is_shown_and_scrubbing_moves_the_values(
    part: Page, box: Box, tmp_path: Path
) -> None:
    opened(part, tmp_path, box.bytes)
    card = part.locator(".recording")
    expect(card).to_contain_text("host · rc10d")
    expect(card).to_contain_text(f"event {len(box.of('event'))}")
    expect(card).to_contain_text(f"frame {len(box.of('frame'))}")
    expect(card.get_by_role("alert")).to_have_count(0)
    # The end, at first.
    expect(part.locator(".badge.robot").last).to_have_text("ESTOP")
    at_end = [record for record in box.of("motor") if record["motor"] == "wheel"][-1]
    assert value_of(part, "wheel", "velocity_rpm") == pytest.approx(
        at_end["velocity_rpm"], abs=0.06
    )
    # Just before the stop it turned: as rc10ctl reads it.
    at_us = scrub(part, box.stop_us / 1e6 - 1e-5)
    expect(part.locator(".badge.robot").last).to_have_text("RUN")
    before = [
        record
        for record in box.of("motor")
        if record["motor"] == "wheel"
        and record["mono_us"] - box.records[0]["mono_us"] <= at_us + 1.5
    ][-1]
    assert value_of(part, "wheel", "velocity_rpm") == pytest.approx(
        before["velocity_rpm"], abs=0.06
    )
    assert value_of(part, "wheel", "velocity_rpm") > 5
    # The chart has the chosen signals; another one is chosen.
    expect(part.locator(".legend tr")).to_have_count(2)
    part.get_by_role("group", name="yaw").get_by_label("angle_deg", exact=True).check()
    expect(part.locator(".legend tr")).to_have_count(3)
    expect(part.locator(".chart canvas")).to_be_visible()


def test_events_frames_and_the_tick_are_told_in_words(part: Page, box: Box, tmp_path: Path) -> None:
    opened(part, tmp_path, box.bytes)
    events = part.get_by_role("region", name="Events")
    stop = events.locator("tr", has_text="RUN -> ESTOP").first
    expect(stop).to_contain_text("asked for by 'rc10ctl")
    stop.get_by_role("button").click()
    expect(stop).to_have_class(re.compile("here"))
    tick = box.tick_at(box.stop_us)
    expect(part.locator(".tick")).to_have_text(f"tick {tick}")
    frames = part.get_by_role("region", name="Frames")
    expect(frames.locator("tr", has_text="DJI command of 1 to 4").first).to_be_visible()
    expect(frames.locator("tr", has_text="feedback: encoder").first).to_be_visible()
    part.get_by_label("id or bus").fill("202")
    expect(frames.locator("td.bytes").first).to_have_text(re.compile("^202#"))
    expect(frames.locator("td.bytes", has_text=re.compile("^20[01]#"))).to_have_count(0)
    expect(frames.locator("tr", has_text="DJI 2 feedback").first).to_be_visible()
    orders = part.get_by_role("region", name="Commands and requests")
    expect(orders.locator("tr", has_text="estop").first).to_be_visible()
    expect(orders.locator("tr", has_text="wheel velocity 60 rpm").first).to_be_visible()
    # Event by event, and tick by tick, by the keyboard too.
    part.get_by_role("button", name="the event before").click()
    expect(stop).not_to_have_class(re.compile("here"))
    part.get_by_role("button", name="the next event").click()
    expect(part.locator(".tick")).to_have_text(f"tick {tick}")
    part.get_by_role("button", name="one tick back").press("Enter")
    expect(stop).not_to_have_class(re.compile("here"))
    part.get_by_role("button", name="one tick on").press("Enter")
    expect(stop).to_have_class(re.compile("here"))
    expect(part.locator(".tick")).to_have_text(f"tick {tick}")
    # Presses that overtake the reader are all counted.
    slider = part.get_by_label("Moment")
    for _ in range(5):
        at = slider.input_value()
        press(part, "one tick back", 1)
        expect(slider).not_to_have_value(at)
    five_back = slider.input_value()
    press(part, "one tick on", 5)
    expect(stop).to_have_class(re.compile("here"))
    press(part, "one tick back", 5)
    expect(slider).to_have_value(five_back)
    press(part, "one tick on", 5)
    expect(stop).to_have_class(re.compile("here"))
    before = slider.input_value()
    slider.press("ArrowLeft")
    assert float(slider.input_value()) == pytest.approx(float(before) - 0.001, abs=1e-6)
    expect(stop).not_to_have_class(re.compile("here"))


def test_a_dropped_file_is_read_and_another_part_of_the_page_does_not_lose_it(
    part: Page, box: Box
) -> None:
    # As a browser hands it over.
    part.evaluate(
        """(text) => {
            const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
            const data = new DataTransfer();
            data.items.add(new File([bytes], 'dropped.blackbox'));
            document.querySelector('main').dispatchEvent(
                new DragEvent('drop', {dataTransfer: data, bubbles: true, cancelable: true}));
        }""",
        base64.b64encode(box.bytes).decode(),
    )
    expect(part.locator(".recording h3")).to_have_text("dropped.blackbox")
    part.locator("#tab-events").click()
    part.locator("#tab-blackbox").click()
    expect(part.locator(".recording h3")).to_have_text("dropped.blackbox")
    expect(part.locator(".badge.robot").last).to_have_text("ESTOP")


def test_the_last_minutes_of_the_robot_that_runs_are_loaded(part: Page, studio: Studio) -> None:
    studio.daemon.must("enable", "wheel")
    studio.daemon.wait_motor("wheel", lambda motor: motor["status"] == "ACTIVE", "enabled")
    expect(part.get_by_label("On the robot").locator("option").first).to_have_text(
        "host.blackbox (the last minutes)"
    )
    part.get_by_role("button", name="Load").click()
    expect(part.locator(".recording")).to_contain_text("host · rc10d")
    expect(part.locator(".recording").get_by_role("alert")).to_have_count(0)
    events = part.get_by_role("region", name="Events")
    expect(events.locator("tr", has_text="ENABLING -> ACTIVE").first).to_be_visible()
    # A copy that is made meanwhile, and the recording of an rc10d that has ended.
    studio.daemon.must("estop")
    studio.daemon.program.wait_line(r"-estop\.blackbox")
    studio.daemon.kill()
    part.get_by_label("On the robot").focus()
    copy = part.get_by_label("On the robot").locator("option", has_text="-estop.blackbox")
    expect(copy).to_have_count(1)
    part.get_by_role("button", name="Load").click()
    expect(part.locator(".badge.robot").last).to_have_text("ESTOP")
    part.get_by_label("On the robot").select_option(label=copy.inner_text())
    part.get_by_role("button", name="Load").click()
    expect(part.locator(".recording")).to_contain_text("a copy, made because of: estop")


def test_what_is_no_recording_is_refused_in_words_and_the_page_lives(
    part: Page, studio: Studio, box: Box, tmp_path: Path
) -> None:
    counts = {name: field_at(studio, "header", name) for name in ("motor_count", "ring_bytes")}
    random = bytes((i * 2654435761 >> 13) & 0xFF for i in range(1 << 20))
    cases = {
        "The file is empty.": b"",
        "This is no black box of rc10d.": random,
        "format 99; this page reads": patched(box.bytes, VERSION_AT, struct.pack("<I", 99)),
        "within its head: it has 100 bytes": box.bytes[:100],
        "motor_count is 4294967295": patched(box.bytes, counts["motor_count"], b"\xff\xff\xff\xff"),
        "ring_bytes is ": patched(box.bytes, counts["ring_bytes"], b"\xff" * 8),
        "file_bytes is ": patched(box.bytes, FILE_BYTES_AT, struct.pack("<Q", 1 << 40)),
    }
    for told, content in cases.items():
        opened(part, tmp_path, content)
        expect(part.get_by_role("alert")).to_contain_text(told)
        expect(part.get_by_role("alert")).to_contain_text("host.blackbox")
        expect(part.locator(".recording")).to_have_count(0)
    opened(part, tmp_path, box.bytes)
    expect(part.locator(".recording")).to_be_visible()
    expect(part.get_by_role("alert")).to_have_count(0)
    part.get_by_role("button", name="STOP").click()
    expect(part.locator(".stop-told")).to_have_text("stopped: confirmed")


def newest_frame(part: Page) -> str:
    """The bytes of the last frame: the page begins at the end of a recording."""
    return part.get_by_role("region", name="Frames").locator("td.bytes").last.inner_text()


def test_a_damaged_file_shows_what_is_whole_and_says_where_it_broke(
    part: Page, box: Box, tmp_path: Path
) -> None:
    opened(part, tmp_path, box.bytes)
    last = newest_frame(part)
    cut = len(box.bytes) * 3 // 4
    opened(part, tmp_path, box.bytes[:cut])
    expect(part.get_by_role("alert")).to_contain_text(
        f"cut off at byte {cut}: {len(box.bytes) - cut} bytes are missing"
    )
    expect(part.locator(".recording")).to_contain_text(re.compile(r"frame [1-9]\d\d"))
    # Those of the last milliseconds are in the other ring, which is before the cut.
    assert newest_frame(part) == last
    # A hole in the history, somewhere in its middle.
    hole = len(box.bytes) * 3 // 4 // 8 * 8
    opened(part, tmp_path, patched(box.bytes, hole, bytes(4096)))
    expect(part.get_by_role("alert")).to_contain_text(re.compile(r"Damaged at byte \d+, after"))
    expect(part.locator(".recording")).to_contain_text(re.compile(r"frame [1-9]\d\d\d"))
    expect(part.locator(".scrubber")).to_be_visible()


def test_names_of_a_strangers_recording_are_text(
    part: Page, studio: Studio, box: Box, tmp_path: Path
) -> None:
    tables = format_of(studio)["tables"]
    hostile = b"<img src=x onerror=hit=1>"
    content = patched(box.bytes, tables["motors"]["at"], hostile)
    content = patched(content, field_at(studio, "header", "robot"), hostile)
    opened(part, tmp_path, content)
    expect(part.locator(".recording")).to_contain_text(hostile.decode())
    expect(part.get_by_role("rowheader", name=hostile.decode())).to_be_visible()
    assert part.evaluate("window.hit") is None


@pytest.mark.parametrize(
    ("language", "width", "scheme"), [("zh-CN", 390, "dark"), ("en-GB", 1280, "light")]
)
def test_a_recording_sticks_out_nowhere_and_all_can_use_it(
    chromium: Browser,
    studio: Studio,
    box: Box,
    tmp_path: Path,
    language: str,
    width: int,
    scheme: str,
) -> None:
    context = chromium.new_context(
        viewport={"width": width, "height": 844},
        locale=language,
        color_scheme="dark" if scheme == "dark" else "light",
    )
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.goto(studio.url)
    page.locator("#tab-blackbox").click()
    # Cut off, so that the words for it are there too.
    opened(page, tmp_path, box.bytes[: len(box.bytes) * 3 // 4])
    page.locator("td.bytes").first.wait_for()
    page.evaluate("new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.evaluate((REPO / "web" / "node_modules" / "axe-core" / "axe.min.js").read_text())
    found = page.evaluate("axe.run().then((result) => result.violations)")
    serious = [
        (one["id"], [node["html"] for node in one["nodes"]][:3])
        for one in found
        if one["impact"] in ("serious", "critical")
    ]
    assert serious == []
    context.close()
