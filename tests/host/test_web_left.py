"""A motor that a page has enabled, and the page is gone, or rc10-web: by the state of rc10d."""

from __future__ import annotations

import itertools
import json
import signal
import sys
from typing import TYPE_CHECKING, Any

import pytest
import test_motion
from hostlib import Daemon, Program
from hostlib.program import PATIENCE_S, eventually
from test_web import Web
from test_web_motion import PATIENT, STEP, STOOD_STILL, SWEEP, now_us

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

ROBOT = test_motion.ROBOT
AT_END = {"disable_at_end": 1}
JOG = {"type": "drive", "motor": "wheel", "mode": "velocity", "value": 20, "held": True}
SPIN = {**STEP, **PATIENT, "mode": "current", "amplitude": 1, "seconds": 60}

# It enables a motor, moves it as a page does, and says when the state shows that it moves.
BROWSER = f"""
import json, sys, time
from websockets.sync.client import connect
enable, moving = json.loads(sys.argv[2])
with connect(sys.argv[1], max_size=None) as page:
    now_us = lambda: time.monotonic_ns() // 1000
    say = lambda **message: page.send(json.dumps({{**message, "sent_us": now_us()}}))
    say(type="request", seq=1, target="wheel", **enable)
    begun = shown = False
    renewed = 0
    while True:
        if begun and now_us() - renewed > 50_000:
            renewed = now_us()
            say(**(moving if moving["type"] == "drive" else {{"type": "test_renewal"}}), seq=2)
        data = page.recv(timeout={PATIENCE_S})
        told = {{}} if isinstance(data, bytes) else json.loads(data)
        if told.get("type") == "response":
            print(data, flush=True)
            # rc10d stood still when the server knocked: then once more.
            begun = begun and {STOOD_STILL!r} not in told.get("message", "")
        if told.get("type") != "state":
            continue
        motor = next(one for one in told["data"]["motors"] if one["name"] == "wheel")
        if motor["status"] == "ACTIVE" and not begun:
            begun = True
            say(**moving, seq=2)
        if motor["acting"] == "target" and not shown:
            shown = True
            print("it moves", flush=True)
"""


@pytest.fixture(autouse=True)
def _all_off(robot: Daemon) -> None:
    robot.must("disable")
    robot.must("disable")  # nothing is held either
    robot.wait_motors(
        lambda m: m["status"] == "READY" and abs(float(m["velocity_rpm"])) < 1.0, "at rest"
    )


@pytest.fixture
def web(robot: Daemon, tmp_path: Path) -> Iterator[Web]:
    server = Web(robot, tmp_path)
    with server.program:
        yield server


MOVES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "jog": ({"operation": "enable", "values": AT_END}, JOG),
    "sweep": (
        {"operation": "enable", "values": AT_END},
        {"type": "test", "schema": 1, "motor": "wheel", **SWEEP},
    ),
    "spin": (
        {"operation": "enable_alone", "values": AT_END},
        {"type": "test", "schema": 1, "motor": "wheel", **SPIN},
    ),
}


@pytest.mark.parametrize("victim", ["browser", "server"])
@pytest.mark.parametrize("move", MOVES)
def test_what_is_killed_while_the_motor_moves_leaves_it_ready(
    web: Web, robot: Daemon, move: str, victim: str
) -> None:
    url = f"ws://127.0.0.1:{web.port}/link"
    with Program(sys.executable, "-c", BROWSER, url, json.dumps(MOVES[move]), env=robot.env) as it:
        it.wait_line("it moves")
        (it if victim == "browser" else web.program).signal(signal.SIGKILL)
        motor = robot.wait_motor("wheel", lambda m: m["status"] != "ACTIVE", "disabled")
    assert (motor["status"], motor["stop_cause"]) == ("READY", "request")
    assert motor["stopped_by"].startswith("web-1")
    # Nothing else is locked by one that was enabled alone.
    robot.must("enable", "elbow")


@pytest.mark.parametrize("victim", ["browser", "server"])
def test_what_is_killed_while_nothing_moves_leaves_the_motor_ready(
    web: Web, robot: Daemon, victim: str
) -> None:
    still = json.dumps([{"operation": "enable", "values": AT_END}, {"type": "clock"}])
    with Program(
        *(sys.executable, "-c", BROWSER, f"ws://127.0.0.1:{web.port}/link", still), env=robot.env
    ) as browser:
        robot.wait_motor("wheel", lambda m: m["status"] == "ACTIVE", "enabled")
        (browser if victim == "browser" else web.program).signal(signal.SIGKILL)
        robot.wait_motor("wheel", lambda m: m["status"] == "READY", "disabled")


def gone(web: Web, target: str, **values: float) -> None:
    """A page that enables a motor, and is closed."""
    with web.page() as page:
        assert page.ask("enable", target, **values)["status"] == "ok"


def when_all_ends_are_carried_out(web: Web, robot: Daemon) -> dict[str, Any]:
    """The motors by name, after the end of another page."""
    gone(web, "elbow", **AT_END)
    state = robot.wait_state(lambda s: s["motors"][2]["status"] == "READY", "elbow is disabled")
    return {motor["name"]: motor for motor in state["motors"]}


def test_a_motor_that_was_enabled_to_stay_outlives_its_page(web: Web, robot: Daemon) -> None:
    gone(web, "wheel")
    assert when_all_ends_are_carried_out(web, robot)["wheel"]["status"] == "ACTIVE"


def test_a_motor_that_was_on_before_is_not_the_pages(web: Web, robot: Daemon) -> None:
    robot.must("enable", "wheel")
    gone(web, "wheel", **AT_END)
    assert when_all_ends_are_carried_out(web, robot)["wheel"]["status"] == "ACTIVE"


def test_a_motor_that_was_let_go_and_enabled_since_is_not_the_pages(
    web: Web, robot: Daemon
) -> None:
    with web.page() as page:
        assert page.ask("enable", "wheel", **AT_END)["status"] == "ok"
        robot.must("disable", "wheel")
        robot.wait_motor("wheel", lambda m: m["status"] == "READY", "disabled")
        robot.must("enable", "wheel")
    assert when_all_ends_are_carried_out(web, robot)["wheel"]["status"] == "ACTIVE"


def test_a_motor_that_holds_by_its_on_timeout_holds_on(web: Web, robot: Daemon) -> None:
    with web.page() as page:
        assert page.ask("enable", "lift", **AT_END)["status"] == "ok"
        moves = False
        while not moves:
            page.send(**{**JOG, "motor": "lift"}, seq=1000, sent_us=now_us())
            moves = page.wait("state")["data"]["motors"][1]["acting"] == "target"
    robot.wait_motor("lift", lambda m: m["acting"] == "hold", "holds")
    lift = when_all_ends_are_carried_out(web, robot)["lift"]
    assert (lift["status"], lift["acting"]) == ("ACTIVE", "hold")


KP = "velocity_pid.kp_a_per_rpm"

# It tries a gain, as the search of the page does, and waits to be killed.
SEARCH = f"""
import json, sys, time
from websockets.sync.client import connect
with connect(sys.argv[1], max_size=None) as page:
    page.send(json.dumps({{"type": "request", "seq": 1, "operation": "set_gains", "target": "wheel",
                          "values": json.loads(sys.argv[2]),
                          "sent_us": time.monotonic_ns() // 1000}}))
    while True:
        data = page.recv(timeout={PATIENCE_S})
        told = {{}} if isinstance(data, bytes) else json.loads(data)
        if told.get("type") == "response":
            print(told["status"], flush=True)
"""


def kp(robot: Daemon) -> float:
    found: float = json.loads(robot.must("gains", "wheel", "--json"))["gains"][KP]
    return found


@pytest.mark.parametrize("victim", ["browser", "server"])
def test_what_is_killed_while_it_tries_gains_leaves_those_of_before(
    web: Web, robot: Daemon, victim: str
) -> None:
    before = kp(robot)
    url = f"ws://127.0.0.1:{web.port}/link"
    tried = json.dumps({KP: 2 * before, "restore_at_end": 1})
    with Program(sys.executable, "-c", SEARCH, url, tried, env=robot.env) as browser:
        browser.wait_line("ok")
        assert kp(robot) == 2 * before
        (browser if victim == "browser" else web.program).signal(signal.SIGKILL)
        eventually(lambda: kp(robot) == before, "the gains of before")


def test_a_wrong_value_is_refused_in_words(web: Web, robot: Daemon) -> None:
    with web.page() as page:
        refused = page.ask("enable", "wheel", disable_at_end=2)
        assert refused["status"] == "refused"
        assert "disable_at_end: use 1" in refused["message"]
    assert robot.state()["motors"][0]["status"] == "READY"


def test_a_hold_that_was_silent_is_over_and_another_one_begins(web: Web, robot: Daemon) -> None:
    robot.must("enable", "wheel")
    with web.page() as page:
        holds = itertools.count(1000)

        def moves(hold: int) -> bool:
            page.send(**JOG, seq=hold, sent_us=now_us())
            return any(motor["owner"] != "" for motor in robot.state()["motors"])

        eventually(lambda: moves(next(holds)), "it moves")
        silent = next(holds) - 1
        last_us = now_us()
        eventually(lambda: now_us() - last_us > 600_000, "a silence")
        assert not moves(silent)
        assert "for 500 ms: let go, and press again" in page.wait("response")["message"]
        assert not moves(silent)
        eventually(lambda: moves(next(holds)), "it moves again")
