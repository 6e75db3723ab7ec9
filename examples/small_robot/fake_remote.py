"""A DJI remote and its receiver, played on a pseudo terminal, to try small_robot without hardware.

    python fake_remote.py [PATH]       PATH: the `port` of the module `remote`

Type: `up` and `down` move the arm switch (the left one), `off` and `on` are the remote's power,
`right_y=0.5` holds a stick there (right_x, right_y, left_x, left_y, wheel; -1 to 1).
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
CENTRE, FULL = 1024, 660
UP, DOWN, MIDDLE = 1, 2, 3


def frame(left_switch: int, sticks: dict[str, float]) -> bytes:
    """The 18 bytes of DBUS: no mouse, no keys."""
    right_x, right_y, left_x, left_y, wheel = (
        CENTRE + round(FULL * value) for value in sticks.values()
    )
    bits = right_x | right_y << 11 | left_x << 22 | left_y << 33
    bits |= MIDDLE << 44 | left_switch << 46
    return bits.to_bytes(6, "little") + bytes(10) + wheel.to_bytes(2, "little")


def move(sticks: dict[str, float], word: str) -> bool:
    """Puts a stick where `right_y=0.5` says; False: it says something else."""
    name, _, number = word.partition("=")
    try:
        value = float(number)
    except ValueError:
        return False
    if name not in sticks or not -1 <= value <= 1:
        return False
    sticks[name] = value
    return True


def play(path: Path) -> None:
    """Sends frames until the standard input ends."""
    master, slave = os.openpty()
    tty.setraw(slave)  # no echo
    os.set_blocking(master, False)
    path.unlink(missing_ok=True)
    path.symlink_to(os.ttyname(slave))
    print(f"{path} is {os.ttyname(slave)}; type up, down, off, on or right_y=0.5", flush=True)
    switch, powered = DOWN, True
    sticks = dict.fromkeys(("right_x", "right_y", "left_x", "left_y", "wheel"), 0.0)
    words = selectors.DefaultSelector()
    words.register(sys.stdin, selectors.EVENT_READ)
    next_s = time.monotonic()
    try:
        while True:
            next_s = max(next_s + PERIOD_S, time.monotonic())
            if powered:
                # Bytes that nobody reads are lost, as on a wire.
                with contextlib.suppress(BlockingIOError):
                    os.write(master, frame(switch, sticks))
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
                        case _ if not move(sticks, word):
                            known = f"up, down, off, on, and {', '.join(sticks)}=-1 to 1"
                            print(f"{word!r} is unknown; there are {known}", flush=True)
    finally:
        path.unlink(missing_ok=True)


if __name__ == "__main__":
    with contextlib.suppress(KeyboardInterrupt):
        play(Path(sys.argv[1] if len(sys.argv) > 1 else "/tmp/small_robot_remote"))
