#!/usr/bin/python3
"""Compiles each source of src/, and each header, by itself: an include that is missing shows.

    alone.py BUILD      BUILD: a tree without unity builds, configured

Where sources are compiled together, one finds what another has included. A header that some source
includes first has been compiled by itself there.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import NamedTuple

REPO = Path(__file__).resolve().parents[2]
SRC = REPO / "src"


class Compilation(NamedTuple):
    """One call of the compiler."""

    what: Path
    folder: Path
    words: list[str]


def check_only(entry: dict[str, str]) -> list[str]:
    """The command of a source without ccache and without an object."""
    words = shlex.split(entry["command"])
    if os.path.basename(words[0]) == "ccache":
        del words[0]
    output = words.index("-o")
    del words[output : output + 2]
    words[words.index("-c")] = "-fsyntax-only"
    return words


def source_including(header: Path, folder: Path) -> Path:
    """Writes a source that includes only this header."""
    source = folder / ("_".join(header.relative_to(SRC).parts) + ".cpp")
    source.write_text(f'#include "{header}"\n')
    return source


def of_header(header: Path, like: Compilation, scratch: Path) -> Compilation:
    """Compiles a header by itself, like a source of its folder."""
    source = source_including(header, scratch)
    return Compilation(header, like.folder, [*like.words[:-1], str(source)])


def included_first(source: Path) -> Path | None:
    """The project's header that a source includes before anything else."""
    match = re.search(r'^\s*#\s*include\s*(?:"([^"]+)"|<)', source.read_text(), re.MULTILINE)
    return SRC / match[1] if match and match[1] else None


def compilations(build: Path, scratch: Path) -> list[Compilation]:
    found: dict[Path, Compilation] = {}
    for entry in json.loads((build / "compile_commands.json").read_text()):
        source = Path(entry["file"])
        if SRC in source.parents:
            found.setdefault(
                source, Compilation(source, Path(entry["directory"]), check_only(entry))
            )
    # Like its own source: those of a folder may see different things. In a folder of headers alone:
    # like one below.
    seen = {included_first(source) for source in found}
    for header in sorted(set(SRC.rglob("*.hpp")) - seen):
        like = found.get(header.with_suffix(".cpp")) or next(
            found[source]
            for folder in header.parents
            for source in found
            if folder in source.parents
        )
        found[header] = of_header(header, like, scratch)
    return list(found.values())


def compile_alone(one: Compilation) -> str:
    """Messages of the compiler; empty when all is well."""
    done = subprocess.run(one.words, cwd=one.folder, capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else f"{one.what.relative_to(REPO)}:\n{done.stderr}"


def main() -> int:
    with tempfile.TemporaryDirectory() as scratch:
        all_of_them = compilations(Path(sys.argv[1]).resolve(), Path(scratch))
        with ThreadPoolExecutor(
            int(os.environ.get("RC10_JOBS", len(os.sched_getaffinity(0))))
        ) as pool:
            complaints = [text for text in pool.map(compile_alone, all_of_them) if text]
    print("".join(complaints), end="")
    print(f"{len(all_of_them)} compiled, {len(complaints)} do not compile alone")
    return int(bool(complaints))


if __name__ == "__main__":
    sys.exit(main())
