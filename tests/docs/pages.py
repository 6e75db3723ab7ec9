"""Reads the project's pages: their code, links, anchors and tables."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path
from typing import NamedTuple

REPO = Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^```(?P<kind>\w*) ?(?P<note>[^\n]*)\n(?P<text>.*?)^```", re.M | re.S)
# As many backticks behind as before, and no more.
SPAN = re.compile(r"(?<!`)(`+)(?!`)(.+?)(?<!`)\1(?!`)")
LINK = re.compile(r"\]\(([^()\s]+)\)")
HEADING = re.compile(r"^#{1,6} +(.+?) *$", re.M)


class Row(NamedTuple):
    """Cells of a table."""

    cells: int
    code: list[str]  # the spans of code in it, sorted


class Page(NamedTuple):
    path: Path
    text: str

    @property
    def name(self) -> str:
        return str(self.path.relative_to(REPO))

    def fences(self, kind: str) -> list[str]:
        return [match["text"] for match in FENCE.finditer(self.text) if match["kind"] == kind]

    @property
    def shell(self) -> list[tuple[str, list[str]]]:
        """Blocks for a shell: how they are marked, and their commands without comments."""
        found = []
        for match in FENCE.finditer(self.text):
            lines = re.sub(r"<.+?>", "<>", match["text"]).splitlines()
            if match["kind"] == "console":
                lines = [line for line in lines if line.startswith("$ ")]
            if match["kind"] in ("sh", "console"):
                commands = [re.sub(r" *#.*", "", line) for line in lines]
                found.append((f"{match['kind']} {match['note']}", commands))
        return found

    @property
    def outline(self) -> list[int]:
        """Level of each heading."""
        return [len(match[1]) for match in re.finditer(r"^(#{1,6}) ", self.prose, re.M)]

    @property
    def other_code(self) -> list[str]:
        """Fences that are neither for a shell nor drawn, without their comments."""
        return [
            re.sub(r"[ \t]*(?:#(?!include)|//).*", "", match["text"])
            for match in FENCE.finditer(self.text)
            if match["kind"] not in ("", "sh", "console")
        ]

    @property
    def tables(self) -> list[list[Row]]:
        """Rows of each table."""
        found: list[list[Row]] = []
        before = False
        for line in self.prose.splitlines():
            is_row = line.startswith("|")
            if is_row:
                if not before:
                    found.append([])
                cells = re.split(r"(?<!\\)\|", SPAN.sub(lambda span: "`" * len(span[2]), line))
                found[-1].append(
                    Row(len(cells) - 2, sorted(code for _, code in SPAN.findall(line)))
                )
            before = is_row
        return found

    @property
    def prose(self) -> str:
        return FENCE.sub("", self.text)

    @property
    def code(self) -> list[str]:
        """Every fence, and every span of code outside them."""
        fences = [match["text"] for match in FENCE.finditer(self.text)]
        return fences + [span for _, span in SPAN.findall(self.prose)]

    @property
    def links(self) -> list[str]:
        """To files of the project, with their anchors."""
        targets = LINK.findall(SPAN.sub("", self.prose))
        return [target for target in targets if "://" not in target]


def pages() -> list[Page]:
    found = [*REPO.glob("*.md"), *REPO.glob("docs/**/*.md"), *REPO.glob("examples/**/*.md")]
    found += [REPO / "python" / "README.md", *REPO.glob("tests/*/README.md")]
    return [read(path) for path in sorted(found)]


@cache
def read(path: Path) -> Page:
    return Page(path, path.read_text(encoding="utf-8"))


@cache
def anchors(path: Path) -> frozenset[str]:
    """Anchors of the headings, as GitHub makes them."""
    seen: dict[str, int] = {}
    found = set()
    for heading in HEADING.findall(read(path).prose):
        words = re.sub(r"\[(.*?)\]\(.*?\)", r"\1", heading).lower()
        slug = re.sub(r"[^\w\- ]", "", words).replace(" ", "-")
        repeated = seen.get(slug, 0)
        seen[slug] = repeated + 1
        found.add(f"{slug}-{repeated}" if repeated else slug)
    return frozenset(found)


def messages(page: Page) -> list[str]:
    """Code quoted in the first cell of each table row."""
    rows = [line for line in page.prose.splitlines() if line.startswith("|")]
    return [span for row in rows for _, span in SPAN.findall(row.split(" | ")[0])]


@cache
def source_texts() -> str:
    """The sources, with literals that follow each other made one."""
    files = [
        *REPO.glob("src/**/*.[ch]pp"),
        *REPO.glob("python/src/**/*.py"),
    ]
    text = "\n".join(path.read_text(encoding="utf-8") for path in files)
    return re.sub(r'"\s*f?"', "", text).replace('\\"', '"')


def columns(page: Page, name: str) -> list[str]:
    """The code in the column of this name, in every table that has one."""
    found: list[str] = []
    place = None
    for line in page.prose.splitlines():
        if not line.startswith("|"):
            place = None
            continue
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if name in cells:
            place = cells.index(name)
        elif place is not None and place < len(cells):
            found += [span for _, span in SPAN.findall(cells[place])]
    return found


@cache
def known_tests() -> frozenset[str]:
    """Suite.Name of C++ tests and instances of suites, functions of the others, programs, files."""
    names: set[str] = set()
    for file in REPO.glob("tests/**/*.cpp"):
        text = file.read_text(encoding="utf-8")
        found = re.findall(r"^(?:TYPED_)?TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\s*\)", text, re.M)
        names |= {f"{suite}.{test}" for suite, test in found}
        for instance, suite in re.findall(r"INSTANTIATE_TEST_SUITE_P\(\s*(\w+),\s*(\w+)", text):
            names |= {f"{instance}/{suite}.{test}/0" for of, test in found if of == suite}
            names |= {f"{instance}/{suite}.{test}" for of, test in found if of == suite}
    for file in [*REPO.glob("tests/**/*.py"), *REPO.glob("python/tests/*.py")]:
        text = file.read_text(encoding="utf-8")
        names |= set(re.findall(r"^(?:async )?def (test_\w+)", text, re.M))
        names.add(str(file.relative_to(REPO)))
    names |= {file.stem for file in REPO.glob("tests/fuzz/*_fuzz.cpp")}
    programs = (REPO / "tests/CMakeLists.txt").read_text(encoding="utf-8")
    return frozenset(names | set(re.findall(r"add_executable\((\w+) ", programs)))
