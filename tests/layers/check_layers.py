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
    "survey": {"drives", "motor", "bus", "link", "app"},
    "link": {"app"},
    "blackbox": {"link", "app"},
    "client": {"blackbox", "link", "app"},
    "doctor": {"client", "link", "bus", "app"},
    "guard": {"link", "bus", "app"},
    "robot_file": {"client", "config", "link", "app"},
    "sandbox": {"app"},
    "gateway": {"sandbox", "client", "link", "app"},
    "web": {"sandbox", "survey", "client", "config", "blackbox", "link", "bus", "app"},
    "daemon": {"blackbox", "survey", "config", "sim", "module", "motor", "bus", "link", "app"},
    "robot_client": {"app"},
    "tools": {
        "guard",
        "robot_file",
        "web",
        "doctor",
        "survey",
        "client",
        "drives",
        "motor",
        "blackbox",
        "config",
        "link",
    }
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
    "client": {"motion": {""}},
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
    "robot_client": {"rc10": set[str](), "session": {""}},
    "tools": {
        program: {""}
        for program in ("rc10-config", "rc10-guard", "rc10-irq", "rc10-stop", "rc10-web", "rc10ctl")
    },
}
# Headers of a layer's own folder that stand above its rooms: they include rooms, and no room them.
ABOVE_ROOMS = {"config/load_config.hpp"}
# Families of drives know what all have in common, and no other family. A simulated drive and a
# recogniser see no motor, and a motor neither of them.
FAMILIES = "drives"
SIMULATED = re.compile(r"_(simulated|recogniser|wording)")
OF_SIMULATED = re.compile(
    r"_(simulated\w*|recogniser|wording|frames|model|family)\.hpp$|/(recogniser|wording)\.hpp$"
)

# These ask the family, through drives/families.hpp, and know none by its name; the texts of keys,
# which people read, may.
BLIND = ("config", "survey")
SEEING = ("config/keys/",)

# Plain objects: no threads, locks, atomics or logging; who uses them decides about those.
PLAIN = ("app", "bus", "motor", "drives", "module")
NOT_IN_PLAIN = re.compile(
    r"^(atomic|barrier|condition_variable|future|iostream|latch|mutex|semaphore|shared_mutex"
    r"|stop_token|thread|(pthread|semaphore|stdatomic|syslog|threads)\.h|spdlog/.*"
    r"|boost/(atomic|lockfree|thread).*)$"
)

# Time is an argument below the daemon.
TIMELESS = (*PLAIN, "sim", "drives", "config")
CLOCK = re.compile(
    r"\bnow\s*\(\s*\)|\b(time|clock|timespec_get|gettimeofday|nanosleep|usleep|sleep_for|sleep_until)\s*\("
    r"|\bclock_(gettime|nanosleep)\s*\("
)

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]\s*$')
ANY_INCLUDE = re.compile(r"^\s*#\s*(include|import|include_next)\b")
# A string (kept, so that no comment begins in it), or a comment.
STRING_OR_COMMENT = re.compile(r'"(?:\\.|[^"\\\n])*"|//[^\n]*|/\*.*?\*/', re.DOTALL)
SUFFIXES = {".cpp", ".hpp"}


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
    if quote == '"' and len(Path(name).parts) == 1 and layer not in ("tools", "robot_client"):
        return None if name == "rc10_version.hpp" else f'"{name}": includes name the layer'
    if used in USES and used != layer and used not in USES[layer]:
        allowed = ", ".join(sorted(USES[layer])) or "nothing"
        return f'"{name}": {layer}/ may use {allowed}'
    return None


def bad_role(file: Path, name: str) -> str | None:
    """Says what is wrong with an include between the files of a family of drives."""
    if SIMULATED.search(file.name):
        if Path(name).parts[0] == FAMILIES and not OF_SIMULATED.search(name):
            return f'"{name}": a simulated drive and a recogniser see no motor'
    elif name.startswith("sim/") or SIMULATED.search(name) or name == "drives/families.hpp":
        return f'"{name}": a motor sees no simulated drive, no recogniser and no list of families'
    return None


def bad_room(layer: str, room: str, file: Path, name: str) -> str | None:
    """Says what is wrong with an include of the file's own layer."""
    parts = Path(name).parts
    used = parts[1] if len(parts) > 2 else ""
    if layer == FAMILIES and room and (what := bad_role(file, name)):
        return what
    if parts[0] != layer or used == room:
        return None
    if not room:
        below = file.suffix == ".hpp" and f"{layer}/{file.name}" not in ABOVE_ROOMS
        if below and any("" in allowed for allowed in ROOMS.get(layer, {}).values()):
            return f'"{name}": rooms of {layer}/ include {file.name}, not the other way round'
        return None
    if name in ABOVE_ROOMS:
        return f'"{name}": it stands above the rooms of {layer}/'
    if layer == FAMILIES and used:
        return f'"{name}": a family of drives knows no other'
    allowed = {""} if layer == FAMILIES else ROOMS.get(layer, {}).get(room, set())
    if used in allowed:
        return None
    names = ", ".join(f"{layer}/{name}".rstrip("/") for name in sorted(allowed)) or "nothing"
    return f'"{name}": of its layer {layer}/{room}/ may use {names}'


def named_family(layer: str, file: str, text: str, families: list[str]) -> str | None:
    """Says which family of drives a line of a layer that is to know none of them names."""
    if layer not in BLIND:
        return None
    if file.startswith(SEEING) and not INCLUDE.match(text):
        text = STRING_OR_COMMENT.sub("", text)
    named = next((name for name in families if name in text.lower()), None)
    if named is None:
        return None
    return f"{named}: {layer}/ knows no family by its name; ask MotorFamily or FamilyEntry"


def without_comments(text: str) -> list[str]:
    """The lines of a source, each where it was; one that goes on in the next is one."""

    def blank(match: re.Match[str]) -> str:
        return match[0] if match[0].startswith('"') else " " + "\n" * match[0].count("\n")

    return STRING_OR_COMMENT.sub(blank, text.replace("\\\n", " ")).splitlines()


def violations_in(file: Path, layer: str, room: str, families: list[str]) -> Iterator[Violation]:
    place = "/".join(part for part in (layer, room, file.name) if part)
    for number, text in enumerate(without_comments(file.read_text(encoding="utf-8")), 1):
        if named := named_family(layer, place, text, families):
            yield Violation(file, number, named)
        if include := INCLUDE.match(text):
            what = bad_include(layer, include[1], include[2])
            if what is None:
                what = bad_room(layer, room, file, include[2])
            if what is not None:
                yield Violation(file, number, what)
        elif ANY_INCLUDE.match(text):
            yield Violation(file, number, f"{text.strip()}: write #include and the name in full")
        elif layer in TIMELESS and (clock := CLOCK.search(STRING_OR_COMMENT.sub("", text))):
            yield Violation(file, number, f"{clock[0]}: {layer}/ gets the time as an argument")


def violations(src: Path) -> Iterator[Violation]:
    families = sorted(path.name for path in (src / FAMILIES).glob("*") if path.is_dir())
    for file in sorted(path for path in src.rglob("*") if path.is_file()):
        layer, *rooms = file.relative_to(src).parts[:-1] or [file.name]
        if file.suffix not in SUFFIXES:
            yield Violation(file, 1, f"sources end with {' or '.join(sorted(SUFFIXES))}")
            continue
        if len(rooms) > 1:
            yield Violation(file, 1, "a layer has rooms, and rooms have none")
        if layer not in USES:
            yield Violation(file, 1, f"{layer}/ is no layer")
            continue
        room = rooms[0] if rooms else ""
        if room and layer != FAMILIES and room not in ROOMS.get(layer, {}):
            yield Violation(file, 1, f"{layer}/{room}/ is no room of {layer}/")
        yield from violations_in(file, layer, room, families)


def main() -> int:
    src = Path(sys.argv[1])
    if not any(src.glob("*/*.cpp")):
        print(f"{src}: there are no sources")
        return 2
    found = list(violations(src))
    for violation in found:
        print(violation)
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
