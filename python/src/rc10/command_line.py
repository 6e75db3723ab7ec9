"""Options and helpers of this package's command line tools."""

from __future__ import annotations

import errno
import os
import re
import signal
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from rc10.errors import Rc10Error, Timeout
from rc10.link import MULTICAST_GROUP, ROUTE_COMMAND, LcmLink
from rc10.printable import printable
from rc10.signals import SIGNALS

if TYPE_CHECKING:
    import argparse
    from typing import Callable, NoReturn

# State messages come at least ten times a second.
_HEARD_WITHIN_S = 3.0
_OTHERS_WITHIN_S = 0.15

_STATE = re.compile(r"(?P<robot>[\w.-]+)\.v1\.state")


def add_robot_arguments(parser: argparse.ArgumentParser) -> None:
    """Adds how the robot is found."""
    parser.add_argument(
        "--robot", help="robot: in the daemon's configuration (default: the only one that is heard)"
    )
    parser.add_argument("--url", help="an LCM provider (default: $LCM_DEFAULT_URL or LCM's)")


def add_signals_argument(parser: argparse.ArgumentParser, count: str, more: str) -> None:
    """Adds the signals that are wanted."""
    parser.add_argument(
        "signals",
        nargs=count,
        metavar="SIGNAL",
        help=f"motor.signal, as wheel.velocity_rpm{more}. The signals: {', '.join(SIGNALS)}",
    )


def check_writable(path: str) -> None:
    """Refuses a file that cannot be written, before anything is done that it is for.

    Raises:
        OSError: with the reason. The file is left as it is, and is not made.
    """
    file = Path(path)
    if file.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), path)
    if not file.parent.is_dir():
        raise FileNotFoundError(
            errno.ENOENT, "there is no such folder to write to", str(file.parent)
        )
    if not os.access(file if file.exists() else file.parent, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), path)


def find_robot(name: str | None, url: str | None) -> str:
    """Returns `name`, or else the name of the only robot that is heard.

    Raises:
        Timeout: none is heard; the message says what to check.
        Rc10Error: several are.
        LinkError: LCM could not start.
    """
    if name is not None:
        return name
    heard: set[str] = set()

    def hear(channel: str, _: bytes) -> None:
        if match := _STATE.fullmatch(channel):
            heard.add(match["robot"])

    link = LcmLink(url)
    try:
        link.lcm.subscribe(r".*\.v1\.state", hear)
        first_by_s = time.monotonic() + _HEARD_WITHIN_S
        while not heard and (left_s := first_by_s - time.monotonic()) > 0:
            link.pump(left_s)
        others_by_s = time.monotonic() + _OTHERS_WITHIN_S
        while heard and (left_s := others_by_s - time.monotonic()) > 0:
            link.pump(left_s)
    finally:
        link.close()
    if not heard:
        raise Timeout(
            f"no robot is heard within {_HEARD_WITHIN_S:g} s. Check: is rc10d running? Does "
            f"multicast stay on this computer: 'ip route get {MULTICAST_GROUP}' must say "
            f"'dev lo', else run: {ROUTE_COMMAND}"
        )
    if len(heard) > 1:
        raise Rc10Error(
            f"several robots are heard: {', '.join(sorted(heard))}: say which with --robot"
        )
    return heard.pop()


def run(name: str, main: Callable[[], int | None]) -> NoReturn:
    """Runs a tool and ends the program: 0 done, 1 an error in words, 130 interrupted.

    SIGTERM, and the end of its terminal, interrupt it as Ctrl-C does, so that motors are let go.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    signal.signal(signal.SIGHUP, signal.default_int_handler)
    try:
        sys.exit(main() or 0)
    except (Rc10Error, OSError) as error:
        print(f"{name}: {printable(error)}", file=sys.stderr)
        sys.exit(1)
    except KeyboardInterrupt:
        print(f"{name}: interrupted", file=sys.stderr)
        sys.exit(130)
