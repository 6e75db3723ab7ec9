"""Requests of a page that come late, over a stalled connection: only those that stop count."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any

from test_web import Page, Web

if TYPE_CHECKING:
    from pathlib import Path

    from hostlib import Daemon


def ask(page: Page, operation: str, late_s: float) -> dict[str, Any]:
    page.seq += 1
    seq = page.seq
    sent_us = time.monotonic_ns() // 1000 - int(late_s * 1e6)
    words = {"operation": operation, "target": "", "values": {}}
    page.send(type="request", seq=seq, sent_us=sent_us, **words)
    return page.wait("response", lambda answer: answer["seq"] == seq)


def test_a_request_that_was_held_up_on_its_way_does_nothing(daemon: Daemon, tmp_path: Path) -> None:
    web = Web(daemon, tmp_path)
    with web.program, web.page() as page:
        daemon.must("estop")
        page.send(type="clock", sent_us=time.monotonic_ns() // 1000)
        for operation in ("clear", "enable"):
            told = ask(page, operation, late_s=3)
            assert told["status"] == "refused"
            assert "the connection was held up, and it was not done: ask again" in told["message"]
        assert daemon.state()["state"] == "ESTOP"
        assert ask(page, "clear", late_s=0)["status"] == "ok"
        for operation in ("disable", "estop"):
            assert ask(page, operation, late_s=3)["status"] == "ok"
        assert daemon.state()["state"] == "ESTOP"


def test_a_request_that_waited_for_an_rc10d_that_stood_still_does_nothing(
    daemon: Daemon, tmp_path: Path
) -> None:
    web = Web(daemon, tmp_path)
    with web.program, web.page() as page:
        assert page.ask("disable", "wheel")["status"] == "ok"
        daemon.must("estop")
        with daemon.program.stopped():
            told = page.ask("clear")
        assert (told["status"], told["message"]) == ("failed", "rc10d does not answer")
        # Behind it, on the same connection.
        assert page.ask("disable", "wheel")["status"] == "ok"
        assert daemon.state()["state"] == "ESTOP"
        assert page.ask("clear")["status"] == "ok"
