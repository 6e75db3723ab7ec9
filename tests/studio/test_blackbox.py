"""The black box on the page: a recording of a robot, read, scrubbed, damaged and forged."""

from __future__ import annotations

import base64
import json
import math
import re
import struct
import subprocess
import urllib.request
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import pytest
from hostlib import Daemon
from hostlib.daemon import CONFIG, REPO
from playwright.sync_api import Browser, Page, expect

from conftest import PATIENCE_MS, Studio

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

# Offsets in src/blackbox/format.hpp: magic, version, pid, file_bytes.
VERSION_AT = 8
FILE_BYTES_AT = 16


@dataclass
class Box:
    """A recording of a robot that was enabled, driven and stopped, and what rc10ctl reads in it."""

    bytes: bytes
    records: list[dict[str, Any]]

    def of(self, kind: str) -> list[dict[str, Any]]:
        return [record for record in self.records if record["kind"] == kind]

    @property
    def stop_us(self) -> float:
        """The e-stop, since the first record."""
        stop = next(e for e in self.of("event") if e["text"].startswith("RUN -> ESTOP"))
        return float(stop["mono_us"] - self.records[0]["mono_us"])


@pytest.fixture(scope="module")
def box() -> Box:
    # So small that its history has begun anew several times.
    with Daemon("blackbox_mib: 1\n" + CONFIG.format(realtime="preferred")) as daemon:
        daemon.wait_ready()
        daemon.wait_state(lambda state: state["tick"] > 9000, "its history is full")
        daemon.must("enable")
        with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s"):
            daemon.wait_motor("wheel", lambda motor: motor["velocity_rpm"] > 50, "turns")
            daemon.must("estop")
        daemon.wait_motor("wheel", lambda motor: abs(motor["velocity_rpm"]) < 1, "stands")
        daemon.kill()
        content = (daemon.run_dir / "host.blackbox").read_bytes()
        lines = daemon.must("blackbox", "--json").splitlines()
    return Box(content, [json.loads(line) for line in lines])


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
    robots = box.of("robot")
    mono_us = box.records[0]["mono_us"] + box.stop_us
    known = [r for r in robots if r["mono_us"] <= mono_us + 1][-1]
    tick = known["tick"] + round((mono_us - known["mono_us"]) / 1000)
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
    slider = part.get_by_label("Moment")
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


def patched(content: bytes, at: int, value: bytes) -> bytes:
    return content[:at] + value + content[at + len(value) :]


def field_at(web: Studio, structure: str, name: str) -> int:
    return int(format_of(web)["structures"][structure]["fields"][name]["at"])


def format_of(web: Studio) -> dict[str, Any]:
    with urllib.request.urlopen(web.url + "recording-format.json") as answer:
        found: dict[str, Any] = json.load(answer)
    return found


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
