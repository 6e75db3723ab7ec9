"""An e-stop gets in however busy or full rc10d is."""

from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from hostlib import Daemon

SEATS = 16


def test_it_gets_in_when_every_seat_is_taken(daemon: Daemon) -> None:
    daemon.must("enable")
    with ExitStack() as watchers:
        for _ in range(SEATS):
            watch = daemon.drive("watch", "--json", "--hz", "1")
            watchers.enter_context(watch)
            watch.wait_line(r"^\{|no free|rc10ctl: ")
        assert daemon.ctl("list").returncode != 0, "there was a seat left"
        stopped = daemon.ctl("estop")
        assert stopped.returncode != 0
        assert "the e-stop was sent and is not confirmed: " in stopped.stderr
        daemon.program.wait_line(r"robot: RUN -> ESTOP \(asked for by 'rc10ctl'\)")


def test_it_is_answered_and_comes_once(daemon: Daemon) -> None:
    daemon.must("enable")
    daemon.must("estop")
    daemon.must("clear")
    text = daemon.program.output
    assert text.count("RUN -> ESTOP") == 1
    assert daemon.state()["state"] == "RUN"
