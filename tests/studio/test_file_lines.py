"""Gains and proposals of Tune, on their way into the robot's file."""

from __future__ import annotations

import json
import re

import pytest
from hostlib.daemon import ARM
from playwright.sync_api import Locator, Page, expect

from conftest import Studio

KP = "velocity_pid.kp_a_per_rpm"


@pytest.fixture
def robot() -> str:
    """The gains of a motor in none, one and three of its lines."""
    return (
        ARM
        + """
      - {name: wheel, model: M3508, id: 1, feedback_timeout_ms: 1000}
      - {name: braces, model: M3508, id: 2, feedback_timeout_ms: 1000,
         velocity_pid: {kp_a_per_rpm: 0.15, ki_a_per_rpm_s: 1}}
      - name: lines    # of its own
        model: M3508
        id: 3
        feedback_timeout_ms: 1000
        velocity_pid:
          ki_a_per_rpm_s: 1    # as last year
          kp_a_per_rpm: 0.16
  - name: joints
    type: sim
    motors:
      - {name: spring, model: DM4310, id: 9, master_id: 25, feedback_timeout_ms: 1000}
      - {name: own, model: DM4310, id: 10, master_id: 26, control: velocity,
         feedback_timeout_ms: 1000}
"""
    )


def choose(page: Page, motor: str) -> None:
    page.get_by_role("combobox", name="Motor").select_option(motor)


def editor_of(page: Page) -> Locator:
    return page.get_by_label("Text of the configuration")


def apply_and_put(page: Page, motor: str, kp: str) -> None:
    page.locator("#tab-tune").click()
    choose(page, motor)
    gains = page.locator(".gains")
    gains.get_by_label(KP, exact=True).fill(kp)
    gains.get_by_role("button", name="Apply").click()
    expect(gains.get_by_role("button", name="Undo (1)")).to_be_enabled()
    gains.get_by_role("button", name="Put them into the Configuration").click()
    expect(editor_of(page)).to_contain_text(f"kp_a_per_rpm: {kp}")
    expect(page.locator(".verdict-badge")).to_contain_text("rc10d accepts it")


def test_gains_in_force_come_into_the_file_beside_those_of_other_motors(
    page: Page, studio: Studio
) -> None:
    wanted = {"wheel": 0.31, "braces": 0.32, "lines": 0.33}
    for motor, kp in wanted.items():
        apply_and_put(page, motor, str(kp))
    with page.expect_download() as saved:
        page.get_by_role("button", name="Download").click()
    text = saved.value.path().read_text()
    assert "name: lines    # of its own" in text
    assert "# as last year" in text
    # The file that was made of all three has them in force.
    studio.daemon.program.stop()
    studio.daemon.config.write_text(text)
    studio.daemon.start()
    studio.daemon.wait_ready()
    for motor, kp in wanted.items():
        found = json.loads(studio.daemon.must("gains", motor, "--json"))["gains"]
        assert found[KP] == pytest.approx(kp)


def test_a_text_of_another_file_in_the_editor_gives_way_to_the_file_that_runs(page: Page) -> None:
    page.locator("#tab-configuration").click()
    expect(editor_of(page)).to_contain_text("robot: host")
    page.get_by_role("button", name="Template").click()
    expect(editor_of(page)).to_contain_text("robot: my_robot")
    apply_and_put(page, "wheel", "0.31")
    expect(editor_of(page)).to_contain_text("robot: host")


def test_a_proposal_is_of_gains_that_the_motor_has(page: Page) -> None:
    page.locator("#tab-tune").click()
    proposal = page.get_by_role("region", name="Proposal")
    choose(page, "wheel")
    expect(proposal).to_contain_text("gains of its velocity loop")
    choose(page, "spring")
    expect(proposal).to_contain_text("stiffness and damping of its angle targets")
    expect(proposal.get_by_role("button", name=re.compile("Search"))).to_have_count(0)
    choose(page, "own")
    expect(page.locator(".gains")).to_contain_text("rc10d closes no loop of the DM4310")
    expect(proposal).to_have_count(0)


class TestAFileOfAnotherEditor:
    """With a byte order mark, its lines ended by CR and LF."""

    @pytest.fixture
    def robot(self, robot: str) -> str:
        return "\ufeff" + robot.lstrip("\n").replace("\n", "\r\n")

    def test_gains_find_their_place_in_it(self, page: Page) -> None:
        for motor in ("wheel", "lines"):
            apply_and_put(page, motor, "0.31")
        with page.expect_download() as saved:
            page.get_by_role("button", name="Download").click()
        text = saved.value.path().read_bytes().decode()
        assert text.startswith("robot: ")
        assert "\r" not in text
        assert text.count("kp_a_per_rpm: 0.31") == 2

    def test_it_is_as_it_was_while_nobody_changes_it(self, page: Page) -> None:
        page.locator("#tab-configuration").click()
        expect(editor_of(page)).to_contain_text("name: wheel")
        expect(page.locator(".verdict-badge")).to_contain_text("rc10d accepts it")
        expect(page.get_by_text("changed", exact=True)).to_have_count(0)
