"""Processes that this program has started, and those that they have, whatever their session.

Python of Debian 12 alone.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import select
import signal
import time
from pathlib import Path
from typing import NamedTuple

PR_SET_CHILD_SUBREAPER = 36


class Process(NamedTuple):
    parent: int
    state: str


def keep_orphans() -> None:
    """An orphan stays a descendant."""
    ctypes.CDLL(None).prctl(PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def reap_orphans(own: set[int]) -> None:
    """Those that have ended, up to one of its own children."""
    with contextlib.suppress(ChildProcessError):
        while ended := os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT):
            if ended.si_pid in own:
                break
            os.waitpid(ended.si_pid, 0)


def processes() -> dict[int, Process]:
    found = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text(errors="replace").rpartition(")")[2].split()
        except OSError:
            continue  # ended
        found[int(stat.parent.name)] = Process(parent=int(fields[1]), state=fields[0])
    return found


def descendants(spared: frozenset[int] = frozenset()) -> dict[int, Process]:
    """All but the spared and theirs."""
    everything = processes()
    tree: dict[int, Process] = {}
    new = {os.getpid()}
    while new:
        new = {pid for pid, p in everything.items() if p.parent in new} - spared
        tree |= {pid: everything[pid] for pid in new}
    return tree


def send(number: signal.Signals, pids: set[int]) -> None:
    for pid in pids:
        with contextlib.suppress(ProcessLookupError, PermissionError):  # ended, or root's
            os.kill(pid, number)


def end_descendants(grace_s: float = 5.0) -> None:
    """Ends all of them, by force those that are there after this time.

    A process that one of them starts then is its clean-up, and is asked for nothing.
    """
    deadline = time.monotonic() + grace_s
    asked = False
    while living := {pid for pid, p in descendants().items() if p.state not in "ZX"}:
        left_s = deadline - time.monotonic()
        if left_s <= 0:
            send(signal.SIGKILL, living)
        elif not asked:
            send(signal.SIGTERM, living)
        asked = True
        wait_for_an_end(living, left_s if left_s > 0 else None)


def wait_for_an_end(pids: set[int], timeout_s: float | None) -> None:
    """Returns when one of them has ended, or after so long."""
    with contextlib.ExitStack() as open_ones:
        ends = select.poll()
        for pid in pids:
            try:
                end = os.pidfd_open(pid)
            except ProcessLookupError:
                return  # it has ended
            open_ones.callback(os.close, end)
            ends.register(end, select.POLLIN)
        ends.poll(None if timeout_s is None else timeout_s * 1000)
