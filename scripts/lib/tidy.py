#!/usr/bin/python3
"""Runs clang-tidy over src/ and prints each finding once, under its name in src/.

    tidy.py BUILD [--since COMMIT] [REGEX...]      BUILD has compile_commands.json

REGEX: only sources that match. --since: only sources that differ from that commit by more than
includes and comments, and for each header that does one source that includes it. A build that
compiles sources together (RC10_UNITY) has them checked together, at a sixth of the time.
A header is read by many sources, through a link in BUILD/layers, and clang-tidy repeats what it
finds there. What was clean stays so until the source, something it includes, .clang-tidy or
clang-tidy itself changes: RC10_CACHE (default ~/.cache/rc10) remembers, for every clone.
"""

from __future__ import annotations

import argparse
import contextlib
import hashlib
import json
import os
import re
import shlex
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path

from alone import source_including

REPO = Path(__file__).resolve().parents[2]
CACHE = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "rc10"
CLEAN = Path(os.environ.get("RC10_CACHE") or CACHE) / "tidy"
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"', re.MULTILINE)
UNITY = re.compile(r"/unity_\d+_cxx\.cxx$")
FINDING = re.compile(r"^(/[^:]+):(\d+):(\d+): (warning|error|note): (.*)$")


def version() -> bytes:
    return subprocess.run(["clang-tidy-16", "--version"], capture_output=True, check=True).stdout


def without_comments(settings: str) -> str:
    """Text of .clang-tidy without its lines of comment."""
    return re.sub(r"^ *#.*\n", "", settings, flags=re.MULTILINE)


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
    settings = without_comments((REPO / ".clang-tidy").read_text()).encode()
    headers = set(re.findall(rb'^# \d+ "([^"<]+)"', done.stdout, re.MULTILINE))
    own = {Path(entry["directory"], os.fsdecode(name)).resolve() for name in headers}
    own.add(Path(entry["file"]))
    texts = (read_by_tidy(path.read_text()) for path in sorted(own) if REPO / "src" in path.parents)
    # Comments leave empty lines and other line numbers.
    preprocessed = re.sub(rb"^(# \d+ .*)?\n", b"", done.stdout, flags=re.MULTILINE)
    # Paths below a clone's folder.
    command = os.fsencode(" ".join(words)).replace(os.fsencode(REPO), b"")
    inputs = [tool, command, settings, preprocessed, *map(str.encode, texts)]
    return hashlib.sha256(b"\0".join(inputs)).hexdigest()


def check(build: Path, tool: bytes, entry: dict[str, str]) -> str:
    """The output of clang-tidy for one source; empty when it is clean."""
    digest = digest_of_inputs(tool, entry)
    stamp = CLEAN / str(digest)
    if digest is not None and stamp.exists():
        return ""
    # A unity source includes sources: that is its purpose.
    checks = ["--checks=-bugprone-suspicious-include"] if UNITY.search(entry["file"]) else []
    done = subprocess.run(
        ["clang-tidy-16", "--quiet", *checks, "-p", build, entry["file"]],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode == 0:
        if digest is not None:
            # Where nothing can be written it is checked again.
            with contextlib.suppress(OSError):
                stamp.parent.mkdir(parents=True, exist_ok=True)
                stamp.touch()
        return ""
    return done.stdout or done.stderr or f"{entry['file']}: status {done.returncode}\n"


def findings(output: str, source: str) -> dict[tuple[str, ...], str]:
    """Each finding with the lines that belong to it, by place; those before the first by source."""
    found: dict[tuple[str, ...], str] = {}
    key: tuple[str, ...] = (os.path.relpath(source, REPO),)
    for line in output.splitlines():
        if (match := FINDING.match(line)) and match[4] != "note":
            file = os.path.relpath(os.path.realpath(match[1]), REPO)
            key = (file, match[2].zfill(6), match[3].zfill(6), match[5])
            found[key] = f"{file}:{match[2]}:{match[3]}: {match[5]}\n"
        else:
            found[key] = found.get(key, "") + line + "\n"
    return found


def sources_of(file: Path) -> list[Path]:
    """A source, or all that are compiled together in a unity source."""
    if UNITY.search(str(file)):
        return [Path(name) for name in INCLUDE.findall(file.read_text())]
    return [file]


@cache
def included_by(file: Path) -> frozenset[Path]:
    """The project's own files that a file includes itself."""
    found = set()
    for name in INCLUDE.findall(file.read_text(encoding="utf-8")):
        for folder in (REPO / "src", REPO / "src" / "robot_client", file.parent):
            if (folder / name).is_file():
                found.add((folder / name).resolve())
    return frozenset(found)


def included(source: Path) -> set[Path]:
    """The project's own files that a source includes, and those that they include."""
    found: set[Path] = set()
    left = [source]
    while left:
        new = included_by(left.pop()) - found
        found |= new
        left += new
    return found


# A string or character, so that no comment begins in it (' also separates digits); a comment.
TEXT_OR_COMMENT = re.compile(
    r"""R"(\w*)\((?:.|\n)*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9A-Za-z_])'(?:\\.|[^'\\\n])+'|//[^\n]*"""
)


def read_by_tidy(text: str) -> str:
    """A source's lines without its comments, but for NOLINT and those within a line.

    What comes between NOLINTNEXTLINE and its line ends its effect, so it leaves a trace.
    """

    def keep(match: re.Match[str]) -> str:
        return "" if match[0].startswith("//") and "NOLINT" not in match[0] else match[0]

    lines = (line.strip() for line in TEXT_OR_COMMENT.sub(keep, text).splitlines())
    kept: list[str] = []
    for line in lines:
        if line or (kept and "NOLINTNEXTLINE" in kept[-1]):
            kept.append(line or "//")
    return "\n".join(kept)


def says_the_same(old: str, new: str) -> bool:
    """Whether two texts of a source differ in includes and comments at most."""
    return INCLUDE.sub("", read_by_tidy(old)).split() == INCLUDE.sub("", read_by_tidy(new)).split()


def changed_files(since: str) -> set[Path]:
    """C++ files that differ from a commit by more than includes and comments.

    A file that was only moved says nothing new.
    """

    def git(*words: str) -> str:
        done = subprocess.run(["git", "-C", REPO, *words], capture_output=True, check=True)
        return done.stdout.decode()

    if git("diff", "--name-only", since, "--", ".clang-tidy"):
        _, _, blob, *_ = [*git("ls-tree", since, "--", ".clang-tidy").split(), "", "", ""]
        before = git("cat-file", "-p", blob) if blob else ""
        if without_comments(before) != without_comments((REPO / ".clang-tidy").read_text()):
            return set((REPO / "src").rglob("*.[ch]pp"))
    listed = git(
        "diff", "--raw", "-z", "--abbrev=40", "--find-renames", "-l0", since, "--", "*.[ch]pp"
    )
    fields = iter(listed.split("\0"))
    new = git("ls-files", "-z", "--others", "--exclude-standard", "--", "*.[ch]pp").split("\0")
    changed = {REPO / name for name in new if name}
    for field in fields:
        if not field:
            continue
        _, _, blob, _, status = field.split(" ")
        name = next(fields)
        if status[0] in "RC":
            name = next(fields)
        if status[0] == "D":
            continue
        file = REPO / name
        if status[0] == "A" or not says_the_same(git("cat-file", "-p", blob), file.read_text()):
            changed.add(file)
    return changed


def changed_sources(since: str, sources: list[Path]) -> set[Path]:
    """Sources that differ from a commit, and headers that no source includes.

    Other headers are seen through the first source that includes them.
    """
    changed = changed_files(since)
    headers = {file for file in changed if file.suffix == ".hpp"}
    includes = {source: included(source) for source in sources}
    chosen = changed.intersection(sources)
    headers = {file for file in headers if REPO / "src" in file.parents}
    # A source that is to be checked anyway, then the one with the fewest headers.
    order = sorted(
        sources, key=lambda source: (source not in chosen, len(includes[source]), source)
    )
    for source in order:
        seen = headers & includes[source]
        if seen:
            chosen.add(source)
            headers -= seen
    return chosen | headers


def headers_alone(entries: list[dict[str, str]]) -> set[Path]:
    """Headers of src/ that no source includes: those of users' programs alone."""
    seen: set[Path] = set()
    for entry in entries:
        for source in sources_of(Path(entry["file"])):
            seen |= included(source.resolve())
    return set((REPO / "src").rglob("*.hpp")) - seen


def entries_of_headers(
    folder: Path, headers: set[Path], entries: list[dict[str, str]]
) -> list[dict[str, str]]:
    """A build, in this folder, whose sources include one of these headers each."""
    folder.mkdir(parents=True, exist_ok=True)
    made = []
    for header in sorted(headers):
        like = max(entries, key=lambda entry: len(os.path.commonpath([header, nearest(entry)])))
        source = str(source_including(header, folder))
        words = [source if word == like["file"] else word for word in shlex.split(like["command"])]
        made.append({**like, "command": shlex.join(words), "file": source})
    (folder / "compile_commands.json").write_text(json.dumps(made))
    return made


def nearest(entry: dict[str, str]) -> Path:
    """The first source of a compilation."""
    return sources_of(Path(entry["file"]))[0].resolve()


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("build", type=Path)
    parser.add_argument("--since")
    parser.add_argument("regex", nargs="*")
    arguments = parser.parse_args()
    build = arguments.build.resolve()
    wanted = re.compile("|".join(arguments.regex))
    entries = [
        entry
        for entry in json.loads((build / "compile_commands.json").read_text())
        if all(REPO / "src" in file.resolve().parents for file in sources_of(Path(entry["file"])))
        and wanted.search(entry["file"])
    ]
    if not entries:
        print(f"{build}: no source of src/ in its compile_commands.json")
        return 1
    alone = {header for header in headers_alone(entries) if wanted.search(str(header))}
    like = entries
    if arguments.since is not None:
        sources = [Path(entry["file"]).resolve() for entry in entries]
        chosen = changed_sources(arguments.since, sources)
        entries = [entry for entry in entries if Path(entry["file"]).resolve() in chosen]
        alone &= chosen
    of_headers = entries_of_headers(build / "headers", alone, like)
    jobs = [(build, entry) for entry in entries] + [
        (build / "headers", entry) for entry in of_headers
    ]
    tool = version()
    with ThreadPoolExecutor(int(os.environ.get("RC10_JOBS", len(os.sched_getaffinity(0))))) as pool:
        outputs = pool.map(lambda job: check(job[0], tool, job[1]), jobs)
    found: dict[tuple[str, ...], str] = {}
    for (_, entry), output in zip(jobs, outputs, strict=True):
        found.update(findings(output, entry["file"]))
    for _, text in sorted(found.items()):
        print(text, end="")
    print(f"{len(entries)} sources, {len(of_headers)} headers alone, {len(found)} findings")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
