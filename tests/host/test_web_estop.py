"""A page whose robot does not answer: its e-stop gets in, each of its requests has an answer."""

from __future__ import annotations

import contextlib
import json
import signal
from typing import TYPE_CHECKING

import pytest
from hostlib.program import eventually
from test_web import Web, open_and_never_read

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from hostlib import Daemon

# More than rc10d has.
SEATS = 20


@pytest.fixture
def web(daemon: Daemon, tmp_path: Path) -> Iterator[Web]:
    server = Web(daemon, tmp_path)
    with server.program:
        yield server


def test_an_estop_of_a_page_gets_in_when_every_seat_at_rc10d_is_taken(
    web: Web, daemon: Daemon
) -> None:
    daemon.must("enable")
    # A page takes a seat when it first asks for something.
    ask = {"type": "request", "seq": 1, "operation": "disable", "target": "yaw", "client": "x" * 99}
    with web.page() as page, contextlib.ExitStack() as others:
        name = page.wait("hello")["name"]
        for _ in range(SEATS):
            others.enter_context(open_and_never_read(web.port, json.dumps(ask)))
        eventually(lambda: daemon.ctl("list").returncode != 0, "every seat is taken")
        told = page.ask("estop")
        assert told["status"] == "failed"
        assert told["message"].startswith("the e-stop was sent and is not confirmed: ")
        stopped = page.wait("state", lambda state: state["data"]["state"] == "ESTOP")
        assert stopped["data"]["stopped_by"] == name


def test_an_estop_of_a_page_gets_in_while_rc10d_answers_nobody(web: Web, daemon: Daemon) -> None:
    daemon.must("enable")
    with web.page() as page:
        page.wait("state")
        with daemon.program.stopped():
            told = page.ask("estop")
        assert told["message"].startswith("the e-stop was sent and is not confirmed: ")
        page.wait("state", lambda state: state["data"]["state"] == "ESTOP")


def test_a_page_that_has_asked_before_hears_that_rc10d_does_not_answer(
    web: Web, daemon: Daemon
) -> None:
    with web.page() as page:
        assert page.ask("enable", "wheel")["status"] == "ok"
        with daemon.program.stopped():
            told = page.ask("estop")
        assert told["status"] == "failed"
        assert told["message"] == (
            "the e-stop was sent and is not confirmed: rc10d does not answer"
        )
        page.wait("state", lambda state: state["data"]["state"] == "ESTOP")


def test_a_request_that_dies_with_rc10d_has_failed(web: Web, daemon: Daemon) -> None:
    with web.page() as page:
        assert page.ask("enable", "wheel")["status"] == "ok"
        daemon.program.signal(signal.SIGSTOP)
        page.send(type="request", seq=77, operation="disable", target="wheel", values={})
        # The page's own connection serves one message after the other.
        page.send(type="recordings", seq=78)
        page.wait("recordings")
        daemon.kill()
        told = page.wait("response", lambda answer: answer["seq"] == 77)
        assert (told["status"], told["message"]) == (
            "failed",
            "the connection to rc10d ended before the answer",
        )
