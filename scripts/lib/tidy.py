#!/usr/bin/python3
"""Runs clang-tidy over src/ and prints each finding once, under its name in src/.

    tidy.py BUILD [REGEX...]      REGEX: only sources that match; BUILD has compile_commands.json

A header is read by many sources, through a link in BUILD/layers, and clang-tidy repeats what it
finds there. What was clean stays so until the source, something it includes, .clang-tidy or
clang-tidy itself changes: RC10_CACHE (default ~/.cache/rc10) remembers, for every clone.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rc10"
CLEAN = Path(os.environ.get("RC10_CACHE") or CACHE) / "tidy"
FINDING = re.compile(r"^(/[^:]+):(\d+):(\d+): (warning|error|note): (.*)$")


def version() -> bytes:
    return subprocess.run(["clang-tidy-16", "--version"], capture_output=True, check=True).stdout


def digest_of_inputs(tool: bytes, entry: dict[str, str]) -> str | None:
    """A hash of all that the compiler reads for one source, None when it cannot be compiled."""
    words = shlex.split(entry["command"])
    if os.path.basename(words[0]) == "ccache":
        del words[0]
    output = words.index("-o")
    del words[output : output + 2]
    words[words.index("-c")] = "-E"
    done = subprocess.run(words, cwd=entry["directory"], capture_output=True, check=False)
    if done.returncode != 0:
        return None
    # Comments count too: NOLINT is one.
    source = Path(entry["file"]).read_bytes() + (REPO / ".clang-tidy").read_bytes()
    headers = set(re.findall(rb'^# \d+ "([^"<]+)"', done.stdout, re.MULTILINE))
    own = (Path(entry["directory"], os.fsdecode(name)).resolve() for name in headers)
    texts = (path.read_bytes() for path in sorted(own) if REPO / "src" in path.parents)
    # Of a clone's folder only what is below it.
    preprocessed = done.stdout.replace(os.fsencode(REPO), b"")
    command = os.fsencode(" ".join(words)).replace(os.fsencode(REPO), b"")
    return hashlib.sha256(b"\0".join([tool, command, source, preprocessed, *texts])).hexdigest()


def check(build: Path, tool: bytes, entry: dict[str, str]) -> str:
    """The output of clang-tidy for one source; empty when it is clean."""
    digest = digest_of_inputs(tool, entry)
    stamp = CLEAN / str(digest)
    if digest is not None and stamp.exists():
        return ""
    done = subprocess.run(
        ["clang-tidy-16", "--quiet", "-p", build, entry["file"]],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode == 0:
        if digest is not None:
            stamp.parent.mkdir(parents=True, exist_ok=True)
            stamp.touch()
        return ""
    return done.stdout or done.stderr


def findings(output: str) -> dict[tuple[str, ...], str]:
    """Each finding with the lines that belong to it, by place."""
    found: dict[tuple[str, ...], str] = {}
    key: tuple[str, ...] = ("",)
    for line in output.splitlines():
        if (match := FINDING.match(line)) and match[4] != "note":
            file = os.path.relpath(os.path.realpath(match[1]), REPO)
            key = (file, match[2].zfill(6), match[3].zfill(6), match[5])
            found[key] = f"{file}:{match[2]}:{match[3]}: {match[5]}\n"
        else:
            found[key] = found.get(key, "") + line + "\n"
    return found


def main() -> int:
    build = Path(sys.argv[1]).resolve()
    wanted = re.compile("|".join(sys.argv[2:]))
    entries = [
        entry
        for entry in json.loads((build / "compile_commands.json").read_text())
        if REPO / "src" in Path(entry["file"]).parents and wanted.search(entry["file"])
    ]
    tool = version()
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        outputs = pool.map(lambda entry: check(build, tool, entry), entries)
    found: dict[tuple[str, ...], str] = {}
    for output in outputs:
        found.update(findings(output))
    for _, text in sorted(found.items()):
        print(text, end="")
    print(f"{len(entries)} sources, {len(found)} findings")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
