"""Three pages look at 30 signals for an hour, others come and go: nothing grows or is lost."""

from __future__ import annotations

import json
import os
import re
import statistics
import threading
import time
from collections.abc import Sequence
from pathlib import Path

import pytest
from hostlib import Daemon
from hostlib.program import PATIENCE_S, eventually
from test_web import HEADER, Web
from websockets.sync.client import ClientConnection, connect

MINUTES = float(os.environ.get("RC10_STREAM_MINUTES", "60"))
MOTORS = [f"m{bus}_{i}" for bus in range(2) for i in range(1, 5)]
READINGS = ("target", "target_shaped", "velocity_rpm", "current_a")
SIGNALS = [f"{motor}.{reading}" for motor in MOTORS for reading in READINGS][:30]
COLUMN_US = 10_000
NEXT = 1
VIEWERS = 3
FRAMES_OF_A_VISIT = 25
# The allocator's own: a page that comes or goes takes and leaves some of it.
ROOM_KIB = 512
# A growing queue has hundreds: 256 KiB until its page gets less.
FRAMES_ON_THE_WAY = 10
# A busy computer keeps the link thread from the ring of 512 ticks now and then.
LOST_TICKS = 0.001

ROBOT = "\n".join(
    [
        "robot: host",
        "realtime: preferred",
        "guard: off",
        "lcm: {enabled: false}",
        "buses:",
        *(
            f"  - {{name: b{bus}, type: sim, motors: ["
            + ", ".join(
                f"{{name: m{bus}_{i}, model: M3508, feedback_timeout_ms: 1000, zero: power_on,"
                f" id: {i}}}"
                for i in range(1, 5)
            )
            + "]}"
            for bus in range(2)
        ),
    ]
)

pytestmark = pytest.mark.timeout(60 * MINUTES + 600)


class Viewer(threading.Thread):
    """An open page. It asks once a second, and counts what comes before the answer."""

    def __init__(self, url: str) -> None:
        super().__init__(daemon=True)
        self.url = url
        self.stop = threading.Event()
        self.next = 0
        self.gaps = 0
        self.waiting: list[int] = []
        self.failure: BaseException | None = None

    def run(self) -> None:
        try:
            with connect(self.url, max_size=None) as page:
                self.look(page)
        except BaseException as error:  # noqa: BLE001  # told by the test
            self.failure = error

    def look(self, page: ClientConnection) -> None:
        view = {"type": "view", "view": 1, "signals": SIGNALS, "column_us": COLUMN_US}
        page.send(json.dumps({**view, "span_us": 10_000_000}))
        before: int | None = None
        asked_s = time.monotonic()
        while not self.stop.is_set():
            data = page.recv(timeout=PATIENCE_S)
            if isinstance(data, bytes):
                self.take(data)
            elif json.loads(data)["type"] == "clock" and before is not None:
                self.waiting.append(before)
                before = None
                continue
            if before is not None:
                before += 1
            elif time.monotonic() - asked_s >= 1.0:
                asked_s = time.monotonic()
                page.send(json.dumps({"type": "clock", "sent_us": int(asked_s * 1e6)}))
                before = 0

    def take(self, data: bytes) -> None:
        _, kind, signals, count, _, _, first, _ = HEADER.unpack_from(data)
        assert signals == len(SIGNALS)
        # 0: nothing was there when it was opened.
        if kind == NEXT and self.next != 0 and first != self.next:
            self.gaps += 1
        self.next = int(first) + count


def visit(web: Web) -> int:
    """A page that is opened, draws a while, and is closed: ticks that rc10d has dropped."""
    with web.page() as page:
        page.wait("state")
        page.send(type="view", view=1, signals=SIGNALS[:5], column_us=1000, span_us=60_000_000)
        dropped = int(page.wait("view")["dropped_ticks"])
        for _ in range(FRAMES_OF_A_VISIT):
            page.next()
    return dropped


def resident_kib(pid: int) -> int:
    found = re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{pid}/status").read_text())
    assert found is not None
    return int(found[1])


def descriptors(pid: int) -> int:
    return len(list(Path(f"/proc/{pid}/fd").iterdir()))


def thirds(values: Sequence[int]) -> tuple[Sequence[int], Sequence[int]]:
    """The second and the last one: in the first, memory fills."""
    third = len(values) // 3
    assert third >= 3
    return values[third : 2 * third], values[-third:]


def test_an_hour_of_streaming_lets_nothing_grow(tmp_path: Path) -> None:
    with Daemon(ROBOT) as daemon:
        daemon.wait_ready()
        daemon.must("enable")
        web = Web(daemon, tmp_path)
        pids = {"rc10-web": web.program.pid, "rc10d": daemon.pid}
        memory: dict[str, list[int]] = {name: [] for name in pids}
        open_files: list[int] = []
        viewers = [Viewer(f"ws://127.0.0.1:{web.port}/link") for _ in range(VIEWERS)]
        moves = ("set", "m0_1", "velocity", 60, "--for", f"{60 * MINUTES + 600:.0f}s")
        with web.program, daemon.drive(*moves) as drive:
            begin = daemon.stats()
            for viewer in viewers:
                viewer.start()
            end_s = time.monotonic() + 60 * MINUTES
            while time.monotonic() < end_s:
                dropped = visit(web)
                for name, pid in pids.items():
                    memory[name].append(resident_kib(pid))
                open_files.append(descriptors(pids["rc10-web"]))
                assert [viewer.failure for viewer in viewers if not viewer.is_alive()] == []
            end = daemon.stats()
            # The pages have all until now.
            newest = end["mono_us"] // COLUMN_US
            eventually(lambda: all(one.next >= newest for one in viewers), "the end of the curves")
            for viewer in viewers:
                viewer.stop.set()
            for viewer in viewers:
                viewer.join()
                assert viewer.failure is None
            assert drive.running, drive.output
        print(f"KiB: {memory['rc10-web'][:: max(1, len(memory['rc10-web']) // 20)]}")
        for name, kib in memory.items():
            before, after = thirds(kib)
            assert max(after) <= max(before) + ROOM_KIB, name
        before, after = thirds(open_files)
        assert max(after) <= max(before)
        for viewer in viewers:
            before, after = thirds(viewer.waiting)
            assert statistics.median(after) <= statistics.median(before) + FRAMES_ON_THE_WAY
            assert viewer.gaps == 0
        ticks = end["tick"] - begin["tick"]
        assert ticks >= 0.9 * 60 * MINUTES * 1e6 / end["tick_period_us"]
        assert dropped <= LOST_TICKS * ticks
        assert [name for name, count in end["refusals"].items() if count] == []
        assert end["events_dropped"] == 0
        for bus in end["buses"]:
            lost = [key for key in ("rx_dropped", "tx_dropped", "error_frames") if bus[key]]
            assert lost == [], bus["name"]
