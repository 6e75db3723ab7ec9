#!/usr/bin/python3
"""Checks what the layers of src/ include: see "Layers" in ARCHITECTURE.md.

The build already gives each layer only the include roots it may use; this holds the order itself,
which the build file could change, and what no include root can forbid.

    check_layers.py SRC      prints the violations; exit status 1 if there are any
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

USES = {
    "app": set[str](),
    "bus": {"app"},
    "motor": {"bus", "app"},
    "module": {"motor", "bus", "app"},
    "sim": {"motor", "bus", "app"},
    "drives": {"sim", "motor", "bus", "app"},
    "config": {"drives", "sim", "module", "motor", "bus", "app"},
    "survey": {"drives", "motor", "bus", "app"},
    "link": {"app"},
    "blackbox": {"link", "app"},
    "client": {"blackbox", "link", "app"},
    "doctor": {"client", "link", "bus", "app"},
    "gateway": {"client", "link", "app"},
    "daemon": {"blackbox", "config", "drives", "sim", "module", "motor", "bus", "link", "app"},
    "robot_client": {"app"},
    "tools": {"doctor", "survey", "client", "drives", "motor", "blackbox", "config", "link"}
    | {"sim", "bus", "app"},
}

# Sub-folders, and what else of their layer they may include. "": headers of the folder itself.
ROOMS = {
    "motor": {"guarding": {""}},
    "config": {
        "yaml": {""},
        "keys": {"", "yaml"},
        "check": {"", "keys", "yaml"},
        "build": {"", "check", "keys", "yaml"},
        "report": {"", "check", "keys", "yaml"},
    },
    "daemon": {
        "exchange": set[str](),
        "devices": {"exchange"},
        "recording": {"devices", "exchange"},
        "supervision": {"recording", "devices", "exchange"},
        "tick": {"supervision", "recording", "devices", "exchange"},
        "interfaces": {"devices", "exchange"},
        "clients": {"exchange"},
        "threads": {"interfaces", "tick", "recording", "devices", "exchange"},
    },
}
# Families of drives know what all have in common, and no other family.
FAMILIES = "drives"

# Plain objects: no threads, locks, atomics or logging; who uses them decides about those.
PLAIN = ("app", "bus", "motor", "drives", "module")
NOT_IN_PLAIN = re.compile(
    r"^(atomic|barrier|condition_variable|future|iostream|latch|mutex|semaphore|shared_mutex"
    r"|stop_token|thread|pthread\.h|semaphore\.h|spdlog/.*|boost/lockfree/.*)$"
)

# Time is an argument below the daemon.
TIMELESS = (*PLAIN, "sim", "drives", "config")
CLOCK = re.compile(
    r"_clock::now\b|\b(clock_gettime|clock_nanosleep|gettimeofday|nanosleep|usleep|sleep_for)\s*\(|\btime\(nullptr\)"
)

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
LINE_COMMENT = re.compile(r"//.*")


class Violation(NamedTuple):
    file: Path
    line: int
    what: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.what}"


def bad_include(layer: str, quote: str, name: str) -> str | None:
    """Says what is wrong with one include of a file of `layer`."""
    if ".." in Path(name).parts:
        return f'"{name}": includes name the layer, as in "motor/motor_base.hpp"'
    if layer in PLAIN and NOT_IN_PLAIN.match(name):
        return f"<{name}>: no threads, locks, atomics or logging in {layer}/"
    used = Path(name).parts[0]
    if quote == '"' and used in USES and used != layer and used not in USES[layer]:
        allowed = ", ".join(sorted(USES[layer])) or "nothing"
        return f'"{name}": {layer}/ may use {allowed}'
    return None


def bad_room(layer: str, room: str, name: str) -> str | None:
    """Says what is wrong with an include by a file in a sub-folder."""
    parts = Path(name).parts
    used = parts[1] if len(parts) > 2 else ""
    if parts[0] != layer or not room or used == room:
        return None
    if layer == FAMILIES and used:
        return f'"{name}": a family of drives knows no other'
    allowed = ROOMS.get(layer, {}).get(room, {""})
    if used in allowed:
        return None
    names = ", ".join(f"{layer}/{name}".rstrip("/") for name in sorted(allowed)) or "nothing"
    return f'"{name}": of its layer {layer}/{room}/ may use {names}'


def violations_in(file: Path, layer: str, room: str) -> Iterator[Violation]:
    for number, text in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        if include := INCLUDE.match(text):
            what = bad_include(layer, include[1], include[2])
            if what is None and include[1] == '"':
                what = bad_room(layer, room, include[2])
            if what is not None:
                yield Violation(file, number, what)
        elif layer in TIMELESS and (clock := CLOCK.search(LINE_COMMENT.sub("", text))):
            yield Violation(file, number, f"{clock[0]}: {layer}/ gets the time as an argument")


def violations(src: Path) -> Iterator[Violation]:
    for file in sorted([*src.rglob("*.hpp"), *src.rglob("*.cpp")]):
        layer, *rooms = file.relative_to(src).parts[:-1] or [file.name]
        if layer not in USES:
            yield Violation(file, 1, f"{layer}/ is no layer")
            continue
        room = rooms[0] if rooms else ""
        if room and layer in ROOMS and room not in ROOMS[layer]:
            yield Violation(file, 1, f"{layer}/{room}/ is no room of {layer}/")
        yield from violations_in(file, layer, room)


def main() -> int:
    found = list(violations(Path(sys.argv[1])))
    for violation in found:
        print(violation)
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
