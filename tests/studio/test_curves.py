"""Cost of a picture by its width: a fast signal, and a long one, is drawn by columns of pixels."""

from __future__ import annotations

import subprocess
from typing import TYPE_CHECKING

from hostlib.daemon import REPO

if TYPE_CHECKING:
    from pathlib import Path

    from playwright.sync_api import Browser, Page

# Numbers of a picture: its columns of pixels, its lines to a point, those of them that go up or
# down by more than they go aside, its rectangles.
COUNT = """() => {
    const zero = () => ({columns: 0, lines: 0, steep: 0, rectangles: 0});
    let now = zero();
    window.pictures = [];
    for (const prototype of [CanvasRenderingContext2D.prototype, Path2D.prototype]) {
        const {moveTo, lineTo} = prototype;
        let at = [0, 0];
        prototype.moveTo = function (x, y) { at = [x, y]; return moveTo.call(this, x, y); };
        prototype.lineTo = function (x, y) {
            ++now.lines;
            const [dx, dy] = [Math.abs(x - at[0]), Math.abs(y - at[1])];
            if (dx < 3 && dy > 4 * dx + 1) ++now.steep;
            at = [x, y];
            return lineTo.call(this, x, y);
        };
    }
    const context = CanvasRenderingContext2D.prototype;
    const {clearRect, fillRect} = context;
    context.fillRect = function (...at) { ++now.rectangles; return fillRect.apply(this, at); };
    context.clearRect = function (...at) {
        if (now.lines > 0) window.pictures.push(now);
        now = zero();
        now.columns = this.canvas.width;
        return clearRect.apply(this, at);
    };
}"""
# Each column of all signals as of a sawtooth of so many columns: src/web/columns_frame.hpp.
SAWTOOTH = """(period) => {
    const {get} = Object.getOwnPropertyDescriptor(MessageEvent.prototype, 'data');
    const done = new WeakSet();
    Object.defineProperty(MessageEvent.prototype, 'data', {get() {
        const data = get.call(this);
        if (!(data instanceof ArrayBuffer) || done.has(data)) return data;
        done.add(data);
        const view = new DataView(data);
        const [signals, columns] = [view.getUint16(2, true), view.getUint32(4, true)];
        const first = view.getFloat64(16, true);
        for (let signal = 0; signal < signals; ++signal)
            for (let i = 0; i < columns; ++i) {
                const phase = (first + i) % period;
                const low = 32 + (2 * signal * columns + i) * 4;
                view.setFloat32(low, (1000 * phase) / period, true);
                view.setFloat32(low + 4 * columns, (1000 * (phase + 1)) / period, true);
            }
        window.sawtooth = true;
        return data;
    }});
}"""
SIGNALS = [
    f"{motor}.{name}"
    for motor in ("wheel", "other", "yaw")
    for name in ("velocity_rpm", "current_a", "target", "torque_nm")
]
# Grid, axes and events.
BESIDE = 300


def drawn(picture: dict[str, int]) -> int:
    return picture["lines"] + picture["rectangles"]


def test_a_fast_sawtooth_has_no_more_lines_than_columns_of_pixels_and_no_steep_ones(
    page: Page,
) -> None:
    page.evaluate(
        "(signals) => localStorage.setItem('rc10.signals', JSON.stringify(signals))", SIGNALS
    )
    for period in (2, 7):
        page.reload()
        page.evaluate(COUNT)
        page.evaluate(SAWTOOTH, period)
        page.locator("#tab-plots").dispatch_event("click")
        page.locator(".chart canvas").wait_for()
        page.get_by_role("button", name="Keep behind").click()
        page.evaluate("() => { window.pictures.length = 0; }")
        pictures: list[dict[str, int]] = []
        # Until the curves are long enough for the bounds to count.
        while len(pictures) < 20 or drawn(pictures[-1]) <= len(SIGNALS) * 200:
            page.wait_for_timeout(100)
            pictures = page.evaluate("window.sawtooth ? window.pictures : []")
        for picture in pictures:
            # A band, its two edges, and the curve of before.
            assert drawn(picture) <= 4 * len(SIGNALS) * picture["columns"] + BESIDE
            assert picture["steep"] <= BESIDE


def test_columns_of_pixels_have_the_extremes_and_the_gaps_of_all_values(
    chromium: Browser, tmp_path: Path
) -> None:
    [esbuild] = (REPO / "web" / "node_modules" / "@esbuild").glob("*/bin/esbuild")
    script = tmp_path / "curves.js"
    source = REPO / "web" / "src" / "curves.ts"
    subprocess.run(
        [
            esbuild,
            source,
            "--format=iife",
            "--global-name=curves",
            f"--outfile={script}",
        ],
        check=True,
        capture_output=True,
    )
    with chromium.new_context() as context:
        blank = context.new_page()
        blank.add_script_tag(path=script)
        found = blank.evaluate(
            """() => {
                const times = Array.from({length: 100000}, (_, i) => i);
                const values = times.map((i) => (i === 43210 ? 9 : i === 56789 ? null : i % 2));
                const columns = curves.pixelColumns(times, {low: values, high: values},
                    (time) => (time - 40000) / 40, (value) => -value, [0, 500]);
                const seen = columns.map((column) => column.x);
                return {count: columns.length, first: seen[0], last: seen.at(-1),
                        highest: columns.filter((column) => column.top === -9).map((c) => c.x),
                        low: columns.every((column) => column.bottom === 0 || column.x < 0),
                        breaks: columns.filter((column) => !column.joined).map((c) => c.x)};
            }"""
        )
    assert found["count"] <= 500 + 3
    assert (found["first"], found["last"]) == (-1, 500)
    assert found["highest"] == [(43210 - 40000) // 40]
    assert found["low"]
    assert found["breaks"] == [-1, (56789 - 40000) // 40]
