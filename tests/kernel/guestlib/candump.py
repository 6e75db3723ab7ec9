"""A recording of one or more CAN interfaces."""

from __future__ import annotations

import os
import re
import subprocess
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, Self

from guestlib.process import wait_for

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

# Room for some thousand frames between two runs of candump.
RECEIVE_BUFFER_BYTES = 32 << 20
CAN_ERR_FLAG = 0x20000000

# In virtual time candump empties its socket before the clock moves; emulated machines are slow.
SETTLE_S = 0.005 if os.environ.get("RC10_GUEST") == "kernel" else 0.5

_LINE = re.compile(
    r"\((?P<s>\d+)\.(?P<us>\d{6})\) (?P<iface>\S+) (?P<id>[0-9A-F]+)#"
    r"(?P<fd>#[0-9A-F])?(?P<rtr>R[0-9]?)?(?P<data>[0-9A-F]*)"
)


class Frame(NamedTuple):
    t_ns: int  # CLOCK_REALTIME, in steps of 1 us
    iface: str
    id: int  # of an error frame: the error class bits
    ext: bool
    data: bytes
    fd: bool = False
    rtr: bool = False
    error: bool = False


def parse_line(line: str) -> Frame:
    match = _LINE.fullmatch(line)
    if match is None:
        # candump also reports here that it lost frames.
        raise RuntimeError(f"candump: {line}")
    number = int(match["id"], 16)
    error = bool(number & CAN_ERR_FLAG)
    return Frame(
        t_ns=int(match["s"]) * 1_000_000_000 + int(match["us"]) * 1000,
        iface=match["iface"],
        id=number & ~CAN_ERR_FLAG,
        ext=len(match["id"]) == 8 and not error,
        data=bytes.fromhex(match["data"]),
        fd=match["fd"] is not None,
        rtr=match["rtr"] is not None,
        error=error,
    )


# candump's message for an interface that goes down.
_DOWN = re.compile(
    r"read: (Network is down|No such device)|\S+: interface down|\S+: Network is down"
)


def _listeners(iface: str) -> int:
    # The kernel keeps filters for one id apart from the others.
    lists = Path("/proc/net/can").glob("rcvlist_*")
    lines = [line for text in lists for line in text.read_text().splitlines()]
    return sum(line.split()[:1] == [iface] for line in lines)


class Candump:
    """Records every frame, error frames included, from the moment `with` is entered.

    >>> with Candump("vcan0") as bus:
    ...     run("cansend", "vcan0", "201#00")
    >>> bus.frames()[0].id
    513
    """

    def __init__(self, *ifaces: str, ids: Sequence[int] = ()) -> None:
        """Record everything, or only the given standard ids."""
        self._ifaces = ifaces
        only = [f"{number:X}:C00007FF" for number in ids]
        self._filters = ",".join([*(only or ["0:0"]), "#FFFFFFFF"])
        self._frames: list[Frame] = []
        self._tail = ""
        self._process: subprocess.Popen[bytes] | None = None
        # A file: Python reads it when the test asks, not at every frame.
        handle, name = tempfile.mkstemp(prefix="candump-", suffix=".log", dir="/tmp")
        os.close(handle)
        self._log = Path(name)
        self._reader = self._log.open()

    def __enter__(self) -> Self:
        before = {iface: _listeners(iface) for iface in self._ifaces}
        # -D: an interface that goes down may come back.
        command = ["candump", "-L", "-D", "-d", "-r", str(RECEIVE_BUFFER_BYTES)]
        command += [f"{iface},{self._filters}" for iface in self._ifaces]
        with self._log.open("ab") as log:
            self._process = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)

        def listens() -> bool:
            if self._process is None or self._process.poll() is not None:
                raise RuntimeError(f"candump ended: {self._log.read_text()}")
            return all(_listeners(iface) > count for iface, count in before.items())

        wait_for(listens, 10.0, "candump listening")
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self) -> None:
        """Stop after candump has written all that is in its socket."""
        if self._process is None or self._process.poll() is not None:
            return
        # Frames that are on the bus now are in the file after this; the bus may go on.
        time.sleep(SETTLE_S)
        self._process.terminate()
        self._process.wait(5.0)

    def frames(self) -> list[Frame]:
        """All frames so far."""
        *lines, self._tail = (self._tail + self._reader.read()).split("\n")
        self._frames += [parse_line(line) for line in lines if not _DOWN.fullmatch(line)]
        return list(self._frames)

    def wait_frame(self, wanted: Callable[[Frame], bool], timeout_s: float = 5.0) -> Frame:
        """Return the first recorded frame that is wanted, waiting for it if need be."""
        return wait_for(
            lambda: next((frame for frame in self.frames() if wanted(frame)), None),
            timeout_s,
            "a wanted frame",
        )
