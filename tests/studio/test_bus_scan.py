"""Scans of a bus from the part Commission: what is heard, and what of it comes into the file."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

import pytest
from commissioning import JOINT, WHEEL, choose, press
from hostlib import Daemon
from hostlib.daemon import ARM
from playwright.sync_api import Locator, Page, WebSocketRoute, expect

from conftest import Studio


@pytest.fixture
def robot() -> str:
    return ARM + WHEEL + JOINT


# The drive of the wheel is set to id 4, and the file says 1.
OTHER_ID = """
      - {name: wheel, model: M3508, id: 1, zero: power_on, feedback_timeout_ms: 1000,
         simulated: {drive_id: 4}}
"""


class TestScan:
    @pytest.fixture
    def robot(self) -> str:
        return ARM + OTHER_ID + JOINT

    @pytest.fixture
    def studio(self, robot: str) -> Iterator[Studio]:
        with Daemon(robot) as daemon:
            daemon.wait_up()  # the wheel is not heard
            running = Studio(daemon)
            yield running
            running.web.stop()

    def test_a_drive_that_the_file_does_not_have_is_found_and_taken_over(
        self, page: Page, studio: Studio, card: Locator
    ) -> None:
        studio.daemon.wait_motor("elbow", lambda m: m["status"] == "READY", "it is heard")
        choose(page, "wheel")
        press(card, "Scan this bus")
        drives = card.get_by_role("group", name="Drives that were heard")
        stranger = drives.get_by_role("row", name=re.compile("^DJI M3508 or M2006"))
        expect(stranger).to_contain_text("not in the file")
        expect(stranger).to_contain_text("0x204")
        expect(drives.get_by_role("row", name=re.compile("elbow"))).to_have_count(1)
        expect(card.get_by_text("not heard, but in the file: wheel")).to_be_visible()
        # A motor that nobody hears may be this drive.
        press(card, re.compile("^Use: DJI"))
        expect(card.get_by_role("textbox", name="name")).to_have_value("wheel")
        expect(card.get_by_role("spinbutton", name="id", exact=True)).to_have_value("4")
        expect(card.get_by_label("Lines for the file")).to_have_text("id: 4")
        # Or a motor more.
        card.get_by_role("textbox", name="name").fill("feeder")
        expect(card.get_by_label("Lines for the file")).to_have_text(
            "{name: feeder, model: M3508, id: 4}"
        )
        press(card, "Put them into the Configuration")
        editor = page.get_by_label("Text of the configuration")
        expect(editor).to_contain_text("- {name: feeder, model: M3508, id: 4}")
        expect(page.locator(".verdict-badge")).to_contain_text("rc10d accepts it")

    def test_it_is_refused_while_a_motor_of_the_bus_is_enabled(
        self, page: Page, studio: Studio, card: Locator
    ) -> None:
        studio.daemon.wait_motor("elbow", lambda m: m["status"] == "READY", "it is heard")
        studio.daemon.must("enable", "elbow")
        choose(page, "wheel")
        press(card, "Scan this bus")
        expect(card.get_by_role("alert").filter(has_text="arm is scanned only")).to_contain_text(
            "elbow: ENABLING or ACTIVE: disable it first"
        )
        studio.daemon.must("disable", "elbow")


def guess(kind: str, number: int) -> dict[str, object]:
    return {"kind": kind, "id": number, "from_drive": True, "motor": None, "collides": False}


# A Damiao drive that answers another controller: bytes that a CubeMars drive may send, too.
DAMIAO = {
    "frame_id": 0x25,
    "extended": False,
    "frames": 200,
    "ambiguous": True,
    "guesses": [guess("Damiao", 5), guess("CubeMars (MIT)", 0x25)],
    "advice": None,
}


@pytest.fixture
def damiao(page: Page, card: Locator) -> Locator:
    """The first step of the elbow after a scan that has heard such a drive beside the others."""

    def opened(route: WebSocketRoute) -> None:
        server = route.connect_to_server()

        def answered(message: str | bytes) -> None:
            told = {} if isinstance(message, bytes) else json.loads(message)
            if told.get("heard"):
                told["heard"].append(DAMIAO)
                message = json.dumps(told)
            route.send(message)

        server.on_message(answered)

    page.route_web_socket(re.compile("/link"), opened)
    page.reload()
    choose(page, "elbow")
    press(card, "Scan this bus")
    return card


class TestScanThatHearsADamiao:
    def test_its_lines_have_the_id_on_which_it_answers(self, page: Page, damiao: Locator) -> None:
        press(damiao, "Use: Damiao 5")
        lines = damiao.get_by_label("Lines for the file")
        put = damiao.get_by_role("button", name="Put them into the Configuration")
        # Its label tells the model.
        expect(put).to_be_disabled()
        damiao.get_by_role("combobox", name="model").fill("DM4310")
        expect(lines).to_have_text("{name: motor_5, model: DM4310, id: 5, master_id: 37}")
        put.click()
        editor = page.get_by_label("Text of the configuration")
        expect(editor).to_contain_text("{name: motor_5, model: DM4310, id: 5, master_id: 37}")
        expect(page.locator(".verdict-badge")).to_contain_text("rc10d accepts it")

    def test_a_motor_of_the_file_gets_both_ids(self, page: Page, damiao: Locator) -> None:
        press(damiao, "Use: Damiao 5")
        damiao.get_by_role("textbox", name="name").fill("elbow")
        expect(damiao.get_by_label("Lines for the file")).to_have_text("id: 5\nmaster_id: 37")
        press(damiao, "Put them into the Configuration")
        editor = page.get_by_label("Text of the configuration")
        expect(editor).to_contain_text("name: elbow, model: DM4310, id: 5, master_id: 37,")
        expect(page.locator(".verdict-badge")).to_contain_text("rc10d accepts it")


class TestScanWithAnotherFamilySilent:
    @pytest.fixture
    def studio(self) -> Iterator[Studio]:
        with Daemon(ARM + OTHER_ID + JOINT) as daemon:
            daemon.wait_up()  # the wheel is not heard
            running = Studio(daemon)
            yield running
            running.web.stop()

    def test_it_is_not_taken_for_that_drive(self, page: Page, damiao: Locator) -> None:
        use = damiao.get_by_role("button", name="Use: Damiao 5")
        expect(use).to_be_visible()
        choose(page, "wheel")
        press(damiao, "Scan this bus")
        use.click()
        expect(damiao.get_by_role("textbox", name="name")).to_have_value("motor_5")
