"""Set-up of a CAN controller by somebody other than rc10d, and a look at it."""

from __future__ import annotations

import contextlib
import os
import signal
from pathlib import Path
from typing import TYPE_CHECKING

from guestlib import run

if TYPE_CHECKING:
    from collections.abc import Iterator

    from guestlib import Proc


def set_link(iface: str, settings: str, *, unseen_by: Proc | None = None) -> None:
    """Changes a controller's settings, for which it is down a moment.

    The process rests meanwhile: rc10d brings up what it sees down, with the settings of its own.
    """
    batch = Path("/tmp/set-link")
    batch.write_text(
        f"link set {iface} down\nlink set {iface} type can {settings}\nlink set {iface} up\n"
    )
    with resting(unseen_by) if unseen_by else contextlib.nullcontext():
        run("ip", "-batch", batch)


@contextlib.contextmanager
def resting(process: Proc) -> Iterator[None]:
    """None of its threads runs."""
    process.signal(signal.SIGSTOP)
    os.waitid(os.P_PID, process.pid, os.WSTOPPED)
    try:
        yield
    finally:
        process.signal(signal.SIGCONT)


def link_details(iface: str) -> str:
    return run("ip", "-details", "link", "show", iface)
