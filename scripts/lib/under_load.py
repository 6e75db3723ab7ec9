#!/usr/bin/python3
"""Runs a command as on a busy machine: all cores have other work, and now and then it stands still.

It is stopped with all its descendants. Of a pause they notice nothing but the time, and that some
system calls are interrupted (signal(7): "Interruption of system calls and library functions by stop
signals"). It ends with the command's status.
"""

from __future__ import annotations

import argparse
import contextlib
import multiprocessing
import os
import random
import re
import signal
import subprocess
import sys
import zlib
from pathlib import Path

from descendants import descendants, keep_orphans, processes, send

LOOKS = 20
STOPPED = "Tt"  # by somebody else: a debugger, or a test whose subject that is


def hog(parent: int) -> None:
    """Works the core and the memory, as a compiler does."""
    text = os.urandom(1 << 20)
    while os.getppid() == parent:
        zlib.compress(text)


def running(spared: frozenset[int]) -> set[int]:
    """Every descendant that nobody has stopped, also those in sessions of their own."""
    return {
        pid
        for pid, process in descendants(spared).items()
        if process.state not in STOPPED and not traced(pid)
    }


def traced(pid: int) -> bool:
    """A User-Mode Linux traces its processes, and takes a SIGSTOP for one of theirs."""
    try:
        status = Path(f"/proc/{pid}/status").read_text(errors="replace")
    except OSError:
        return True  # ended
    return "TracerPid:\t0\n" not in status


def stands(pid: int) -> bool:
    """It has been stopped, though it may have had no time yet to do so, or has ended."""
    try:
        status = Path(f"/proc/{pid}/status").read_text(errors="replace")
    except OSError:
        return True
    state = re.search(r"^State:\t(.)", status, re.MULTILINE)
    pending = re.search(r"^ShdPnd:\t([0-9a-f]+)", status, re.MULTILINE)
    if state is None or pending is None or state[1] not in "RSD":
        return True
    return bool(int(pending[1], 16) & 1 << (signal.SIGSTOP - 1))


def stop_parents_first(tree: set[int], stopped: set[int]) -> None:
    """Adds to `stopped` those that it stops: not whom a parent had stopped at the last moment."""
    parents = {pid: process.parent for pid, process in processes().items()}
    while tree:
        eldest = {pid for pid in tree if parents.get(pid) not in tree}
        mine = eldest
        # For a moment one that is about to stop has no signal pending any more, and runs yet.
        for _ in range(LOOKS):
            mine = {pid for pid in mine if not stands(pid)}
            os.sched_yield()
        stopped |= mine
        send(signal.SIGSTOP, mine)
        tree = tree - eldest


def pause(seconds: float, spared: frozenset[int], command: subprocess.Popen[bytes]) -> None:
    seen: set[int] = set()
    stopped: set[int] = set()
    try:
        # Until there is nobody left: whoever runs may start another.
        while new := running(spared) - seen:
            stop_parents_first(new, stopped)
            seen |= new
        with contextlib.suppress(subprocess.TimeoutExpired):
            command.wait(seconds)
    finally:
        send(signal.SIGCONT, stopped)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], allow_abbrev=False)
    parser.add_argument(
        "--stop-ms", type=float, default=30.0, help="how long a pause is (default %(default)g)"
    )
    parser.add_argument(
        "--every-ms",
        type=float,
        default=600.0,
        help="between two, on average (default %(default)g)",
    )
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(1_000_000))
    parser.add_argument(
        "--hogs",
        type=int,
        default=len(os.sched_getaffinity(0)),
        help="busy processes (default: one a core)",
    )
    parser.add_argument("command", nargs=argparse.REMAINDER)
    options = parser.parse_args()
    if not options.command:
        parser.error("which command?")
    print(f"under_load: --seed {options.seed}", flush=True)
    chance = random.Random(options.seed)
    keep_orphans()
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    hogs = [
        multiprocessing.Process(target=hog, args=(os.getpid(),), daemon=True)
        for _ in range(options.hogs)
    ]
    for one in hogs:
        one.start()
    # After the hogs, which end by it at once, however early it comes.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    if signal.getsignal(signal.SIGHUP) is not signal.SIG_IGN:  # by nohup
        signal.signal(signal.SIGHUP, signal.default_int_handler)
    spared = frozenset(one.pid for one in hogs if one.pid is not None)
    command = subprocess.Popen(options.command, start_new_session=True)
    pauses = 0
    try:
        while True:
            try:
                status = command.wait(options.every_ms / 1000 * chance.uniform(0.5, 1.5))
                break
            except subprocess.TimeoutExpired:
                pause(options.stop_ms / 1000, spared, command)
                pauses += 1
    finally:
        send(signal.SIGTERM, running(spared))
    print(
        f"under_load: {pauses} pauses of {options.stop_ms:g} ms, --seed {options.seed}", flush=True
    )
    return status if status >= 0 else 128 - status


if __name__ == "__main__":
    sys.exit(main())
