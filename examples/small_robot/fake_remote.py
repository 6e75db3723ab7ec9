"""A DJI remote and its receiver, played on a pseudo terminal, to try small_robot without hardware.

    python fake_remote.py [PATH]       PATH: the `port` of the module `remote`

Type: `up` and `down` move the arm switch (the left one), `off` and `on` are the remote's power.
"""

from __future__ import annotations

import contextlib
import os
import selectors
import sys
import time
import tty
from pathlib import Path

PERIOD_S = 0.014  # period of a DR16
CENTRE = 1024
UP, DOWN, MIDDLE = 1, 2, 3


def frame(left_switch: int) -> bytes:
    """The 18 bytes of DBUS: sticks and wheel in the middle, no mouse, no keys."""
    bits = 0
    for channel in range(4):
        bits |= CENTRE << (11 * channel)
    bits |= MIDDLE << 44 | left_switch << 46
    return bits.to_bytes(6, "little") + bytes(10) + CENTRE.to_bytes(2, "little")


def play(path: Path) -> None:
    """Sends frames until the standard input ends."""
    master, slave = os.openpty()
    tty.setraw(slave)  # no echo
    os.set_blocking(master, False)
    path.unlink(missing_ok=True)
    path.symlink_to(os.ttyname(slave))
    print(f"{path} is {os.ttyname(slave)}; type up, down, off or on", flush=True)
    switch, powered = DOWN, True
    words = selectors.DefaultSelector()
    words.register(sys.stdin, selectors.EVENT_READ)
    next_s = time.monotonic()
    try:
        while True:
            next_s = max(next_s + PERIOD_S, time.monotonic())
            if powered:
                # Bytes that nobody reads are lost, as on a wire.
                with contextlib.suppress(BlockingIOError):
                    os.write(master, frame(switch))
            while (left_s := next_s - time.monotonic()) > 0:
                if not words.select(left_s):
                    break
                typed = os.read(sys.stdin.fileno(), 4096)
                if not typed:
                    return
                for word in typed.decode().split():
                    match word:
                        case "up":
                            switch = UP
                        case "down":
                            switch = DOWN
                        case "off":
                            powered = False
                        case "on":
                            powered = True
                        case _:
                            print(f"{word!r} is neither up, down, off nor on", flush=True)
    finally:
        path.unlink(missing_ok=True)


if __name__ == "__main__":
    with contextlib.suppress(KeyboardInterrupt):
        play(Path(sys.argv[1] if len(sys.argv) > 1 else "/tmp/small_robot_remote"))
