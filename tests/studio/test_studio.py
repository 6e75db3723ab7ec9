"""Each part of the page, by clicking."""

from __future__ import annotations

import contextlib
import functools
import hashlib
import re
import signal
import time
from pathlib import Path

import pytest
from good_computer import as_on_a_good_computer
from hostlib.daemon import REPO
from hostlib.program import PATIENCE_S, eventually
from hostlib.stalls import stood_still_since
from playwright.sync_api import Browser, Locator, Page, expect

import rc10
from conftest import PATIENCE_MS, Studio

REMEDY = REPO / "web" / "src" / "remedy.tsx"
TABS = (
    "overview",
    "match",
    "plots",
    "commission",
    "move",
    "tune",
    "events",
    "blackbox",
    "timing",
    "configuration",
)


def open_tab(page: Page, name: str) -> None:
    page.locator(f"#tab-{name}").click()
    expect(page.locator(f"#tab-{name}")).to_have_attribute("aria-selected", "true")


def test_a_motor_is_enabled_and_disabled_by_clicking(page: Page, studio: Studio) -> None:
    wheel = page.get_by_role("article", name="wheel", exact=True)
    expect(wheel.locator(".badge.status")).to_have_text("READY")
    wheel.get_by_role("button", name="Enable", exact=True).click()
    studio.daemon.wait_motor("wheel", lambda motor: motor["status"] == "ACTIVE", "enabled")
    expect(wheel.locator(".badge.status")).to_have_text("ACTIVE")
    wheel.get_by_role("button", name="Disable", exact=True).click()
    studio.daemon.wait_motor("wheel", lambda motor: motor["status"] == "READY", "disabled")
    expect(wheel.locator(".cause")).to_contain_text("request (web-1 127.0.0.1)")


def test_a_motor_that_holds_is_not_shown_as_one_without_torque(page: Page, studio: Studio) -> None:
    studio.daemon.must("enable")
    with studio.daemon.drive("set", "wheel", "velocity", 60, "--for", "60s"):
        wheel = page.get_by_role("article", name="wheel", exact=True)
        expect(wheel.locator(".badge.acting")).to_have_text("velocity")
        expect(wheel.get_by_text("60.0")).not_to_have_count(0)
        expect(wheel).to_have_class(re.compile("torque"))
        expect(wheel.get_by_text("by rc10ctl")).to_be_visible()


def test_stop_is_confirmed_by_the_robots_own_state_and_cleared_again(
    page: Page, studio: Studio
) -> None:
    told = page.locator(".stop-told")
    page.get_by_role("button", name="STOP").click()
    studio.daemon.wait_state(lambda state: state["state"] == "ESTOP", "it is stopped")
    expect(told).to_have_text("stopped: confirmed")
    expect(page.locator(".badge.robot")).to_have_text("ESTOP")
    page.get_by_role("button", name="Clear", exact=True).first.click()
    studio.daemon.wait_state(lambda state: state["state"] == "RUN", "it is cleared")
    expect(told).to_have_text("")


def test_the_key_escape_twice_stops_once_does_not(page: Page, studio: Studio) -> None:
    page.keyboard.press("Escape")
    # A request of the page after the key: by its answer an e-stop would have acted.
    page.get_by_role("article", name="wheel", exact=True).get_by_role(
        "button", name="Enable", exact=True
    ).click()
    studio.daemon.wait_motor("wheel", lambda motor: motor["status"] == "ACTIVE", "enabled")
    assert studio.daemon.state()["estop_count"] == 0

    def twice() -> bool:
        for _ in range(2):  # on a busy computer they may be too far apart
            page.keyboard.press("Escape")
        return bool(studio.daemon.state()["state"] == "ESTOP")

    eventually(twice, "it is stopped")


def test_a_stop_that_nobody_hears_is_not_confirmed(page: Page, studio: Studio) -> None:
    studio.web.stop()
    expect(page.locator(".badge.connection")).to_have_text("no connection to rc10-web")
    page.get_by_role("button", name="STOP").click()
    expect(page.locator(".stop-told")).to_have_text("NOT CONFIRMED: use the real emergency stop")
    # The server returns, and the page by itself.
    studio.start(studio.port)
    expect(page.locator(".badge.connection")).to_have_text("live")
    expect(page.get_by_role("article", name="wheel", exact=True)).to_be_visible()


def is_next_columns(payload: str | bytes) -> bool:
    """Values of at least one signal: src/web/columns_frame.hpp."""
    return isinstance(payload, bytes) and payload[1] == 1 and payload[2] > 0


def test_when_rc10d_ends_the_page_says_why_and_it_comes_back_by_itself(
    page: Page, studio: Studio
) -> None:
    with page.expect_websocket() as connection:
        page.reload()
    open_tab(page, "plots")
    expect(page.locator(".legend tr")).to_have_count(2)
    studio.daemon.kill()
    expect(page.get_by_role("alert")).to_contain_text("rc10d is not running")
    # Its curves go on.
    with connection.value.expect_event("framereceived", is_next_columns):
        studio.daemon.start()
        studio.daemon.wait_ready()
    expect(page.get_by_role("alert")).to_have_count(0)
    expect(page.locator(".legend tr")).to_have_count(2)
    # Events of its second life arrive too; those of the start may come before rc10-web is back.
    open_tab(page, "events")
    studio.daemon.must("enable", "wheel")
    expect(page.locator(".events tr", has_text="wheel").first).to_be_visible()


def test_while_rc10d_is_down_the_page_has_its_log_and_the_mistakes_of_its_file(
    page: Page, studio: Studio
) -> None:
    studio.daemon.kill()
    notice = page.get_by_role("region", name="rc10d is not running")
    expect(notice.get_by_label("End of its log")).to_contain_text("robot 'host' runs")
    expect(notice.get_by_text("It refused to start")).to_have_count(0)
    sound = studio.daemon.config.read_text()
    studio.daemon.config.write_text(sound.replace("model: M3508", "model: M3509"))
    studio.daemon.start()
    assert studio.daemon.program.wait() == 2
    mistakes = notice.get_by_label("It refused to start")
    expect(mistakes).to_contain_text("M3509")
    expect(mistakes).to_contain_text("did you mean")
    # The log is folded away then, and opens.
    expect(notice.get_by_label("End of its log")).to_be_hidden()
    notice.get_by_text("End of its log").click()
    expect(notice.get_by_label("End of its log")).to_be_visible()
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    studio.daemon.config.write_text(sound)
    studio.daemon.start()
    studio.daemon.wait_ready()
    expect(notice).to_have_count(0)


def columns_of(page: Page) -> int:
    """Non-empty points of the first curve, as the page would save them."""
    with page.expect_download() as saved:
        page.get_by_role("button", name="CSV").click()
    lines = Path(saved.value.path()).read_text().splitlines()
    return sum(1 for line in lines[1:] if line.split(",")[1] != "")


def runs_on(studio: Studio, ticks: int) -> None:
    before = studio.daemon.state()["tick"]
    studio.daemon.wait_state(lambda state: state["tick"] > before + ticks, "it runs on")


def test_curves_have_every_tick_and_are_frozen_measured_and_saved(
    page: Page, studio: Studio
) -> None:
    begin_s = time.monotonic()
    studio.daemon.must("enable")
    open_tab(page, "plots")
    page.get_by_label("span").select_option("2")
    page.get_by_role("group", name="yaw").get_by_label("angle_deg", exact=True).check()
    expect(page.locator(".legend tr")).to_have_count(3)
    with studio.daemon.drive("set", "wheel", "velocity", 90, "--for", "60s"):
        expect(page.locator(".legend tr").first).to_contain_text(re.compile(r"9\d\.\d\d rpm"))
    with page.expect_download() as saved:
        page.get_by_role("button", name="CSV").click()
    lines = Path(saved.value.path()).read_text().splitlines()
    assert lines[0].startswith("time_s,wheel.velocity_rpm.min,wheel.velocity_rpm.max,")
    assert len(lines) > 50
    chart = page.locator(".chart .u-over")
    box = chart.bounding_box()
    assert box is not None
    page.get_by_role("button", name="Freeze").click()
    frozen = page.locator(".legend tr").first.inner_text()
    # Two clicks: values at both, and the difference.
    for share in (0.75, 0.95):
        page.mouse.click(box["x"] + share * box["width"], box["y"] + 40)
    expect(page.locator(".legend tr").first).to_contain_text("Δ")
    expect(page.get_by_text("Δt")).to_be_visible()
    assert frozen.split()[0] in page.locator(".legend tr").first.inner_text()
    # A part of the picture, with the narrow columns that the server still has.
    for _ in range(5):
        page.mouse.move(box["x"] + 0.8 * box["width"], box["y"] + 60)
        page.mouse.down()
        page.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 60, steps=4)
        page.mouse.up()
        page.wait_for_function(
            "document.querySelector('.plot button[aria-pressed=\"true\"]') !== null"
        )
        columns = columns_of(page)
        if columns > 50 or not stood_still_since(begin_s, "a part of a picture"):
            break
        # Ticks that nobody ran are in no picture: another one, all of whose ticks come now.
        begin_s = time.monotonic()
        page.get_by_role("button", name="Go on").click()
        runs_on(studio, 2500)
        page.get_by_role("button", name="Freeze").click()
    assert columns > 50
    page.get_by_role("button", name="Go on").click()
    page.get_by_role("button", name="Keep behind").click()
    expect(page.get_by_role("button", name="Forget kept")).to_be_visible()


def test_a_picture_that_was_waiting_draws_nothing_into_the_chart_of_other_signals(
    page: Page,
) -> None:
    # Pictures come so late that the answer for the next signals is there before.
    # Its cancelling goes with it: a timer's number would cancel a picture of Playwright's.
    page.evaluate(
        """() => {
            window.requestAnimationFrame = (f) => setTimeout(f, 400);
            window.cancelAnimationFrame = clearTimeout;
        }"""
    )
    open_tab(page, "plots")
    wheel = page.get_by_role("group", name="wheel", exact=True)
    for count, name in enumerate(("torque_nm", "voltage_v", "temperature_c"), start=3):
        wheel.get_by_label(name, exact=True).check()
        expect(page.locator(".legend tr")).to_have_count(count)
    # The fixture looks for errors of the page.
    expect(page.locator(".legend tr").last).to_contain_text(re.compile(r"\d °C"))


def test_events_are_told_in_words_and_can_be_sifted(page: Page, studio: Studio) -> None:
    open_tab(page, "events")
    studio.daemon.must("enable", "wheel")
    expect(page.locator(".events tr", has_text="wheel").first).to_contain_text("ACTIVE")
    studio.daemon.must("estop")
    page.get_by_role("button", name="warnings and errors").click()
    expect(page.locator(".events tr.info")).to_have_count(0)


def test_timing_shows_the_latencies_that_rc10d_measures(page: Page) -> None:
    open_tab(page, "timing")
    expect(page.get_by_role("rowheader", name="Wake-up latency")).to_be_visible()
    expect(page.get_by_role("rowheader", name="Tick duration")).to_be_visible()


def row_of(page: Page, name: str) -> Locator:
    return page.locator(".checks tr", has=page.get_by_role("rowheader", name=name, exact=True))


def test_before_a_match_each_row_says_what_is_wrong_and_its_remedy(
    page: Page, studio: Studio
) -> None:
    open_tab(page, "match")
    verdict = page.locator(".verdict")
    expect(verdict).to_have_class(re.compile("bad"))
    expect(row_of(page, "Real drives")).to_have_class("bad")
    expect(row_of(page, "Real drives").locator(".remedy")).to_contain_text("type: sim")
    expect(row_of(page, "Every motor heard")).to_have_class("good")
    expect(row_of(page, "Every angle referenced")).to_have_class("good")
    # Each row with something wrong has a remedy, and no other has. Rows of ages and ticks may still
    # turn good, so that both are asked at the same moment.
    expect(page.locator(".checks tr.bad:not(:has(.remedy))")).to_have_count(0)
    expect(page.locator(".checks tr.good .remedy")).to_have_count(0)
    notes = row_of(page, "Real time in order").locator(".notes p")

    def notes_are_those_of_rc10d() -> bool:
        """Those of one moment: some are measured, and change."""
        told = studio.daemon.stats()["notices"]
        shown = [" ".join(text.split()) for text in notes.all_text_contents()]
        return shown == [" ".join(note.replace("`", "").split()) for note in told]

    eventually(notes_are_those_of_rc10d, "the page has the notices of rc10d")
    # A hash that is another's, then that of the file that runs.
    page.get_by_label("SHA-256").fill("0123456789abcdef")
    expect(row_of(page, "File as committed")).to_have_class("bad")
    running = hashlib.sha256(studio.daemon.config.read_bytes()).hexdigest()
    page.get_by_label("SHA-256").fill(running.upper())
    expect(row_of(page, "File as committed")).to_have_class("good")
    page.get_by_label("SHA-256").fill(running[:4])
    expect(row_of(page, "File as committed")).to_have_class("bad")
    page.get_by_label("SHA-256").fill(running[:12])
    expect(row_of(page, "File as committed")).to_have_class("good")
    # Another file, in which the wheels are not referenced where they are.
    studio.daemon.kill()
    changed = studio.daemon.config.read_text().replace(", zero: power_on", "")
    studio.daemon.config.write_text(changed)
    studio.daemon.start()
    studio.daemon.wait_ready()
    expect(row_of(page, "File as committed")).to_have_class("bad")
    unreferenced = row_of(page, "Every angle referenced")
    expect(unreferenced.locator(".found")).to_have_text("wheel, other")
    expect(unreferenced.locator(".remedy")).to_contain_text("rc10ctl zero")


def test_before_a_match_the_page_is_green_only_when_every_row_is(
    page: Page, studio: Studio
) -> None:
    as_on_a_good_computer(page)
    open_tab(page, "match")
    verdict = page.locator(".verdict")
    expect(row_of(page, "E-stop tried since rc10d runs")).to_have_class("bad")
    studio.daemon.must("estop")
    expect(row_of(page, "Robot may move")).to_have_class("bad")
    expect(row_of(page, "Robot may move").locator(".found")).to_contain_text("ESTOP")
    studio.daemon.must("clear")
    expect(row_of(page, "Robot may move")).to_have_class("good")
    expect(row_of(page, "E-stop tried since rc10d runs")).to_have_class("good")
    page.get_by_role("button", name="Remember the one that runs").click()
    page.get_by_role("button", name="Count from here").click()
    expect(verdict).to_have_text("✓ Ready for a match")
    expect(verdict).to_have_class(re.compile("good"))
    # The simulated winding has the warmth of a room, which is hot for whoever says so.
    page.get_by_label("Hot above").fill("20")
    expect(row_of(page, "Motors cool")).to_have_class("bad")
    expect(verdict).to_have_text("✗ Not ready (1)")
    page.get_by_label("Hot above").fill("60")
    expect(verdict).to_have_class(re.compile("good"))
    # The hash is remembered; without rc10d nothing is green.
    page.reload()
    expect(row_of(page, "File as committed")).to_have_class("good")
    studio.daemon.kill()
    expect(verdict).to_have_text("✗ Nothing is known of the robot")


def test_a_browser_without_room_for_settings_ends_no_action(page: Page) -> None:
    page.evaluate(
        """() => {
            for (let size = 1 << 22; size >= 1; size /= 2)
                for (let i = 0; i < 9; ++i)
                    try { localStorage.setItem(`${size} ${i}`, 'x'.repeat(size)); } catch { break; }
            for (let i = 0; ; ++i) try { localStorage.setItem(`${i}`, ''); } catch { break; }
        }"""
    )
    open_tab(page, "plots")
    page.get_by_role("button", name="中文").click()
    expect(page.locator("#tab-events")).to_have_text("事件")


def test_signals_of_another_robot_take_no_room_among_those_of_this_one(page: Page) -> None:
    page.evaluate(
        "localStorage.setItem('rc10.signals', JSON.stringify("
        "['yaw.velocity_rpm', ...Array.from({length: 12}, (_, i) => `gone${i}.current_a`)]))"
    )
    page.reload()
    open_tab(page, "plots")
    expect(page.locator(".chooser summary")).to_have_text("Signals (1)")
    expect(page.locator(".legend tr")).to_have_count(1)


def test_language_favourites_and_part_are_remembered(page: Page) -> None:
    page.get_by_role("button", name="favourite yaw").click()
    expect(page.locator(".card.motor h3").first).to_have_text("yaw")
    page.get_by_role("button", name="中文").click()
    expect(page.locator("#tab-events")).to_have_text("事件")
    open_tab(page, "events")
    page.reload()
    expect(page.locator("#tab-events")).to_have_attribute("aria-selected", "true")
    expect(page.locator("#tab-events")).to_have_text("事件")
    assert page.evaluate("document.documentElement.lang") == "zh"
    open_tab(page, "overview")
    expect(page.locator(".card.motor h3").first).to_have_text("yaw")


def test_the_layout_is_remembered_for_each_robot_by_its_name(page: Page, studio: Studio) -> None:
    wheel = page.get_by_role("article", name="wheel", exact=True)
    buses = page.get_by_role("button", name="Buses")
    page.get_by_role("button", name="favourite yaw").click()
    page.get_by_role("button", name="Compact").click()
    buses.click()
    expect(wheel.get_by_text("temperature")).to_have_count(0)
    expect(page.locator(".card.bus")).to_have_count(0)
    page.reload()
    expect(page.locator(".card.motor h3").first).to_have_text("yaw")
    expect(wheel.get_by_text("temperature")).to_have_count(0)
    expect(page.locator(".card.bus")).to_have_count(0)
    # Another robot has its own, and the first one's is still there.
    own = studio.daemon.config.read_text()
    for name, folded in (("guest", False), ("host", True)):
        studio.daemon.program.stop()
        studio.daemon.config.write_text(own.replace("robot: host", f"robot: {name}"))
        studio.daemon.start()
        expect(page.locator(".top h1")).to_have_text(name)
        expect(buses).to_have_attribute("aria-expanded", "false" if folded else "true")
        expect(page.locator(".card.motor h3").first).to_have_text("yaw" if folded else "wheel")


def test_an_event_leads_to_its_remedy_on_a_page_of_the_robot(page: Page, studio: Studio) -> None:
    open_tab(page, "events")
    studio.daemon.must("enable", "wheel")
    # In the motor's status nothing is to be mended.
    row = page.locator(".events tr", has_text="ACTIVE").first
    expect(row).to_be_visible()
    expect(row.get_by_role("link")).to_have_count(0)
    with studio.daemon.drive("set", "wheel", "velocity", 60, "--for", "60s") as drive:
        studio.daemon.wait_motor("wheel", lambda motor: motor["owner"] == "rc10ctl", "driven")
        drive.signal(signal.SIGKILL)
    stopped = page.locator(".events tr", has_text="no valid command any more").first
    with page.context.expect_page() as opened:
        stopped.get_by_role("link", name="What to do").click()
    docs = opened.value
    expect(docs.locator("tr:target")).to_contain_text("the program sends too seldom")
    assert docs.url.startswith(f"{studio.url}docs/troubleshooting.html#row-")
    place = docs.url.split("#")[1]
    # In Chinese the same place.
    page.get_by_role("button", name="中文").click()
    link = stopped.get_by_role("link", name="怎么办")
    assert link.get_attribute("href") == f"/docs/troubleshooting.zh.html#{place}"
    docs.goto(f"{studio.url}docs/troubleshooting.zh.html#{place}")
    expect(docs.locator("tr:target")).to_contain_text("no valid command any more")
    docs.close()


def test_every_event_that_is_no_mere_news_has_a_remedy() -> None:
    table = (REPO / "docs" / "lcm.md").read_text().split("## event_t")[1].split("\n## ")[0]
    rows = re.findall(r"^\| (\d+) \| .* \| (.+) \| .* \|$", table, re.MULTILINE)
    assert len(rows) > 20
    # A motor's status has its remedies by its words.
    wanted = {code for code, severity in rows if re.search("warning|error", severity)} - {"100"}
    assert wanted - set(re.findall(r"^  (\d+): '", REMEDY.read_text(), re.MULTILINE)) == set()


@pytest.mark.parametrize("width", [390, 1280])
@pytest.mark.parametrize("name", ["troubleshooting.html", "troubleshooting.zh.html"])
def test_the_page_of_remedies_has_each_section_and_can_be_read(
    chromium: Browser, studio: Studio, name: str, width: int
) -> None:
    context = chromium.new_context(viewport={"width": width, "height": 844})
    page = context.new_page()
    problems: list[str] = []
    page.on("console", lambda message: problems.append(message.text))
    page.goto(f"{studio.url}docs/{name}")
    sections = re.findall(r"^  \d+: '([a-z0-9-]+)',$", REMEDY.read_text(), re.MULTILINE)
    assert len(sections) > 10
    for section in {*sections, "a-motor-is-offline", "fault"}:
        expect(page.locator(f"h2#{section}")).to_have_count(1)
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.evaluate((REPO / "web" / "node_modules" / "axe-core" / "axe.min.js").read_text())
    found = page.evaluate("axe.run().then((result) => result.violations)")
    assert [one["id"] for one in found if one["impact"] in ("serious", "critical")] == []
    assert problems == []
    context.close()


def test_each_action_has_the_command_and_the_python_line_that_do_the_same(
    page: Page, studio: Studio
) -> None:
    wheel = page.get_by_role("article", name="wheel", exact=True)
    command, python = wheel.locator(".actions .copy").all()
    line = (command.get_attribute("title") or "").removeprefix("copy as a command: ")
    assert line == "rc10ctl enable wheel"
    studio.daemon.must(*line.split()[1:])
    expect(wheel.locator(".badge.status")).to_have_text("ACTIVE")
    line = (python.get_attribute("title") or "").removeprefix("copy as Python: ")
    assert line == 'robot.disable("wheel")'
    with rc10.connect("host") as robot:
        for left in reversed(range(5)):
            begin_s = time.monotonic()
            try:
                exec(line, {"robot": robot})  # as a person would paste it
                break
            except rc10.Timeout:
                if left == 0 or not stood_still_since(begin_s, line):
                    raise
    expect(wheel.locator(".badge.status")).to_have_text("READY")


def hears_diagnostics(robot: rc10.Robot) -> bool:
    robot.spin(0.1)
    with contextlib.suppress(rc10.NotReceived):
        return bool(robot.diagnostics.buses)
    return False


def test_each_value_has_the_lines_that_show_it(
    page: Page, studio: Studio, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, shown in (("wheel", "wheel"), ("chassis", "chassis")):
        card = page.get_by_role("article", name=name, exact=True)
        command, python = card.locator("footer .copy").all()[:2]
        line = (command.get_attribute("title") or "").removeprefix("copy as a command: ")
        assert shown in studio.daemon.must(*line.split()[1:])
        line = (python.get_attribute("title") or "").removeprefix("copy as Python: ")
        with rc10.connect("host") as robot:
            robot.wait_for_state(PATIENCE_S)
            eventually(functools.partial(hears_diagnostics, robot), "diagnostics came")
            exec(line, {"robot": robot})  # as a person would paste it
        assert shown in capsys.readouterr().out


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize(("width", "height"), [(390, 844), (1280, 860)])
@pytest.mark.parametrize("language", ["en-GB", "zh-CN"])
def test_nothing_overlaps_or_sticks_out_and_all_can_use_it(
    chromium: Browser, studio: Studio, language: str, width: int, height: int, scheme: str
) -> None:
    context = chromium.new_context(
        viewport={"width": width, "height": height},
        locale=language,
        color_scheme="dark" if scheme == "dark" else "light",
    )
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.goto(studio.url)
    page.get_by_role("article", name="wheel", exact=True).wait_for()
    axe = (REPO / "web" / "node_modules" / "axe-core" / "axe.min.js").read_text()
    page.evaluate(axe)
    for tab in TABS:
        open_tab(page, tab)
        if tab == "configuration":
            page.locator(".cm-line").first.wait_for()
            page.locator(".bus-plan").first.wait_for()
        # Drawn twice, with what the tab has asked for.
        page.evaluate("new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)))")
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), tab
        found = page.evaluate("axe.run().then((result) => result.violations)")
        serious = [
            (one["id"], [node["html"] for node in one["nodes"]][:3])
            for one in found
            if one["impact"] in ("serious", "critical")
        ]
        assert serious == [], tab
    context.close()
