"""From an empty file to two tuned motors of a simulated robot, by clicks and typed fields alone."""

from __future__ import annotations

import hashlib
import json
import re
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from commissioning import (
    NOT_JUDGED,
    both_ends,
    held,
    knows_the_angle,
    knows_the_turn,
    rests,
    stands,
    told,
    turned_by_hand,
    turning,
    zero_again,
)
from hostlib import Daemon
from hostlib.daemon import motor_of
from hostlib.file_helper import FileHelper, FileRequest
from motion_tests import ended, measures, runs_to
from playwright.sync_api import Browser, Locator, Page, expect

from conftest import PATIENCE_MS, Studio, opened_page

if TYPE_CHECKING:
    from collections.abc import Callable

EMPTY = "# nothing yet\n"
# Beside the wheel of the template; feedback may be as old as a busy machine makes it.
ELBOW = (
    "- {name: elbow, model: DM4310, id: 3, master_id: 19, feedback_timeout_ms: 1000,"
    " simulated: {inertia_kg_m2: 0.05, coulomb_nm: 0.3}}"
)
OF_THE_WHEEL = ("feedback_timeout_ms: 1000", "simulated: {inertia_kg_m2: 0.01}")


class RootHelper(FileHelper):
    """The robot's root helper, which does what it is asked."""

    def __init__(self, path: Path, daemon: Daemon) -> None:
        super().__init__(path)
        self._daemon = daemon

    def answer_to(self, request: FileRequest) -> str:
        if request.verb == "install":
            old = self._daemon.config.read_bytes()
            if request.replaces != hashlib.sha256(old).hexdigest():
                return "refused\nthe file is another one"
            self._daemon.config.write_text(request.text)
            return "done\nwritten"
        if any(motor["status"] != "READY" for motor in self._daemon.state()["motors"]):
            return "refused\na motor is not READY"
        self._daemon.program.stop()
        self._daemon.start()
        self._daemon.wait_ready()
        return "done\nrc10d runs again"


@pytest.fixture
def studio(tmp_path: Path) -> Iterator[Studio]:
    with Daemon(EMPTY) as daemon, RootHelper(tmp_path / "config.socket", daemon) as helper:
        assert daemon.program.wait() == 2
        running = Studio(daemon, "--config-socket", str(helper.path))
        yield running
        running.web.stop()


@pytest.fixture
def page(chromium: Browser, studio: Studio) -> Iterator[Page]:
    with opened_page(chromium, studio) as opened:
        yield opened


@dataclass
class Part:
    name: str
    clicks: int
    fields: int
    seconds: float


class Newcomer:
    """A person whose clicks (two for a choice) and typed fields or lines are counted."""

    def __init__(self, page: Page, studio: Studio) -> None:
        self.page = page
        self.studio = studio
        self.card = page.locator(".card.step")
        self.form = page.get_by_role("region", name="Test of motion")
        self.proposal = page.get_by_role("region", name="Proposal")
        self.gains = page.locator(".gains")
        self.parts: list[Part] = []
        self._clicks = 0
        self._fields = 0
        self._begun = time.monotonic()

    def done(self, name: str) -> None:
        """The end of a part of the way."""
        now = time.monotonic()
        self.parts.append(Part(name, self._clicks, self._fields, now - self._begun))
        self._clicks = self._fields = 0
        self._begun = now

    def so_far(self) -> tuple[int, int]:
        """Clicks and fields of this part."""
        return self._clicks, self._fields

    def forget_since(self, before: tuple[int, int]) -> None:
        """Clicks that a machine which stood still has made vain do not count."""
        self._clicks, self._fields = before

    def click(self, target: Locator) -> None:
        target.click()
        self._clicks += 1

    def press(self, within: Locator | Page, name: str | re.Pattern[str]) -> None:
        self.click(within.get_by_role("button", name=name).first)

    def tab(self, part: str) -> None:
        self.click(self.page.locator(f"#tab-{part}"))

    def choose(self, field: Locator, option: str) -> None:
        field.select_option(option)
        self._clicks += 2

    def fill(self, field: Locator, text: str) -> None:
        field.fill(text)
        self._fields += 1

    def write(self, beside: str, key: str, text: str) -> None:
        """Lines in the editor, at the begin or the end of another one."""
        self.click(self.page.locator(".cm-line", has_text=beside))
        self.page.keyboard.press(key)
        self.page.keyboard.type(text)
        self._fields += len(text.strip().splitlines())

    def by_hand(self, motor: str, deg: int) -> None:
        with turning(self.studio, motor, deg) as button:
            self.press(self.card, button)

    def hold(self, motor: str, label: str, words: str, before_again: Callable[[], None]) -> None:
        """Enabled alone and held; repetitions for a machine that stood still do not count."""
        held(self.page, self.studio, self.card, motor, label, words, before_again)
        self._clicks += 2
        stands(self.studio, motor)

    def runs_test(self) -> None:
        # Only this machine stands still for so long.
        self.form.get_by_label("age of feedback at most").fill("2000")
        self.form.get_by_label("silence of this page at most").fill("1000")
        runs_to(self.form, "Done")
        self._clicks += 1

    def measure(self, motor: str, words: str) -> None:
        # On a machine that stands still a pulse lasts as long as the silence: back from the limit.
        for _ in range(5):
            if words in measures(self.proposal).inner_text():
                break
            self.studio.daemon.ctl("hand", motor, "--to", 30, "--rpm", 60)
            stands(self.studio, motor)
        expect(self.proposal.locator("p[role=status]")).to_contain_text(words)
        self._clicks += 1

    def enable(self) -> None:
        self.click(self.page.get_by_role("button", name="Enable", exact=True))
        expect(self.page.locator(".badge.status")).to_have_text("ACTIVE")

    def disable(self, motor: str) -> None:
        self.click(self.page.get_by_role("button", name="Disable", exact=True))
        rests(self.studio, motor)

    def install(self) -> None:
        """The text of the editor, in force."""
        expect(self.page.locator(".verdict-badge")).to_contain_text("rc10d accepts it")
        self.click(self.page.get_by_text("To install it"))
        self.press(self.page, "Install on the robot")
        expect(self.page.get_by_text("written", exact=True)).to_be_visible()
        self.press(self.page, "Restart rc10d")
        expect(self.page.get_by_text("rc10d runs again")).to_be_visible(timeout=3 * PATIENCE_MS)


def first_file(newcomer: Newcomer) -> None:
    """The template, two motors, and the only step that is no click: the first start."""
    page, daemon = newcomer.page, newcomer.studio.daemon
    expect(page.get_by_label("It refused to start")).to_contain_text("the document is empty")
    newcomer.tab("configuration")
    editor = page.get_by_label("Text of the configuration")
    expect(editor).to_contain_text(EMPTY.strip())
    newcomer.press(page, "Template")
    expect(editor).to_contain_text("robot: my_robot")
    newcomer.write("- name: wheel", "Home", f"{ELBOW}\n")
    newcomer.write("on_estop: coast", "End", "".join(f"\n{line}" for line in OF_THE_WHEEL))
    bus = page.get_by_role("region", name="can", exact=True)
    expect(bus.get_by_role("row", name=re.compile("^elbow"))).to_contain_text("DM4310")
    expect(page.locator(".verdict-badge")).to_contain_text("rc10d accepts it")
    with page.expect_download() as saved:
        newcomer.press(page, "Download")
    daemon.config.write_text(Path(saved.value.path()).read_text())
    daemon.start()
    daemon.wait_ready()
    newcomer.done("the first file")


def begin(newcomer: Newcomer, motor: str) -> None:
    newcomer.tab("commission")
    newcomer.choose(newcomer.page.get_by_role("combobox", name="Motor"), motor)
    row = newcomer.card.get_by_role("row", name=re.compile(f"^{motor}")).first
    expect(row).to_contain_text(re.compile(r"0x\d+"))


def turn_once(newcomer: Newcomer, motor: str) -> None:
    newcomer.press(newcomer.card, "Begin")
    newcomer.by_hand(motor, 360)
    knows_the_turn(newcomer.card)
    newcomer.press(newcomer.card, "The mark is back")
    if NOT_JUDGED in told(newcomer.card).inner_text():
        turned_by_hand(newcomer.studio, newcomer.card, motor)
    expect(told(newcomer.card)).to_contain_text("name, direction and ratio are right")
    newcomer.press(newcomer.card, "Next")


def commission_the_wheel(newcomer: Newcomer) -> None:
    card = newcomer.card
    begin(newcomer, "wheel")
    newcomer.press(card, "Scan this bus")
    drives = card.get_by_role("group", name="Drives that were heard")
    for motor in ("wheel", "elbow"):
        row = drives.get_by_role("row", name=re.compile(motor))
        expect(row).to_have_count(1, timeout=2 * PATIENCE_MS)
    newcomer.press(card, "say id 1")
    expect(told(card)).to_contain_text("wheel is heard as id 1")
    newcomer.press(card, "Next")
    turn_once(newcomer, "wheel")
    newcomer.press(card, "Set")
    expect(told(card)).to_contain_text("reads 0.0° there now")
    newcomer.press(card, "Next")
    newcomer.press(card, "It has no ends")
    newcomer.press(card, "Next")
    newcomer.hold("wheel", "Hold to spin", "the right way", lambda: None)
    newcomer.press(card, "Next")
    newcomer.hold("wheel", "Hold to step", "of 20.0 rpm", lambda: None)
    newcomer.press(card, "Next")
    report = card.get_by_role("group", name="Report")
    expect(report.locator("tr.good")).to_have_count(6)
    expect(report).to_contain_text("The file needs no change.")
    newcomer.done("the M3508, commissioned")


def gains_of_the_wheel(studio: Studio) -> dict[str, float]:
    found: dict[str, float] = json.loads(studio.daemon.must("gains", "wheel", "--json"))["gains"]
    return found


def tune_the_wheel(newcomer: Newcomer) -> float:
    """The gain that was proposed, and lies in the editor."""
    page, kp = newcomer.page, "velocity_pid.kp_a_per_rpm"
    before = gains_of_the_wheel(newcomer.studio)[kp]
    newcomer.tab("tune")
    newcomer.enable()
    newcomer.fill(newcomer.form.get_by_label("current at most"), "8")
    newcomer.runs_test()
    newcomer.fill(newcomer.proposal.get_by_label("speed at most"), "500")
    newcomer.measure("wheel", kp)
    proposed = float(newcomer.gains.get_by_label(kp, exact=True).input_value())
    newcomer.press(newcomer.gains, "Apply")
    expect(newcomer.gains.get_by_role("button", name="Undo (1)")).to_be_enabled()
    newcomer.runs_test()
    # The same step with both gains, beside one another.
    row = page.get_by_role("region", name="Tests", exact=True).get_by_role("row", name=kp)
    expect(row).to_contain_text(f"{before:g}")
    expect(row).to_contain_text(f"{proposed:g}")
    newcomer.disable("wheel")
    newcomer.press(newcomer.gains, "Put them into the Configuration")
    editor = page.get_by_label("Text of the configuration")
    expect(editor).to_contain_text(f"kp_a_per_rpm: {proposed:g}")
    newcomer.done("the M3508, tuned")
    return proposed


def commission_the_elbow(newcomer: Newcomer) -> None:
    card = newcomer.card
    begin(newcomer, "elbow")
    newcomer.press(card, "say id 3")
    newcomer.press(card, "Next")
    turn_once(newcomer, "elbow")
    newcomer.fill(card.get_by_label("It stands at"), "30")
    newcomer.press(card, "Set")
    expect(told(card)).to_contain_text("zero_deg in the file keeps it")
    newcomer.press(card, "Next")

    before_ends = newcomer.so_far()

    def ends() -> None:
        newcomer.by_hand("elbow", -90)
        knows_the_angle(newcomer.studio, card, "elbow")
        newcomer.press(card, "Lower end is here")
        for _ in range(2):
            newcomer.by_hand("elbow", 90)
        knows_the_angle(newcomer.studio, card, "elbow")
        newcomer.press(card, "Upper end is here")

    def anew() -> None:
        newcomer.forget_since(before_ends)
        zero_again(newcomer.page, card)

    both_ends(card, ends, anew)
    expect(told(card)).to_contain_text("travel")
    newcomer.by_hand("elbow", -90)
    newcomer.press(card, "Next")
    # Let go at half of the usual speed it stays within its travel.
    newcomer.fill(card.get_by_label("let go above"), "30")

    def back() -> None:
        newcomer.studio.daemon.must("hand", "elbow", "--to", "30", "--rpm", "60")
        stands(newcomer.studio, "elbow")

    newcomer.hold("elbow", "Hold to spin", "the right way", back)
    newcomer.press(card, "Next")
    newcomer.hold("elbow", "Hold to step", "deg", back)
    newcomer.press(card, "Next")
    expect(card.get_by_role("group", name="Report").locator("tr.good")).to_have_count(6)
    newcomer.press(card, "Put them into the Configuration")
    editor = newcomer.page.get_by_label("Text of the configuration")
    expect(editor).to_contain_text(re.compile(r"name: elbow, .*angle_max_deg: "))
    newcomer.done("the Damiao joint, commissioned")


def overshoots(page: Page, name: str) -> list[float]:
    """Overshoot of each test of that name that was not ended early, in percent."""
    results = page.get_by_role("region", name="Tests", exact=True)
    names = results.get_by_role("columnheader").all_inner_texts()[1:]
    cells = results.get_by_role("row", name="overshoot").get_by_role("cell").all_inner_texts()
    return [
        float(cell.split()[0].replace("\u2212", "-"))
        for title, cell in zip(names, cells, strict=True)
        if name in title and cell != "\u2013"
    ]


def tune_the_elbow(newcomer: Newcomer) -> None:
    newcomer.tab("tune")
    newcomer.enable()
    newcomer.choose(newcomer.form.get_by_label("mode", exact=True), "total_angle")
    for label, value in (
        ("amplitude", "10"),
        ("current at most", "12"),
        ("speed at most", "200"),
    ):
        newcomer.fill(newcomer.form.get_by_label(label), value)
    newcomer.runs_test()
    ended(newcomer.form, "elbow coasts")
    newcomer.fill(newcomer.proposal.get_by_label("speed at most"), "200")
    newcomer.measure("elbow", "N·m/A")
    newcomer.disable("elbow")
    newcomer.press(newcomer.proposal, "Put them into the Configuration")
    editor = newcomer.page.get_by_label("Text of the configuration")
    expect(editor).to_contain_text(re.compile(r"name: elbow, .*angle_stiffness_nm_per_rad: "))
    newcomer.install()
    newcomer.tab("tune")
    newcomer.enable()
    newcomer.runs_test()
    newcomer.disable("elbow")
    before, *_, after = overshoots(newcomer.page, "elbow step 10 °")
    assert after < before
    newcomer.done("the Damiao joint, tuned")


# Clicks and typed fields of docs/studio.md.
WAY = {
    "the first file": (5, 3),
    "the M3508, commissioned": (20, 0),
    "the M3508, tuned": (8, 2),
    "the Damiao joint, commissioned": (26, 2),
    "both, installed": (3, 0),
    "the Damiao joint, tuned": (15, 4),
}


@pytest.mark.timeout(600)
def test_a_newcomer_goes_from_an_empty_file_to_a_tuned_wheel_and_joint_by_clicks(
    page: Page, studio: Studio
) -> None:
    newcomer = Newcomer(page, studio)
    first_file(newcomer)
    commission_the_wheel(newcomer)
    proposed = tune_the_wheel(newcomer)
    commission_the_elbow(newcomer)
    # The wheel's gains are in the text still.
    expect(page.get_by_label("Text of the configuration")).to_contain_text("velocity_pid")
    newcomer.install()
    newcomer.done("both, installed")
    tune_the_elbow(newcomer)
    # All of it outlives the restart, in the file alone.
    assert gains_of_the_wheel(studio)["velocity_pid.kp_a_per_rpm"] == pytest.approx(proposed)
    text = studio.daemon.config.read_text()
    for key in ("zero_deg", "angle_min_deg", "angle_max_deg", "angle_stiffness_nm_per_rad"):
        assert text.count(key) == 1
    assert motor_of(studio.daemon.state(), "elbow")["zeroed"]
    for part in newcomer.parts:
        print(f"{part.name}: {part.clicks} clicks, {part.fields} fields, {part.seconds:.0f} s")
    for part in newcomer.parts:
        clicks, fields = WAY[part.name]
        assert part.clicks <= clicks, part
        assert part.fields <= fields, part
    assert [part.name for part in newcomer.parts] == list(WAY)
