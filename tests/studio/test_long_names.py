"""A robot of every family, with names as long as a file may have them."""

from __future__ import annotations

import pytest
from playwright.sync_api import Browser, expect
from test_studio import TABS, open_tab

from conftest import PATIENCE_MS, Studio

LONGEST = 31


def named(word: str) -> str:
    return (word + "_" + "with_a_name_that_is_long_enough")[:LONGEST]


WHEELS = "".join(
    f"      - {{name: {named(f'wheel_{i}')}, model: M3508, id: {i}, feedback_hz: 500}}\n"
    for i in range(1, 5)
)
OTHERS = "".join(
    f"      - {{name: {named(name)}, model: {rest}, command_divider: 10}}\n"
    for name, rest in (
        ("shooter", "VESC, id: 10, pole_pairs: 7, velocity_limit_rpm: 3000"),
        ("arm", "DM4310, id: 15, master_id: 31"),
        ("lift", "RS00, id: 20"),
        ("knee", "AK80-9, id: 21"),
        (
            "belt",
            (
                "ODrive_S1, id: 3, torque_constant_nm_per_a: 0.0551, current_limit_a: 20,"
                " velocity_limit_rpm: 600, feedback_hz: 100"
            ),
        ),
        ("turntable", "RMD-X8-20, id: 22"),
        ("pan", "LK-MG5010E-i10, id: 5"),
    )
)
ROBOT = f"""
robot: {named("robot")}
realtime: preferred
buses:
  - name: {named("chassis")}
    type: sim
    motors:
{WHEELS}
  - name: {named("classic")}
    type: sim
    motors:
{OTHERS}
  - name: {named("fd")}
    type: sim
    data_bitrate: 5000000
    motors:
      - {{name: {named("leg")}, model: moteus, id: 1, motor_kv_rpm_per_v: 100, command_divider: 2}}
"""


@pytest.fixture
def robot() -> str:
    return ROBOT


@pytest.mark.parametrize(("width", "height"), [(390, 844), (1280, 860)])
def test_long_names_fit_every_part_and_stay_lines(
    chromium: Browser, studio: Studio, width: int, height: int
) -> None:
    context = chromium.new_context(viewport={"width": width, "height": height}, locale="en-GB")
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.goto(studio.url)
    expect(page.locator(".card.motor")).to_have_count(12)
    heights = page.locator(".card.motor h3").evaluate_all(
        "titles => titles.map((title) => title.getBoundingClientRect().height)"
    )
    assert max(heights) <= 50, "a name has two lines at most"
    for tab in TABS:
        open_tab(page, tab)
        if tab in ("plots", "move", "tune"):
            page.locator(".legend tr").first.wait_for()
        if tab == "configuration":
            page.locator(".bus-plan").first.wait_for()
        page.evaluate("new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))")
        assert page.evaluate("[document.documentElement.scrollWidth - innerWidth]")[0] <= 0, tab
    context.close()
