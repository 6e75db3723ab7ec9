"""Below the curves: one signal over another, and spectra."""

from __future__ import annotations

import json
import math
import re
import struct
import time
from collections.abc import Callable
from typing import Any

import pytest
from hostlib.stalls import stood_still_since
from playwright.sync_api import Page, WebSocketRoute, expect

from conftest import Studio

NONE = "\N{EN DASH}"
MINUS = "\N{MINUS SIGN}"
XY = f"X{NONE}Y"

# Values of a signal by its place, at a time in seconds.
Signal = Callable[[int, float], float]


def answer_the_past(page: Page, signal: Signal) -> None:
    """Questions about the past are answered by this; all else goes to rc10-web."""

    def relay(socket: WebSocketRoute) -> None:
        server = socket.connect_to_server()
        view: dict[str, Any] = {"view": 0, "signals": []}

        def handle(message: str | bytes) -> None:
            told = json.loads(message)
            if told["type"] == "view":
                view.update(told)
            if told["type"] != "range":
                server.send(message)
                return
            first, width, count = told["first_column"], told["column_us"], told["count"]
            frame = struct.pack(
                "<BBHIIIdd", 1, 3, len(view["signals"]), count, view["view"], 0, first, width
            )
            for place in range(len(view["signals"])):
                values = [signal(place, (first + i) * width / 1e6) for i in range(count)]
                frame += struct.pack(f"<{2 * count}f", *values, *values)
            socket.send(frame)

        socket.on_message(handle)

    page.route_web_socket("**/link", relay)
    page.reload()
    page.locator(".badge.live").wait_for()
    page.locator("#tab-plots").click()
    expect(page.locator(".plot > .legend tr")).to_have_count(2)


@pytest.mark.parametrize("hz", [40.0, 40.3, 40.7, 321.5])
def test_a_sine_is_found_with_its_frequency_and_its_peak_value(page: Page, hz: float) -> None:
    def signal(place: int, time_s: float) -> float:
        return 5.0 + (place + 1) * 3.0 * math.sin(2 * math.pi * hz * time_s)

    answer_the_past(page, signal)
    page.get_by_role("button", name="Spectrum (FFT)").click()
    rows = page.locator(".peaks tr")
    for place, (amplitude, unit) in enumerate(((3.0, "rpm"), (6.0, "A"))):
        row = rows.nth(place)
        expect(row).to_contain_text(" Hz")
        told = [cell.split() for cell in row.locator("td.number").all_inner_texts()]
        assert [words[1] for words in told] == ["Hz", unit]
        # Between two bins, which are 0.98 Hz apart.
        assert float(told[0][0]) == pytest.approx(hz, abs=0.02)
        assert float(told[1][0]) == pytest.approx(amplitude, rel=0.005)


def test_lost_ticks_are_bridged_and_too_many_are_said(page: Page) -> None:
    lost = {"every": 20}

    def signal(_: int, time_s: float) -> float:
        tick = round(time_s * 1000)
        return math.nan if tick % lost["every"] == 0 else math.sin(2 * math.pi * 10.0 * time_s)

    answer_the_past(page, signal)
    page.get_by_role("button", name="Spectrum (FFT)").click()
    expect(page.locator(".peaks tr").first).to_contain_text(re.compile(r"(9\.99|10\.0\d) Hz"))
    lost["every"] = 3
    expect(page.get_by_text("Too few ticks")).to_be_visible()
    expect(page.locator(".peaks tr").first).to_contain_text(NONE)


def test_one_signal_is_drawn_over_another(page: Page) -> None:
    def signal(place: int, time_s: float) -> float:
        turn = 2 * math.pi * time_s
        return 200.0 * math.cos(turn) if place == 0 else 4.0 * math.sin(turn)

    answer_the_past(page, signal)
    page.get_by_role("button", name=XY).click()
    expect(page.get_by_text(f"wheel.velocity_rpm {MINUS}200.00 … 200.00 rpm")).to_be_visible()
    expect(page.get_by_text(f"wheel.current_a {MINUS}4.00 … 4.00 A")).to_be_visible()
    # A ring: its colour is on both sides of the middle, and not in it.
    canvas = page.locator(".side-chart canvas")
    across = """(canvas) => {
      const { width, height } = canvas;
      const { data } = canvas.getContext('2d').getImageData(0, height * 0.45, width, 1);
      const found = [];
      for (let x = 0; x < width; ++x) {
        const [red, green, blue] = data.slice(4 * x);
        if (red < 60 && green > 80 && blue > 140) found.push(x / width);
      }
      return found;
    }"""
    page.wait_for_function(
        f"() => ({across})(document.querySelector('.side-chart canvas')).length >= 2"
    )
    found = canvas.evaluate(across)
    assert min(found) < 0.4
    assert max(found) > 0.7
    assert [x for x in found if 0.45 < x < 0.65] == []
    # Its signals are chosen.
    page.get_by_role("combobox", name="X", exact=True).select_option("wheel.current_a")
    expect(page.get_by_text(re.compile(f"^wheel.current_a {MINUS}4.00 … 4.00 A; "))).to_be_visible()


def test_the_spectrum_of_a_turning_shaft_has_its_speed(page: Page, studio: Studio) -> None:
    studio.daemon.must("enable")
    page.locator("#tab-plots").click()
    page.get_by_role("group", name="wheel").get_by_label("angle_deg", exact=True).check()
    page.get_by_role("button", name="Spectrum (FFT)").click()
    page.get_by_role("combobox", name="ticks", exact=True).select_option("4096")
    row = page.locator(".peaks tr", has_text="angle_deg")
    for left in reversed(range(4)):
        begin_s = time.monotonic()
        with studio.daemon.drive("set", "wheel", "velocity", 300, "--for", "60s"):
            try:
                # 300 rpm are five turns a second.
                expect(row).to_contain_text(re.compile(r"(4\.[89]|5\.[012])\d Hz"))
            except AssertionError:
                # No four seconds went by in which each tick ran and the target did not lapse.
                if left == 0 or not stood_still_since(begin_s, "a turning shaft"):
                    raise
            else:
                return


def test_the_choice_is_remembered_and_taken_back(page: Page) -> None:
    page.locator("#tab-plots").click()
    button = page.get_by_role("button", name=XY)
    button.click()
    page.reload()
    expect(button).to_have_attribute("aria-pressed", "true")
    button.click()
    expect(page.locator(".side-chart")).to_have_count(0)
