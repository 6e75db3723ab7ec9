"""A motor that a page has enabled alone, and the end of that page."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from test_web import Web

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from hostlib import Daemon


@pytest.fixture
def web(daemon: Daemon, tmp_path: Path) -> Iterator[Web]:
    server = Web(daemon, tmp_path)
    with server.program:
        yield server


def status(daemon: Daemon, motor: str, wanted: str) -> None:
    daemon.wait_motor(motor, lambda m: m["status"] == wanted, wanted)


def test_its_motor_is_let_go_when_its_page_is_gone(web: Web, daemon: Daemon) -> None:
    with web.page() as page:
        assert page.ask("enable_alone", "wheel", disable_at_end=1)["status"] == "ok"
        # That of another motor ends nothing of it.
        assert page.ask("disable", "other")["status"] == "ok"
        status(daemon, "wheel", "ACTIVE")
    status(daemon, "wheel", "READY")
    daemon.must("enable", "other")


@pytest.mark.parametrize("end", ["refused", "disabled", "disabled by another"])
def test_one_that_it_does_not_have_any_more_is_left_alone(
    web: Web, daemon: Daemon, end: str
) -> None:
    if end == "refused":
        daemon.must("enable", "other")
    with web.page() as page:
        page.wait("state")
        answer = page.ask("enable_alone", "wheel", disable_at_end=1)
        assert (answer["status"] != "ok") == (end == "refused")
        if end == "disabled":
            page.ask("disable")
        if end == "disabled by another":
            page.wait("state", lambda s: s["data"]["motors"][0]["status"] == "ACTIVE")
            daemon.must("disable", "wheel")
            page.wait("state", lambda s: s["data"]["motors"][0]["status"] == "READY")
        daemon.must("enable", "wheel")
    # Its end has been carried out when that of the next one is.
    with web.page() as next_page:
        assert next_page.ask("enable", "yaw", disable_at_end=1)["status"] == "ok"
    status(daemon, "yaw", "READY")
    status(daemon, "wheel", "ACTIVE")
