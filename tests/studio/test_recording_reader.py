"""The reader of recordings by itself, without the page: values, hostile bytes, order, questions."""

from __future__ import annotations

import base64
import json
import math
import struct
import subprocess
from typing import TYPE_CHECKING

import pytest
from hostlib.daemon import REPO
from playwright.sync_api import Browser, Page
from recorded import Box, field_at, format_of, patched

from conftest import PATIENCE_MS, Studio

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path


def bundle(folder: Path, *sources: str) -> Path:
    """Parts of the page by themselves, as the global name `parser`."""
    whole = folder / "all.ts"
    whole.write_text(
        "".join(f"export * from '{REPO / 'web' / 'src' / source}';\n" for source in sources)
    )
    entry = folder / "parser.js"
    [esbuild] = (REPO / "web" / "node_modules" / "@esbuild").glob("*/bin/esbuild")
    subprocess.run(
        [
            esbuild,
            whole,
            "--bundle",
            "--format=iife",
            "--global-name=parser",
            f"--outfile={entry}",
            "--log-level=warning",
        ],
        check=True,
    )
    return entry


@pytest.fixture(scope="module")
def parser(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The reader of the page without the page."""
    return bundle(tmp_path_factory.mktemp("parser"), "recording", "record_order")


@pytest.fixture
def reader(chromium: Browser, parser: Path, studio: Studio) -> Iterator[Page]:
    """A blank page with the parser, the format of rc10-web, and a place for a file."""
    context = chromium.new_context()
    context.set_default_timeout(6 * PATIENCE_MS)
    page = context.new_page()
    page.set_content("<input type=file>")
    page.add_script_tag(path=parser)
    page.evaluate("(format) => { window.format = format; }", format_of(studio))
    page.evaluate(
        """() => {
            window.bytes = async () =>
                new Uint8Array(await document.querySelector('input').files[0].arrayBuffer());
            window.entries = (r) => Array.from({length: r.size}, (_, i) => r.at(i));
        }"""
    )
    yield page
    context.close()


NAMES = {"order": "request"}
AS_ONE_NUMBER = {
    "motor": (
        "target target_shaped total_angle_deg angle_deg velocity_rpm current_a torque_nm voltage_v"
        " temperature_c command_value fault feedback_age_us feedback_age_at_use_us command_age_us"
    ),
    "robot": "tick missed_ticks estops",
    "bus": "rx_frames tx_frames tx_dropped error_frames",
    "setpoint": "value",
    "command": "priority",
    "order": "value",
}


def same(page_value: float | None, json_value: float | None) -> bool:
    if page_value is None or json_value is None:
        return page_value is json_value
    # A float has as many digits in the JSON as it needs.
    return page_value == json_value or page_value == pytest.approx(
        struct.unpack("<f", struct.pack("<f", json_value))[0], rel=1e-15
    )


def test_the_page_reads_the_values_that_rc10ctl_reads(
    reader: Page, box: Box, tmp_path: Path
) -> None:
    file = tmp_path / "host.blackbox"
    file.write_bytes(box.bytes)
    reader.locator("input").set_input_files(file)
    found = json.loads(
        reader.evaluate(
            """async () => {
                const r = new parser.Recording(format, await bytes());
                return JSON.stringify({header: r.header, damages: r.damages, first_ns: r.first_ns,
                                       entries: entries(r)});
            }"""
        )
    )
    head, *records = box.records
    header = found["header"]
    assert found["damages"] == []
    assert (header["robot"], header["pid"], header["rate_hz"]) == ("host", head["pid"], 1000)
    assert [motor["name"] for motor in header["motors"]] == ["wheel", "other", "yaw"]
    assert [motor["model"] for motor in header["motors"]] == ["M3508", "M3508", "GM6020"]
    assert [bus["name"] for bus in header["buses"]] == ["chassis", "gimbal"]
    entries = found["entries"]
    assert len(entries) == len(records) == head["records"]
    assert len(records) > 10_000
    for entry, record in zip(entries, records, strict=True):
        kind = entry["kind"]
        assert NAMES.get(kind, kind) == record["kind"]
        mono_us = math.floor(found["first_ns"] / 1000 + entry["time_us"] + 1e-3)
        assert abs(mono_us - record["mono_us"]) <= 1
        for name in AS_ONE_NUMBER.get(kind, "").split():
            assert same(entry["numbers"][name], record[name]), (entry, record)
        if kind == "frame":
            data = bytes(entry["list"]).hex().upper()
            assert record["frame"] == f"{entry['id']:03X}#{data}"
        if kind in ("command", "order", "event"):
            assert entry["texts"]["client"] == record["client"]
        if kind == "order":
            motors = [header["motors"][motor]["name"] for motor in entry["list"]]
            assert motors == record["motors"]
        if kind == "event":
            assert (entry["id"], entry["flags"]) == (
                record["code"],
                ["info", "warning", "error"].index(record["severity"]),
            )


def test_whatever_is_done_to_the_bytes_of_a_file_its_reader_ends_and_says_what_is_wrong(
    reader: Page, box: Box, tmp_path: Path
) -> None:
    file = tmp_path / "host.blackbox"
    file.write_bytes(box.bytes)
    reader.locator("input").set_input_files(file)
    outcomes = reader.evaluate(
        """async () => {
            const whole = await bytes();
            let state = 7;
            const random = (below) => {
                state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
                return Math.floor((state / 2 ** 32) * below);
            };
            const outcomes = {whole: new parser.Recording(format, whole).size, read: 0, refused: 0,
                              damaged: 0, most: 0, odd: []};
            for (let round = 0; round < 120; ++round) {
                let hostile = whole.slice(0, round % 3 === 0 ? random(whole.length) : whole.length);
                // The numbers of the head, all of it, records, and whole stretches.
                const place = Math.min(hostile.length, [hostile.length, 128, 65536][round % 3]);
                for (let i = 0; i < 40; ++i) hostile[random(place)] = random(256);
                if (round % 5 === 0) hostile.fill(random(256), random(hostile.length));
                // The version is right, or nothing else would be read.
                hostile.set(whole.subarray(0, 12).subarray(0, hostile.length));
                try {
                    const r = new parser.Recording(format, hostile);
                    for (let i = 0; i < r.size; i += 97) r.at(i);
                    ++outcomes.read;
                    outcomes.most = Math.max(outcomes.most, r.size);
                    if (r.damageCount > 0) ++outcomes.damaged;
                } catch (error) {
                    if (error instanceof parser.RecordingError) ++outcomes.refused;
                    else outcomes.odd.push(String(error.stack));
                }
            }
            return outcomes;
        }"""
    )
    assert outcomes["odd"] == []
    assert outcomes["read"] > 20
    assert outcomes["damaged"] > 10
    assert outcomes["refused"] > 5
    # No more records than a file of this size has room for.
    assert outcomes["most"] <= len(box.bytes) / 16


@pytest.mark.parametrize("bits", [52, 53, 63])
def test_positions_that_a_page_has_no_exact_numbers_for_do_not_keep_it_reading(
    reader: Page, studio: Studio, box: Box, tmp_path: Path, bits: int
) -> None:
    content = box.bytes
    # A history of an odd size ends between two numbers of this size.
    for name in ("history_bytes", "file_bytes"):
        at = field_at(studio, "header", name)
        [size] = struct.unpack_from("<Q", content, at)
        content = patched(content, at, struct.pack("<Q", size - 5))
    [history] = struct.unpack_from("<Q", content, field_at(studio, "header", "history_bytes"))
    step = 1 << (bits - 52)
    begin = next(
        place
        for place in range(1 << bits, 2 << bits, step)
        if 0 < history - place % history <= max(1, step // 2)
    )
    end = begin + max(64, step)
    control = format_of(studio)["control_at"]
    for name, place in (("oldest", begin), ("tail", end), ("head", end)):
        at = control + field_at(studio, "control", name)
        content = patched(content, at, struct.pack("<Q", place))
    file = tmp_path / "far.blackbox"
    file.write_bytes(content)
    reader.locator("input").set_input_files(file)
    found = reader.evaluate(
        """async () => {
            const r = new parser.Recording(format, await bytes());
            return {size: r.size, damages: r.damages.map((damage) => damage.what)};
        }"""
    )
    assert ("positions" in found["damages"]) == (bits > 52)
    assert found["size"] <= len(content) / 16


def test_records_in_any_disorder_are_put_in_order_in_a_bounded_number_of_steps(
    reader: Page, box: Box, tmp_path: Path
) -> None:
    file = tmp_path / "host.blackbox"
    file.write_bytes(box.bytes)
    reader.locator("input").set_input_files(file)
    found = reader.evaluate(
        """async () => {
            const whole = await bytes();
            const good = new parser.Recording(format, whole);
            const view = new DataView(whole.buffer);
            // Lower halves of times: all records are within four seconds, none where it was.
            const orders = {
                scattered: (i) => Math.imul(i + 1, 2654435761) >>> 0,
                backwards: (i) => good.size - i,
                halves: (i) => (i % 2) * good.size + i,
                saw: (i) => (i % 1000) * 1000,
                equal: () => 7,
            };
            const stepsOf = (times) => parser.sortByTime(times, new Uint32Array(times.length));
            const offsets = good.offsets.slice().sort();
            const found = {size: good.size, orders: []};
            found.own = stepsOf(Float64Array.from(offsets, (offset) => good.timeAt(offset)));
            // Places of their times: a record may go on at the beginning of the ring.
            const places = Array.from(offsets, (offset) => good.fileAt(offset + 8));
            for (const [name, time] of Object.entries(orders)) {
                for (const [i, place] of places.entries()) view.setUint32(place, time(i), true);
                const steps = stepsOf(Float64Array.from(places, (_, i) => time(i)));
                const r = new parser.Recording(format, whole);
                const inOrder = (at) => r.times[at - 1] < r.times[at] ||
                    (r.times[at - 1] === r.times[at] && r.offsets[at - 1] < r.offsets[at]);
                let wrong = 0;
                for (let i = 1; i < r.size; ++i) wrong += inOrder(i) ? 0 : 1;
                found.orders.push({name, steps, size: r.size, wrong,
                                   all: new Set(r.offsets).size === r.size});
            }
            return found;
        }"""
    )
    size = found["size"]
    assert size > 10_000
    assert found["own"] <= 16 * size
    for order in found["orders"]:
        assert (order["wrong"], order["all"], order["size"]) == (0, True, size), order
        # Each record moves at most once for each doubling; four more find the places to merge.
        assert order["steps"] <= size * (math.ceil(math.log2(size)) + 4), order


def test_of_a_file_that_is_cut_off_all_that_is_left_is_read(
    reader: Page, studio: Studio, box: Box, tmp_path: Path
) -> None:
    file = tmp_path / "host.blackbox"
    file.write_bytes(box.bytes)
    reader.locator("input").set_input_files(file)
    sizes = reader.evaluate(
        """async () => {
            const whole = await bytes();
            return [1, 0.9, 0.6].map((share) =>
                new parser.Recording(format, whole.slice(0, whole.length * share)).size);
        }"""
    )
    history = field_at(studio, "header", "history_offset")
    [begin] = struct.unpack_from("<Q", box.bytes, history)
    whole = len(box.bytes)
    for size, share in zip(sizes, (1, 0.9, 0.6), strict=True):
        left = max(0, share * whole - begin) / (whole - begin)
        assert size == pytest.approx(left * (len(box.records) - 1), rel=0.05)
    assert sizes[0] == len(box.records) - 1


def test_a_question_that_comes_while_another_file_is_read_is_answered(
    chromium: Browser, studio: Studio, box: Box, tmp_path: Path
) -> None:
    # The page asks for nothing more until it has the answer.
    context = chromium.new_context(bypass_csp=True)
    context.set_default_timeout(PATIENCE_MS)
    page = context.new_page()
    page.goto(studio.url)
    page.add_script_tag(path=bundle(tmp_path, "recording_reader"))
    found = page.evaluate(
        """async ([text, patience_ms]) => {
            const file = new Blob([Uint8Array.from(atob(text), (c) => c.charCodeAt(0))]);
            const reader = new parser.RecordingReader();
            const look = {from_us: 0, to_us: 1e6, columns: 100, signals: [], at_us: 1e6,
                          filter: '', problems: false};
            const opening = reader.open(file);
            const early = reader.look(look);
            const {robot} = await opening;
            const silence = new Promise((r) => setTimeout(r, patience_ms, 'no answer'));
            return {robot, early: await Promise.race([early, silence]),
                    later: (await reader.look(look)).motors.length};
        }""",
        [base64.b64encode(box.bytes).decode(), PATIENCE_MS / 2],
    )
    assert found == {"robot": "host", "early": None, "later": 3}
    context.close()
