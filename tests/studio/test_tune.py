"""Tests of motion and tuning on the page: within bounds, ended by name, gains before and after."""

from __future__ import annotations

import json
import os
import re
import signal
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon
from hostlib.daemon import ARM
from hostlib.program import eventually
from hostlib.stalls import stood_still_since
from motion_tests import ended, measures, rests, runs_to, start, sweep, sweep_ends, tune
from playwright.sync_api import Browser, Locator, Page, Playwright, expect

from conftest import CHROMIUM, PATIENCE_MS, QUIET, Studio

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

# As docs/tuning.md has it; its feedback may be as old as a busy machine makes it.
WHEEL = (
    ARM
    + """
      - {name: wheel, model: M3508, id: 1, zero: power_on, feedback_timeout_ms: 1000,
         current_limit_a: 10, simulated: {inertia_kg_m2: 0.01}}
      - {name: other, model: M3508, id: 2, zero: power_on, feedback_timeout_ms: 1000}
"""
)


@pytest.fixture
def robot() -> str:
    return WHEEL


@pytest.fixture
def form(page: Page, studio: Studio) -> Locator:
    found = tune(page)
    studio.daemon.must("enable", "wheel")
    expect(page.locator(".badge.status")).to_have_text("ACTIVE")
    return found


def test_a_step_has_its_numbers_beside_its_curve_and_its_csv(page: Page, form: Locator) -> None:
    runs_to(form, "Done")
    ended(form, "wheel coasts")
    results = page.get_by_role("region", name="Tests", exact=True)
    expect(results.locator("canvas")).to_be_visible()
    for name in ("rise time", "overshoot", "settling time", "following error, rms"):
        expect(results.get_by_role("row", name=name)).to_be_visible()
    expect(results.get_by_role("row", name="limits that acted")).to_contain_text("current")
    with page.expect_download() as download:
        results.get_by_role("button", name="CSV").click()
    heading, *rows = download.value.path().read_text().splitlines()
    assert heading.startswith("time_s,target,target_shaped,measured,")
    assert len(rows) > 1000
    assert float(rows[-1].split(",")[1]) == 60.0


def test_a_multisine_has_a_bode_plot_with_coherence(page: Page, form: Locator) -> None:
    form.get_by_label("kind", exact=True).select_option("multisine")
    form.get_by_label("amplitude").fill("20")
    form.get_by_label("around").fill("60")
    form.get_by_label("from", exact=True).fill("4")
    form.get_by_label("lasts").fill("3")
    runs_to(form, "Done")
    results = page.get_by_role("region", name="Tests", exact=True)
    expect(results.get_by_role("img", name="Bode").locator("canvas")).to_have_count(3)
    expect(results.get_by_role("row", name="bandwidth")).to_contain_text("Hz")
    expect(results.get_by_role("row", name="phase margin")).to_contain_text("°")
    with page.expect_download() as download:
        results.get_by_role("button", name="Bode").click()
    assert download.value.path().read_text().startswith("frequency_hz,gain_db,phase_deg,coherence")


def test_a_ramp_and_an_angle_are_tests_too(page: Page, form: Locator) -> None:
    form.get_by_label("kind", exact=True).select_option("ramp")
    form.get_by_label("slope").fill("60")
    form.get_by_label("lasts").fill("2")
    runs = runs_to(form, "Done")
    form.get_by_label("kind", exact=True).select_option("step")
    form.get_by_label("mode", exact=True).select_option("total_angle")
    form.get_by_label("amplitude").fill("20")
    form.get_by_label("lowest angle").fill("-90")
    form.get_by_label("highest angle").fill("90")
    runs += runs_to(form, "Done")
    results = page.get_by_role("region", name="Tests", exact=True)
    # Beside the names of the rows.
    expect(results.get_by_role("columnheader")).to_have_count(1 + runs)


BOUNDS: dict[str, tuple[tuple[str, str], str]] = {
    "angle": (("highest angle", "20"), "the corridor (angle)"),
    "velocity": (("speed at most", "60.5"), "the speed (velocity)"),
    "current": (("current at most", "2"), "the current (current)"),
}


@pytest.mark.parametrize("bound", list(BOUNDS))
def test_each_bound_ends_it_by_its_name(form: Locator, studio: Studio, bound: str) -> None:
    (label, value), words = BOUNDS[bound]
    form.get_by_label(label).fill(value)
    runs_to(form, f"Ended by: {words}")
    ended(form, "wheel coasts")
    rests(studio)


def test_a_limit_of_the_motor_ends_it_if_that_is_wanted(form: Locator, studio: Studio) -> None:
    form.get_by_label("limit of the motor").check()
    runs_to(form, "Ended by: a limit of the motor (limit)")
    rests(studio)


def test_all_that_happens_to_the_motor_ends_it_by_its_name(
    page: Page, form: Locator, studio: Studio
) -> None:
    daemon = studio.daemon
    sweep_ends(
        form,
        studio,
        lambda: daemon.must("set", "wheel", "velocity", 30, "--for", "1s", "--priority", 1),
        "Ended by: another owner (ownership)",
    )
    sweep_ends(
        form,
        studio,
        lambda: daemon.must("disable", "wheel"),
        "Ended by: the state of the motor or the robot (status)",
        "`rc10ctl enable wheel`",
    )
    # And it does not begin so.
    start(form)
    ended(form, "(status)")
    page.get_by_role("button", name="Enable", exact=True).click()
    expect(page.locator(".badge.status")).to_have_text("ACTIVE")
    sweep_ends(form, studio, page.get_by_role("button", name="STOP").click, "(status)")


def test_feedback_that_grows_old_ends_it(form: Locator, studio: Studio) -> None:
    form.get_by_label("age of feedback at most").fill("500")

    def stand_still() -> None:
        studio.daemon.program.signal(signal.SIGSTOP)
        try:
            form.locator(".told").wait_for(timeout=3 * PATIENCE_MS)
        finally:
            studio.daemon.program.signal(signal.SIGCONT)

    sweep_ends(form, studio, stand_still, "Ended by: the age of feedback (feedback_age)")
    rests(studio)


def test_the_end_of_rc10d_ends_it(form: Locator, studio: Studio) -> None:
    def begin_anew() -> None:
        studio.daemon.kill()
        form.locator(".told").wait_for(timeout=3 * PATIENCE_MS)
        studio.daemon.start()
        studio.daemon.wait_ready()

    sweep_ends(form, studio, begin_anew, "Ended by: the connection to rc10d (connection)")


@pytest.mark.parametrize("way", ["button", "key", "part", "hidden"])
def test_it_ends_by_a_press_and_when_the_page_is_left(
    page: Page, form: Locator, studio: Studio, way: str
) -> None:
    def press() -> None:
        # A test that has ended by itself has no button any more.
        button = form.get_by_role("button", name="End the test")
        if button.is_visible():
            button.click()

    ends: dict[str, Callable[[], object]] = {
        "button": press,
        "key": lambda: page.keyboard.press("Escape"),
        "hidden": lambda: page.evaluate(
            "Object.defineProperty(document, 'hidden', {value: true, configurable: true});"
            "document.dispatchEvent(new Event('visibilitychange'));"
            "delete document.hidden"
        ),
    }
    if way == "part":
        sweep(form, studio)
        page.locator("#tab-events").click()
    else:
        sweep_ends(form, studio, ends[way], "(interrupted)")
    rests(studio)
    # An e-stop is two of that key.
    assert studio.daemon.state()["state"] == "RUN"


def test_a_page_that_stands_still_ends_it(page: Page, form: Locator, studio: Studio) -> None:
    sweep(form, studio)
    page.evaluate("{ const end = performance.now() + 2500; while (performance.now() < end); }")
    ended(form, "Ended by: silence of this page (silence)")
    rests(studio)


def test_a_connection_that_is_lost_ends_it(form: Locator, studio: Studio) -> None:
    def lose_it() -> None:
        port = studio.port
        studio.web.signal(signal.SIGKILL)
        studio.web.wait()
        rests(studio)
        form.locator(".told").wait_for(timeout=3 * PATIENCE_MS)
        studio.start(port)

    sweep_ends(form, studio, lose_it, "Ended by: the connection of this page")


def processes_with(mark: str) -> list[int]:
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if mark in process.joinpath("cmdline").read_text(errors="replace"):
                found.append(int(process.name))
        except OSError:
            continue  # ended
    return found


def frames_of_the_wheel(daemon: Daemon) -> list[tuple[int, int]]:
    """Time and current of each frame to it, from the bus."""
    found = []
    for line in daemon.must("blackbox", "--json").splitlines():
        record = json.loads(line)
        if record["kind"] == "frame" and record["direction"] == "sent":
            identifier, _, data = record["frame"].partition("#")
            if identifier == "200":
                current = int.from_bytes(bytes.fromhex(data[:4]), "big", signed=True)
                found.append((int(record["mono_us"]), current))
    return found


def test_a_browser_that_is_killed_in_a_sweep_leaves_rest_on_the_bus(
    playwright: Playwright, studio: Studio, tmp_path: Path
) -> None:
    mark = f"--rc10-test={tmp_path}"
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=[*QUIET, mark])
    page = browser.new_page(locale="en-GB")
    page.set_default_timeout(PATIENCE_MS)
    page.goto(studio.url)
    form = tune(page)
    studio.daemon.must("enable", "wheel")
    sweep(form, studio)
    last = studio.daemon.state()["mono_us"]
    for pid in processes_with(mark):
        os.kill(pid, signal.SIGKILL)
    rests(studio)
    after = studio.daemon.state()["mono_us"]
    frames = eventually(
        lambda: [f for f in [frames_of_the_wheel(studio.daemon)] if f[-1][0] > after],
        "frames after it",
    )[0]
    torque = [at_us for at_us, current in frames if current != 0]
    assert torque
    assert torque[-1] >= last - 1_000_000, "it turned until then"
    assert torque[-1] < after
    assert all(current == 0 for at_us, current in frames if at_us >= after)


def test_the_lines_do_the_same_in_a_terminal_and_in_python(form: Locator) -> None:
    form.get_by_label("kind", exact=True).select_option("ramp")
    form.get_by_label("slope").fill("30")
    command, python = (
        (copy.get_attribute("title") or "").partition(": ")[2]
        for copy in form.locator(".copy").all()
    )
    assert command == (
        "rc10ctl test-motion wheel ramp 60 --max-current 12 --rate 30 --max-speed 1000"
        " --max-feedback-age 2000ms --dead-man-ms 1000"
    )
    assert python == (
        'run_motion_test("wheel", "ramp", 60, rate_per_s=30, max_current_a=12,'
        " max_speed_rpm=1000, dead_man_ms=1000, max_feedback_age_s=2)"
    )


def test_without_its_bounds_no_test_begins(page: Page) -> None:
    page.locator("#tab-tune").click()
    form = page.get_by_role("region", name="Test of motion")
    begin = form.get_by_role("button", name="Start", exact=True)
    expect(begin).to_be_disabled()
    form.get_by_label("current at most").fill("2")
    expect(begin).to_be_enabled()
    form.get_by_label("mode", exact=True).select_option("current")
    expect(begin).to_be_disabled()
    form.get_by_label("mode", exact=True).select_option("velocity")
    # A target beyond its bounds is refused in words.
    form.get_by_label("speed at most").fill("30")
    begin.click()
    ended(form, "Not begun")
    ended(form, "beyond its limits")
    # One that no motor has is refused before it is looked at.
    form.get_by_label("amplitude").fill("1e12")
    begin.click()
    ended(form, "'amplitude' is not a number")


@pytest.mark.parametrize("way", ["key", "part"])
def test_a_measurement_that_is_left_between_its_pulses_gives_no_second_one(
    page: Page, form: Locator, way: str
) -> None:
    runs_to(form, "Done")
    # The curve of the first pulse comes after this.
    page.evaluate(
        """(way) => {
            const {get} = Object.getOwnPropertyDescriptor(MessageEvent.prototype, 'data');
            let left = false;
            Object.defineProperty(MessageEvent.prototype, 'data', {get() {
                const data = get.call(this);
                if (left || typeof data !== 'string' || !data.includes('"test_done"')) return data;
                left = true;
                if (way === 'part') document.querySelector('#tab-events').click();
                else dispatchEvent(new KeyboardEvent('keydown', {key: 'Escape'}));
                return data;
            }});
            const {send} = WebSocket.prototype;
            window.begun = 0;
            let told;
            window.released = new Promise((done) => { told = done; });
            WebSocket.prototype.send = function (text) {
                const message = JSON.parse(text);
                if (message.type === 'test') ++begun;
                if (message.type === 'drive' && !message.held) told();
                return send.call(this, text);
            };
        }""",
        way,
    )
    proposal = page.get_by_role("region", name="Proposal")
    proposal.get_by_label("speed at most").fill("500")
    proposal.get_by_role("button", name="Measure").click()
    # The pulse that would follow is begun at once.
    page.evaluate("released.then(() => new Promise((done) => setTimeout(done)))")
    assert page.evaluate("begun") == 1


def test_a_measurement_proposes_gains_that_are_judged_by_the_same_step(
    page: Page, form: Locator, studio: Studio
) -> None:
    runs_to(form, "Done")
    proposal = page.get_by_role("region", name="Proposal")
    expect(proposal.get_by_role("button", name="Measure")).to_be_disabled()
    proposal.get_by_label("speed at most").fill("500")
    expect(measures(proposal)).to_contain_text("velocity_pid.kp_a_per_rpm")
    gains = page.locator(".gains")
    field = gains.get_by_label("velocity_pid.kp_a_per_rpm", exact=True)
    kp = float(field.input_value())
    # docs/tuning.md: 172 rpm/s for each ampere; a machine that pauses measures it less well.
    assert 0.5 * 0.39 < kp < 2.0 * 0.39
    before = json.loads(studio.daemon.must("gains", "wheel", "--json"))["gains"]
    assert before["velocity_pid.kp_a_per_rpm"] != kp, "nothing is applied by itself"
    gains.get_by_role("button", name="Apply").click()
    expect(gains.get_by_role("button", name="Undo (1)")).to_be_enabled()
    runs_to(form, "Done")
    results = page.get_by_role("region", name="Tests", exact=True)
    row = results.get_by_role("row", name="velocity_pid.kp_a_per_rpm")
    expect(row).to_contain_text(str(before["velocity_pid.kp_a_per_rpm"]))
    expect(row).to_contain_text(str(kp))
    gains.get_by_text("Lines for the robot").click()
    expect(gains.locator("pre")).to_contain_text("velocity_pid")
    # The history outlives the page; a step of it goes back to what was before.
    page.reload()
    page.locator("#tab-tune").click()
    gains.get_by_text("History").click()
    expect(gains.locator(".history li")).to_have_count(1)
    gains.get_by_role("button", name="As before").click()
    expect(field).to_have_value(f"{before['velocity_pid.kp_a_per_rpm']:g}")


def test_while_tuning_is_locked_gains_are_refused_with_the_line(chromium: Browser) -> None:
    with Daemon(WHEEL.replace("realtime:", "tuning: locked\nrealtime:")) as daemon:
        daemon.wait_ready()
        studio = Studio(daemon)
        context = chromium.new_context(locale="en-GB")
        context.set_default_timeout(PATIENCE_MS)
        page = context.new_page()
        page.goto(studio.url)
        form = tune(page)
        daemon.must("enable", "wheel")
        # A test is a command, which changes no gain.
        runs_to(form, "Done")
        gains = page.locator(".gains")
        gains.get_by_label("velocity_pid.kp_a_per_rpm", exact=True).fill("0.25")
        gains.get_by_role("button", name="Apply").click()
        expect(gains.get_by_role("alert")).to_contain_text("`tuning: locked` at")
        context.close()
        studio.web.stop()


@pytest.fixture
def phone(chromium: Browser, studio: Studio) -> Iterator[Page]:
    context = chromium.new_context(
        viewport={"width": 390, "height": 844}, locale="zh-CN", has_touch=True
    )
    context.set_default_timeout(PATIENCE_MS)
    opened = context.new_page()
    opened.goto(studio.url)
    yield opened
    context.close()


def test_a_test_is_run_on_a_phone_in_chinese(phone: Page, studio: Studio) -> None:
    phone.locator("#tab-tune").click()
    form = phone.get_by_role("region", name="运动测试")
    form.get_by_label("最大电流").fill("12")
    form.get_by_label("最大转速").fill("1000")
    form.get_by_label("反馈的最大年龄").fill("2000")
    form.get_by_label("本页最长的沉默").fill("1000")
    studio.daemon.must("enable", "wheel")
    runs_to(form, "完成", lambda form: form.get_by_role("button", name="开始", exact=True).tap())
    assert phone.evaluate("document.documentElement.scrollWidth <= innerWidth")


def gains_in_force(studio: Studio) -> dict[str, float]:
    found: dict[str, float] = json.loads(studio.daemon.must("gains", "wheel", "--json"))["gains"]
    return found


def test_a_search_judges_gains_by_the_step_and_leaves_those_in_force(
    page: Page, form: Locator, studio: Studio
) -> None:
    before = gains_in_force(studio)
    proposal = page.get_by_role("region", name="Proposal")
    search = proposal.get_by_role("button", name="Search", exact=True)
    form.get_by_label("kind", exact=True).select_option("ramp")
    expect(search).to_be_disabled()
    form.get_by_label("kind", exact=True).select_option("step")
    proposal.get_by_label("tries", exact=True).fill("3")
    told = proposal.locator("p", has_text=re.compile(r"\d s( →|;)"))
    for _ in range(5):  # again, if the machine stood still meanwhile
        begin_s = time.monotonic()
        search.click()
        expect(search).to_be_disabled()
        expect(search).to_be_enabled(timeout=9 * PATIENCE_MS)
        if told.count() > 0 or not stood_still_since(begin_s, "a search"):
            break
    # Either way it says by how much.
    expect(told).to_contain_text(re.compile(r"[\d.]+ s → [\d.]+ s: velocity_pid|None was better"))
    assert gains_in_force(studio) == before
    # The step as it was lies beside those that follow.
    results = page.get_by_role("region", name="Tests", exact=True)
    expect(results.get_by_role("columnheader", name="wheel step")).not_to_have_count(0)
    if "velocity_pid" in told.inner_text():
        expect(page.locator(".gains").get_by_role("button", name="Apply")).to_be_enabled()


@pytest.mark.usefixtures("form")
def test_escape_between_two_tests_of_a_search_begins_no_other_one(
    page: Page, studio: Studio
) -> None:
    before = gains_in_force(studio)
    page.evaluate(
        """() => {
          const send = WebSocket.prototype.send;
          window.tests = 0;
          WebSocket.prototype.send = function (data) {
            send.call(this, data);
            const message = typeof data === "string" ? JSON.parse(data) : {};
            if (message.type === "test") window.tests += 1;
            // Twice in a row it would be an e-stop.
            if (message.operation === "set_gains" && "restore_at_end" in message.values)
              window.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }));
          };
        }"""
    )
    proposal = page.get_by_role("region", name="Proposal")
    proposal.get_by_role("button", name="Search", exact=True).click()
    # The first step is as it was; Escape comes while other gains are set for the second one.
    expect(proposal.get_by_role("alert")).to_have_text(
        "The search has ended early; the gains of before are in force.", timeout=9 * PATIENCE_MS
    )
    assert page.evaluate("window.tests") == 1
    assert gains_in_force(studio) == before
    rests(studio)


@pytest.fixture
def before_the_search(page: Page, form: Locator, studio: Studio) -> dict[str, float]:
    """Gains of before a search whose second step, a long one with other gains, goes on."""
    before = gains_in_force(studio)
    form.get_by_label("lasts").fill("5")
    proposal = page.get_by_role("region", name="Proposal")
    early = proposal.get_by_role("alert").filter(has_text="ended early")

    def has_other_gains() -> bool:
        return gains_in_force(studio) != before

    for _ in range(5):  # again, if the machine stood still in the first step, which is as it was
        begin_s = time.monotonic()
        proposal.get_by_role("button", name="Search", exact=True).click()
        expect(early).to_have_count(0)
        eventually(
            lambda: has_other_gains() or early.count() > 0, "other gains", 3 * PATIENCE_MS / 1000
        )
        if has_other_gains() or not stood_still_since(begin_s, "a search"):
            break
    assert has_other_gains()
    return before


def test_a_page_that_is_closed_in_a_search_leaves_the_gains_of_before(
    page: Page, studio: Studio, before_the_search: dict[str, float]
) -> None:
    before = before_the_search
    page.close()
    eventually(lambda: gains_in_force(studio) == before, "the gains of before")
    rests(studio)


def test_escape_ends_a_search_and_puts_the_gains_back(
    page: Page, studio: Studio, before_the_search: dict[str, float]
) -> None:
    page.keyboard.press("Escape")
    expect(page.get_by_role("region", name="Proposal").get_by_role("alert")).to_have_text(
        "The search has ended early; the gains of before are in force."
    )
    assert gains_in_force(studio) == before_the_search
    rests(studio)
