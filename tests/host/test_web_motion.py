"""Tests of motion of a page: refused, ended and at rest, by the frames on the bus."""

from __future__ import annotations

import functools
import hashlib
import json
import signal
import struct
import subprocess
import sys
import time
from typing import TYPE_CHECKING, Any

import pytest
from hostlib import Daemon, Program
from hostlib.program import PATIENCE_S, eventually
from hostlib.stalls import stood_still_since
from test_motion import ROBOT
from test_web import ELSEWHERE, HEADER, Page, Web

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

STEP = {"kind": "step", "mode": "velocity", "amplitude": 60, "max_current_a": 12}
# A pause of the machine is neither old feedback nor silence.
PATIENT = {"max_speed_rpm": 1000, "max_feedback_age_ms": 2000, "dead_man_ms": 1000}
SWEEP = {**STEP, **PATIENT, "kind": "sweep", "amplitude": 20, "base": 60, "seconds": 60}
CURVE = 5
SILENCE_MS = 200
# The quickest message of some dozens still takes a moment, and clocks differ by a thousandth.
ON_THE_WAY_US = 50_000


def now_us() -> int:
    return time.monotonic_ns() // 1000


# Words of src/client/greeting.cpp, where rc10d stood still when the server knocked.
STOOD_STILL = "does not answer"


# Tries on a machine that stood still each time.
TIMES = 5


class TooBusy(Exception):
    """The machine did not renew a target or open a connection in time, so that nothing moves."""


def moves(test: Callable[..., None]) -> Callable[..., None]:
    """A motion that the machine was too busy for begins anew."""

    @functools.wraps(test)
    def again(*args: object, **kwargs: object) -> None:
        for _ in range(TIMES):
            begin_s = time.monotonic()
            try:
                return test(*args, **kwargs)
            except TooBusy:
                if not stood_still_since(begin_s, test.__name__):
                    raise
        return test(*args, **kwargs)

    return again


class Tester:
    """Tests of motion of an open page, kept going by it. Raises TooBusy."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.seq = 1000
        self.renewed_us = 0
        page.wait("state")

    def start(self, **wanted: object) -> None:
        self.seq += 1
        message = {"schema": 1, "motor": "wheel", "seq": self.seq, "sent_us": now_us()}
        self.page.send(type="test", **{**message, **wanted})

    def renew(self) -> None:
        self.renewed_us = now_us()
        self.page.send(type="test_renewal", seq=self.seq, sent_us=self.renewed_us)

    def until(self, *kinds: str, renewing: bool = True, after_s: float = 0.0) -> dict[str, Any]:
        """The next message of these kinds about this test, from this time of it on."""
        while True:
            if renewing and now_us() - self.renewed_us > 50_000:
                self.renew()
            message = self.page.next()
            if not isinstance(message, dict) or message.get("seq") != self.seq:
                continue
            self._check_busy(message)
            if message["type"] not in kinds:
                assert message["type"] != "response", message
                continue
            if message.get("time_s", 1e9) >= after_s:
                return message

    @staticmethod
    def _check_busy(message: dict[str, Any]) -> None:
        abort = message.get("report", {}).get("abort") or {}
        if "too busy" in abort.get("text", "") or STOOD_STILL in message.get("message", ""):
            raise TooBusy

    def outcome(self, **wanted: object) -> dict[str, Any]:
        """Report of a test to its end."""
        self.start(**wanted)
        done = self.until("test_done", "response")
        assert done["type"] == "test_done", done
        return done

    def refusal(self, **wanted: object) -> str:
        self.start(**wanted)
        refused = self.until("test_done", "response")
        assert refused["type"] == "response", refused
        assert refused["status"] == "refused"
        return str(refused["message"])

    def curve(self, ticks: int) -> list[list[float]]:
        """Each column of the curve, piece by piece."""
        columns: list[list[float]] = [[] for _ in range(9)]
        while len(columns[0]) < ticks:
            self.page.send(type="curve", seq=self.seq, first=len(columns[0]))
            while True:
                data = self.page.connection.recv(timeout=PATIENCE_S)
                if isinstance(data, bytes) and data[1] == CURVE:
                    break
            version, _, count, rows, _, _, seq, first = HEADER.unpack_from(data)
            assert (version, count, seq, first) == (1, 9, self.seq, len(columns[0]))
            for i, column in enumerate(columns):
                column += struct.unpack_from(f"<{rows}d", data, HEADER.size + i * rows * 8)
        return columns


@pytest.fixture(autouse=True)
def _enabled(robot: Daemon) -> None:
    robot.wait_motors(lambda motor: abs(float(motor["velocity_rpm"])) < 1.0, "all stand still")
    robot.must("clear")
    robot.must("enable", "wheel", "lift", "elbow")


@pytest.fixture
def web(robot: Daemon, tmp_path: Path) -> Iterator[Web]:
    server = Web(robot, tmp_path)
    with server.program:
        yield server


@pytest.fixture
def tests(web: Web) -> Iterator[Tester]:
    with web.page() as page:
        yield Tester(page)


def current_frames(robot: Daemon, since_us: int) -> list[tuple[int, int]]:
    """Time and current of the wheel of each frame to it since then, from the bus."""
    found = []
    for line in robot.must("blackbox", "--json").splitlines():
        record = json.loads(line)
        if record["kind"] != "frame" or record["direction"] != "sent":
            continue
        if record["bus"] == "arm" and record["mono_us"] >= since_us:
            identifier, _, data = record["frame"].partition("#")
            if identifier == "200":
                (current,) = struct.unpack(">h", bytes.fromhex(data[:4]))
                found.append((int(record["mono_us"]), current))
    return found


def assert_at_rest_since(robot: Daemon, begun_us: int, let_go_us: int) -> None:
    """It had torque before, and has none in any frame from then on."""
    robot.wait_motor("wheel", lambda m: m["owner"] == "" and m["acting"] == "nothing", "coasts")
    after_us = max(now_us(), let_go_us)
    frames = eventually(
        lambda: [f for f in [current_frames(robot, begun_us)] if f and f[-1][0] > after_us],
        "frames after it",
    )[0]
    turned = [at_us for at_us, current in frames if current != 0]
    assert turned, "the wheel had torque"
    assert turned[-1] <= let_go_us, f"{(turned[-1] - let_go_us) / 1000:.1f} ms too late"


@moves
def test_a_step_has_the_numbers_of_rc10ctl_and_each_tick_of_its_curve(tests: Tester) -> None:
    done = tests.outcome(**STEP, **PATIENT)
    report = done["report"]
    assert report["abort"] is None
    assert report["step"]["rise_s"] > 0.0
    assert {"settling_s", "overshoot_percent", "steady_error"} <= report["step"].keys()
    assert done["doing"] == "coasts"
    columns = tests.curve(report["ticks"])
    assert len(columns[0]) == report["ticks"] > 1000
    assert columns[1][-1] == 60.0
    assert max(columns[3]) == pytest.approx(report["step"]["peak"])
    # The last piece was the end of it there.
    tests.page.send(type="curve", seq=tests.seq, first=0)
    assert tests.page.ask("enable", "wheel")["status"] == "ok"


@moves
def test_a_sweep_tells_its_time_and_has_a_bode_plot_with_coherence(tests: Tester) -> None:
    tests.start(**{**SWEEP, "seconds": 8})
    goes_on = tests.until("test", after_s=1.0)
    # A second before it, and a period of the lowest frequency after it.
    assert goes_on["lasts_s"] == 10.0
    report = tests.until("test_done")["report"]
    assert report["abort"] is None, report
    assert len(report["response"]) > 5
    assert all(0.0 <= point["coherence"] <= 1.0 + 1e-9 for point in report["response"])
    assert {"bandwidth_hz", "phase_margin_deg", "gain_margin_db"} <= report.keys()
    # In pieces.
    assert len(tests.curve(report["ticks"])[0]) == report["ticks"]


@pytest.mark.parametrize(
    ("bound", "criterion"),
    [
        ({"max_angle_deg": 20}, "angle"),
        ({"max_speed_rpm": 60.5}, "velocity"),
        ({"max_current_a": 2}, "current"),
        ({"stop_at_limits": True}, "limit"),
    ],
)
@moves
def test_each_bound_ends_it_by_its_name(
    tests: Tester, robot: Daemon, bound: dict[str, object], criterion: str
) -> None:
    report = tests.outcome(**{**STEP, **PATIENT, **bound})["report"]
    assert report["abort"]["criterion"] == criterion
    assert report["abort"]["text"]
    robot.wait_motor("wheel", lambda m: m["owner"] == "" and m["acting"] == "nothing", "coasts")


@pytest.mark.parametrize("act", [("disable", "wheel"), ("estop",)])
@moves
def test_a_motor_that_is_disabled_or_stopped_ends_it(
    tests: Tester, robot: Daemon, act: tuple[str, ...]
) -> None:
    tests.start(**SWEEP)
    tests.until("test", after_s=1.2)
    robot.must(*act)
    assert tests.until("test_done")["report"]["abort"]["criterion"] == "status"


@moves
def test_another_owner_ends_it(tests: Tester, robot: Daemon) -> None:
    tests.start(**SWEEP)
    tests.until("test", after_s=1.2)
    robot.must("set", "wheel", "velocity", 30, "--for", "1s", "--priority", 1)
    assert tests.until("test_done")["report"]["abort"]["criterion"] == "ownership"


@moves
def test_a_page_that_ends_it_lets_the_motor_go(tests: Tester, robot: Daemon) -> None:
    for why, words in (("stopped", "stopped on the page"), ("left", "hidden or left")):
        begun_us = now_us()
        tests.start(**SWEEP)
        tests.until("test", after_s=1.5)
        tests.page.send(type="test_end", seq=tests.seq, why=why)
        ended_us = now_us()
        abort = tests.until("test_done", renewing=False)["report"]["abort"]
        assert abort["criterion"] == "interrupted"
        assert words in abort["text"]
        assert_at_rest_since(robot, begun_us, ended_us + 1_000_000)


@moves
def test_a_silent_page_lets_the_motor_go_within_its_time(tests: Tester, robot: Daemon) -> None:
    begun_us = now_us()
    tests.start(**{**SWEEP, "dead_man_ms": SILENCE_MS})
    done = tests.until("test", "test_done", after_s=1.5)
    if done["type"] == "test":
        done = tests.until("test_done", renewing=False)
    assert done["report"]["abort"]["criterion"] == "silence"
    assert "no word from the page for 200 ms" in done["report"]["abort"]["text"]
    let_go_us = tests.renewed_us + SILENCE_MS * 1000 + ON_THE_WAY_US
    assert_at_rest_since(robot, begun_us, let_go_us)
    # A renewal that comes too late begins nothing.
    tests.renew()
    assert tests.page.ask("enable", "wheel")["status"] == "ok"
    assert robot.state()["motors"][0]["owner"] == ""


BROWSER = f"""
import json, sys, time
from websockets.sync.client import connect
with connect(sys.argv[1], max_size=None) as page:
    now_us = lambda: time.monotonic_ns() // 1000
    seq = 0
    busy = True
    renewed = 0
    while True:
        # A machine that was too busy to renew its target lets it go: then once more.
        if busy:
            seq += 1
            page.send(json.dumps({{"type": "test", "schema": 1, "motor": "wheel", "seq": seq,
                                   "sent_us": now_us(), **json.loads(sys.argv[2])}}))
            busy = False
        if now_us() - renewed > 50_000:
            renewed = now_us()
            page.send(json.dumps({{"type": "test_renewal", "seq": seq, "sent_us": renewed}}))
        message = page.recv(timeout={PATIENCE_S})
        told = {{}} if isinstance(message, bytes) else json.loads(message)
        if told.get("type") in ("test", "test_done", "response"):
            print(json.dumps(told), flush=True)
            abort = told.get("report", {{}}).get("abort") or {{}}
            busy = "too busy" in abort.get("text", "") or {STOOD_STILL!r} in told.get("message", "")
"""


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
@pytest.mark.parametrize("victim", ["browser", "server"])
def test_what_is_killed_or_stands_still_in_a_sweep_leaves_rest_on_the_bus(
    web: Web, robot: Daemon, victim: str, number: signal.Signals
) -> None:
    begun_us = now_us()
    wanted = json.dumps(SWEEP)
    url = f"ws://127.0.0.1:{web.port}/link"
    with Program(sys.executable, "-c", BROWSER, url, wanted, env=robot.env) as browser:
        browser.wait_line(r'"test", .*"time_s": ?(1\.[5-9]|[2-9])')
        killed = browser if victim == "browser" else web.program
        killed.signal(number)
        # From its last renewal, which came before: of the page, or of a target by the server.
        silence_ms = 1000 if victim == "browser" else SILENCE_MS
        let_go_us = now_us() + silence_ms * 1000 + ON_THE_WAY_US
        try:
            assert_at_rest_since(robot, begun_us, let_go_us)
        finally:
            killed.signal(signal.SIGCONT)


@moves
def test_a_second_test_of_a_page_waits_for_the_first(tests: Tester) -> None:
    tests.start(**SWEEP)
    tests.until("test", after_s=0.5)
    first = tests.seq
    assert "goes on: stop it first" in tests.refusal(**STEP, **PATIENT)
    tests.page.send(type="test_end", seq=first)
    tests.seq = first
    assert tests.until("test_done")["report"]["abort"]["criterion"] == "interrupted"


@pytest.mark.parametrize(
    ("wanted", "told"),
    [
        ({"schema": 2}, "load the page anew"),
        ({"max_sped_rpm": 100}, "a test has no 'max_sped_rpm'"),
        ({"max_current_a": "12"}, "'max_current_a' is not a number"),
        ({"max_current_a": 0}, "current has no limit"),
        ({"max_speed_rpm": 30}, "beyond its limits"),
        ({"mode": "current", "amplitude": 1, "max_speed_rpm": None}, "needs a limit of the speed"),
        ({"mode": "impedance"}, "no reading follows"),
        ({"motor": "whell"}, "wheel"),
        ({"dead_man_ms": 5000}, "20 to 1000 ms"),
        ({"kind": "sweep", "to_hz": 90}, "0.05 to 50 Hz"),
    ],
)
@moves
def test_a_test_without_sense_is_refused_before_anything_moves(
    web: Web, robot: Daemon, wanted: dict[str, object], told: str
) -> None:
    with web.page() as page:
        tests = Tester(page)
        assert told in tests.refusal(**{**STEP, **PATIENT, **wanted})
    assert robot.state()["motors"][0]["owner"] == ""


@moves
def test_a_motor_that_is_not_active_is_not_moved(tests: Tester, robot: Daemon) -> None:
    robot.must("disable", "wheel")
    abort = tests.outcome(**STEP, **PATIENT)["report"]["abort"]
    assert abort["criterion"] == "status"
    assert "`rc10ctl enable wheel`" in abort["text"]


def test_a_page_on_another_computer_tests_nothing(robot: Daemon, tmp_path: Path) -> None:
    subprocess.run(["ip", "address", "replace", f"{ELSEWHERE}/32", "dev", "lo"], check=True)
    server = Web(robot, tmp_path, "--listen", "0.0.0.0", "--token-file", str(tmp_path / "token"))
    with server.program, server.page(ELSEWHERE) as page:
        page.wait("hello")
        page.send(type="token", token=server.token)
        assert "tunnel" in Tester(page).refusal(**STEP, **PATIENT)


@moves
def test_a_test_has_the_rights_of_the_pages_token_and_names_the_line_that_lacks(
    tmp_path: Path,
) -> None:
    tokens = {motor: f"{motor}only22222222222222222222abcd" for motor in ("lift", "wheel")}
    entries = [
        f"  - {{token: {hashlib.sha256(token.encode()).hexdigest()}, may: [command],"
        f" motors: [{motor}]}}"
        for motor, token in tokens.items()
    ]
    with Daemon("\n".join((ROBOT, "clients:", *entries))) as daemon:
        daemon.wait_ready()
        server = Web(daemon, tmp_path)
        with server.program, server.page() as lifts, server.page() as drives:
            for page, motor in ((lifts, "lift"), (drives, "wheel")):
                page.send(type="token", token=tokens[motor])
                assert page.ask("enable", motor)["status"] == "ok"
                daemon.wait_motor(motor, lambda m: m["status"] == "ACTIVE", "enabled")
            tests = Tester(lifts)
            report = tests.outcome(**{**STEP, **PATIENT, "motor": "lift"})["report"]
            assert report["abort"] is None, report
            abort = tests.outcome(**STEP, **PATIENT)["report"]["abort"]
            assert abort["criterion"] == "ownership"
            assert "may not command wheel: add it to `motors` at" in abort["text"]
            line = 1 + daemon.config.read_text().splitlines().index(entries[0])
            assert f"robot.yaml:{line}" in abort["text"]
            assert daemon.state()["motors"][0]["owner"] == ""
