"""MCAP files that the page saves, read by the maker's reader."""

from __future__ import annotations

import json
import math
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hostlib.stalls import stood_still_since
from mcap.reader import make_reader
from playwright.sync_api import Locator, Page, WebSocketRoute, expect
from test_capture import has_arrived, panel, step_with
from test_side_plots import answer_the_past

from conftest import Studio

__all__ = ["panel"]

MILLISECOND_NS = 1_000_000
TOPIC = "/host/motor/wheel"


@dataclass
class Mcap:
    """A file that was saved."""

    messages: dict[str, list[tuple[int, dict[str, float]]]] = field(default_factory=dict)
    schemas: dict[str, dict[str, Any]] = field(default_factory=dict)
    units: dict[str, dict[str, str]] = field(default_factory=dict)
    about: dict[str, str] = field(default_factory=dict)

    @staticmethod
    def saved(page: Page, button: Locator) -> Mcap:
        """Presses the button, and reads the file; the reader checks its sums."""
        with page.expect_download() as download:
            button.click()
        found = Mcap()
        path = Path(download.value.path())
        assert download.value.suggested_filename.endswith(".mcap")
        with path.open("rb") as file:
            reader = make_reader(file, validate_crcs=True)
            for schema, channel, message in reader.iter_messages():
                assert schema is not None
                assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
                assert message.publish_time == message.log_time
                found.schemas[channel.topic] = json.loads(schema.data)
                found.units[channel.topic] = channel.metadata
                values = json.loads(message.data)
                found.messages.setdefault(channel.topic, []).append((message.log_time, values))
            for record in reader.iter_metadata():
                assert record.name == "rc10"
                found.about = record.metadata
        return found


def test_each_tick_of_a_plot_is_in_it_with_its_time_and_the_units(page: Page) -> None:
    def signal(place: int, time_s: float) -> float:
        tick = round(time_s * 1000)
        if place == 1:
            return math.nan if tick % 2 else tick % 100 + 0.25
        return tick % 100_000 - 50_000

    answer_the_past(page, signal)
    mcap = Mcap.saved(page, page.get_by_role("button", name="MCAP", exact=True))
    assert mcap.schemas == {
        TOPIC: {
            "type": "object",
            "properties": {
                "velocity_rpm": {"type": "number", "description": "rpm"},
                "current_a": {"type": "number", "description": "A"},
            },
        }
    }
    assert mcap.units == {TOPIC: {"velocity_rpm": "rpm", "current_a": "A"}}
    assert mcap.about["robot"] == "host"
    assert len(mcap.about["config_hash"]) == 64
    messages = mcap.messages[TOPIC]
    # Ten seconds, in three answers of rc10-web.
    assert len(messages) in (10_000, 10_001)
    begin_ns = messages[0][0]
    assert [time_ns - begin_ns for time_ns, _ in messages] == [
        i * MILLISECOND_NS for i in range(len(messages))
    ]
    wall_ns = int(mcap.about["wall_minus_monotonic_us"]) * 1000
    for time_ns, values in messages:
        tick = (time_ns - wall_ns) // MILLISECOND_NS
        wanted = {"velocity_rpm": tick % 100_000 - 50_000}
        # A value that is not reported is left out.
        assert values == (wanted if tick % 2 else {**wanted, "current_a": tick % 100 + 0.25})


def test_there_is_nothing_to_save_before_the_first_values(page: Page) -> None:
    held = True

    def relay(socket: WebSocketRoute) -> None:
        server = socket.connect_to_server()
        socket.on_message(server.send)

        def pass_on(message: str | bytes) -> None:
            if isinstance(message, str) or not held:
                socket.send(message)

        server.on_message(pass_on)

    page.route_web_socket("**/link", relay)
    page.reload()
    page.locator("#tab-plots").click()
    button = page.get_by_role("button", name="MCAP", exact=True)
    expect(page.locator(".plot > .legend tr")).to_have_count(2)
    expect(button).to_be_disabled()
    held = False
    expect(button).to_be_enabled()


def test_the_times_are_those_of_rc10d_and_motors_have_their_topics(
    page: Page, studio: Studio
) -> None:
    page.locator("#tab-plots").click()
    # A standstill is soon out of the picture.
    page.get_by_label("span").select_option("5")
    page.get_by_role("group", name="yaw").get_by_label("angle_deg", exact=True).check()
    expect(page.locator(".plot > .legend tr")).to_have_count(3)
    expect(page.locator(".plot > .legend td.number").last).not_to_contain_text("\N{EN DASH}")
    for _ in range(5):
        begin_s = time.monotonic()
        begin_us = studio.daemon.state()["utime"]
        times_us = [0]
        while times_us[0] < begin_us:
            mcap = Mcap.saved(page, page.get_by_role("button", name="MCAP", exact=True))
            assert mcap.messages.keys() == {TOPIC, "/host/motor/yaw"}
            times_us = [time_ns // 1000 for time_ns, _ in mcap.messages[TOPIC]]
        assert times_us[-1] <= studio.daemon.state()["utime"]
        assert times_us == sorted(set(times_us))
        # A busy computer leaves ticks out, and not a third of them unless it stands still.
        enough = len(times_us) > (times_us[-1] - times_us[0]) / 1000 * 2 / 3
        if enough or not stood_still_since(begin_s, "a picture of each tick"):
            break
    assert enough


def test_ticks_whose_answer_is_left_out_are_asked_for_again(page: Page) -> None:
    left_out: list[str | bytes] = []

    def relay(socket: WebSocketRoute) -> None:
        server = socket.connect_to_server()

        def handle(message: str | bytes) -> None:
            told = json.loads(message)
            # A picture asks for wider columns.
            if told["type"] == "range" and told["column_us"] == 1000 and not left_out:
                left_out.append(message)
            else:
                server.send(message)

        socket.on_message(handle)

    page.route_web_socket("**/link", relay)
    page.reload()
    page.locator("#tab-plots").click()
    expect(page.locator(".plot > .legend td.number").last).not_to_contain_text("\N{EN DASH}")
    mcap = Mcap.saved(page, page.get_by_role("button", name="MCAP", exact=True))
    assert len(left_out) == 1
    assert mcap.messages[TOPIC]


def test_ticks_that_the_server_does_not_have_any_more_are_said_to_be_missing(page: Page) -> None:
    answer_the_past(page, lambda _place, _time_s: math.nan)
    page.get_by_role("button", name="MCAP", exact=True).click()
    expect(page.locator(".plot .toolbar").first.get_by_role("alert")).to_contain_text(
        "rc10-web has none of these ticks any more"
    )


def test_a_writer_that_cannot_be_loaded_is_said_with_its_reason(page: Page) -> None:
    page.route(
        "**/mcap.js",
        lambda route: route.fulfill(body="throw 'torn'", content_type="text/javascript"),
    )
    page.locator("#tab-plots").click()
    expect(page.locator(".plot > .legend td.number").last).not_to_contain_text("\N{EN DASH}")
    page.get_by_role("button", name="MCAP", exact=True).click()
    expect(page.locator(".plot .toolbar").first.get_by_role("alert")).to_have_text(
        "The MCAP file could not be made: torn"
    )


def test_a_capture_is_saved_with_its_gains(page: Page, panel: Locator) -> None:
    step_with(page, panel, has_arrived)
    mcap = Mcap.saved(page, panel.get_by_role("button", name="MCAP yaw 1"))
    [(topic, messages)] = mcap.messages.items()
    assert topic == "/host/motor/yaw"
    assert mcap.units[topic] == {"target_shaped": "rpm", "velocity_rpm": "rpm", "current_a": "A"}
    assert mcap.about["capture"] == "yaw 1"
    assert float(mcap.about["gain velocity_pid.kp_a_per_rpm"]) > 0
    assert 1000 < len(messages) <= 1200
    assert max(values.get("velocity_rpm", 0.0) for _, values in messages) >= 18
