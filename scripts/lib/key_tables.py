#!/usr/bin/env python3
"""Writes the tables of keys into the pages, from config/rc10d.schema.json.

  scripts/lib/key_tables.py          writes; prints the pages that have changed
  scripts/lib/key_tables.py --check  changes nothing; status 1: a table is not as the schema says

A page says where a table belongs, and everything between the two lines is replaced:

  <!-- keys: scheduler -->
  <!-- end of keys -->

`scheduler` is a section of the schema. Beside those there are `family VESC` (the keys that only one
family of motors has), `models`, and `module` (the keys that all modules have). Every section has
its table on a page in English; translations have the same tables.
"""

from __future__ import annotations

import argparse
import json
import re
import sys
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any, NamedTuple

SCHEMA = "config/rc10d.schema.json"
TABLE = re.compile(r"(<!-- keys: (?P<of>[^>]+?) -->\n)(?P<table>.*?)(<!-- end of keys -->)", re.S)
HEAD = "| key | unit | values | default | meaning |\n|---|---|---|---|---|\n"
# Words for what src/config/report/schema.cpp makes of a key.
VALUES = re.compile(r" Values: (.+)\.$")
UNIT = re.compile(r" Unit: (.+?)\.$")
DEFAULT = re.compile(r" ?Default: ((?:[^.]|\.(?=\S))+)\.")
PAGE_LINK = re.compile(r"docs/([\w/-]+\.md)(#[\w-]+)?")
WORD = re.compile(r"(?<![\w./<>`-])[a-z][a-z0-9]*(?:_[a-z0-9]+)+(?![\w/<>`-])")
COMMON_TO_MODULES = ("name", "type", "priority")
TOO_MANY = 12
LONG_NUMBER = 100_000

Section = dict[str, Any]


class WrongPageError(Exception):
    """A page and the schema differ."""


class Row(NamedTuple):
    part: str  # of what: empty, or "`sticks`: "
    names: list[str]
    rest: str  # the other cells: rows of which only the name differs are one

    @property
    def text(self) -> str:
        return f"| {self.part}{', '.join(f'`{name}`' for name in self.names)} | {self.rest} |\n"


def number(value: float) -> str:
    text = f"{value:.10g}" if abs(value) < 1e15 else str(value)
    return f"{int(value):,}".replace(",", " ") if abs(value) >= LONG_NUMBER else text


def default_text(value: str | float) -> str:
    """As it would be written in YAML, where # begins a comment."""
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    text = json.dumps(value)
    return text if text.startswith('"#') else text.strip('"')


def bounds(key: Section) -> str:
    low = (
        f"above {number(key['exclusiveMinimum'])},"
        if "exclusiveMinimum" in key
        else number(key["minimum"])
    )
    return (
        f"{low} to {number(key['maximum'])}"
        if "maximum" in key
        else f"{low} to the model's highest"
    )


class Tables:
    """The tables of one schema. `up` leads from a page to docs/."""

    def __init__(self, schema: Section) -> None:
        self.sections: dict[str, Section] = schema["$defs"]
        rules = self.sections["motor"]["allOf"]
        self.families = {rule["title"]: rule for rule in rules if "title" in rule}
        self.models = {
            rule["if"]["properties"]["model"]["const"]: rule["then"]["properties"]
            for rule in rules
            if "title" not in rule
        }
        self.modules = [name for name in self.sections if self.is_module(name)]
        self.words = set(self.all_words())

    def is_module(self, name: str) -> bool:
        # A part of a module may have a type, too.
        return name.startswith("module_") and "priority" in self.sections[name]["properties"]

    def all_words(self) -> Iterator[str]:
        for section in self.sections.values():
            for name, key in section["properties"].items():
                yield name
                yield from (word for word in key.get("enum", []) if isinstance(word, str))

    def wanted(self) -> set[str]:
        """Every table there is. A profile has a motor's keys; parts of modules stand with them."""
        plain = {name for name in self.sections if not name.startswith("module_")} - {"profile"}
        families = {f"family {name}" for name in self.families if self.own_keys(name)}
        return plain | families | set(self.modules) | {"models", "module"}

    def own_keys(self, family: str) -> Section:
        keys: Section = self.families[family]["then"]["properties"]
        return {name: key for name, key in keys.items() if key is not False}

    def make(self, of: str, up: str) -> str:
        if of == "models":
            return self.model_table()
        return HEAD + "".join(row.text for row in joined(self.rows(of, up)))

    def rows(self, of: str, up: str) -> Iterator[Row]:
        if of.startswith("family "):
            rule = self.families[of.removeprefix("family ")]["then"]
            section = {"properties": self.own_keys(of.removeprefix("family "))}
            yield from self.section_rows({**section, "required": rule.get("required", [])}, up)
        elif of == "module":
            any_module = self.sections[self.modules[0]]
            keys = {name: any_module["properties"][name] for name in COMMON_TO_MODULES}
            keys["type"] = {
                "type": "string",
                "description": "What it is: one of those below. Values: a type.",
            }
            yield from self.section_rows(
                {"properties": keys, "required": any_module["required"]}, up
            )
        elif self.is_module(of) if of in self.sections else False:
            yield from self.section_rows(self.sections[of], up, leave_out=COMMON_TO_MODULES)
        elif of == "motor":
            own = {name for family in self.families for name in self.own_keys(family)}
            yield from self.section_rows(self.sections[of], up, leave_out=own)
        elif of in self.sections:
            yield from self.section_rows(self.sections[of], up)
        else:
            raise WrongPageError(
                f"there is no '{of}'; there are: {', '.join(sorted(self.wanted()))}"
            )

    def section_rows(
        self, section: Section, up: str, part: str = "", leave_out: Collection[str] = ()
    ) -> Iterator[Row]:
        for name, key in section["properties"].items():
            if name in leave_out:
                continue
            required = name in section.get("required", [])
            yield Row(part, [name], self.cells(key, required, up))
            inner = key.get("$ref") or key.get("items", {}).get("$ref", "")
            inner = inner.rpartition("/")[2]
            if inner.startswith("module_"):
                yield from self.section_rows(self.sections[inner], up, f"{part}`{name}`: ")

    def cells(self, key: Section, required: bool, up: str) -> str:
        meaning = key["description"]
        words, meaning = taken(VALUES, meaning)
        unit, meaning = taken(UNIT, meaning)
        default, meaning = taken(DEFAULT, meaning)
        if "default" in key:
            default = f"`{default_text(key['default'])}`"
        if required:
            default = "**required**"
        unit = unit.replace("^2", "²").replace("^3", "³")
        cells = [unit, self.values(key, words), default, self.prose(meaning, up)]
        return " | ".join(cells)

    def values(self, key: Section, words: str) -> str:
        if "enum" in key:
            if len(key["enum"]) > TOO_MANY:
                return f"one of {len(key['enum'])}"
            return " \\| ".join(f"`{value}`" for value in key["enum"])
        match key.get("type"):
            case "boolean":
                return "`true` \\| `false`"
            case "string":
                return self.escaped(words) if " " in words else f"`{words}`"
            case "array":
                least, most = key["minItems"], key["maxItems"]
                count = f"{least} to {most}" if least else f"up to {most}"
                return f"list, {count}"
            case "object":
                return "sections by name"
            case "integer" | "number":
                return ("whole, " if key["type"] == "integer" else "") + bounds(key)
        return "section"

    def prose(self, text: str, up: str) -> str:
        text = self.escaped(text)
        text = WORD.sub(lambda m: f"`{m[0]}`" if m[0] in self.words else m[0], text)
        return PAGE_LINK.sub(lambda m: f"[{m[1]}]({up}{m[1]}{m[2] or ''})", text)

    @staticmethod
    def escaped(text: str) -> str:
        return (
            re.sub(r"<\S*>\S*[\w>]", lambda m: f"`{m[0]}`", text)
            .replace("|", "\\|")
            .replace("*", "\\*")
        )

    def model_table(self) -> str:
        text = "| models | family | `id` | `gear_ratio` |\n|---|---|---|---|\n"
        family_of = {
            model: title
            for title, rule in self.families.items()
            for model in rule["if"]["properties"]["model"]["enum"]
        }
        lines: dict[str, list[str]] = {}
        for model, keys in self.models.items():
            gear = f"{keys['gear_ratio']['default']:.8g}"
            rest = (
                f"{family_of[model]} | {keys['id']['minimum']} to {keys['id']['maximum']} | {gear}"
            )
            lines.setdefault(rest, []).append(f"`{model}`")
        return text + "".join(f"| {', '.join(names)} | {rest} |\n" for rest, names in lines.items())


def taken(pattern: re.Pattern[str], text: str) -> tuple[str, str]:
    """The match of the pattern, and the text without it."""
    found = pattern.search(text)
    if found is None:
        return "", text
    return found[1], (text[: found.start()] + text[found.end() :]).strip()


def joined(rows: Iterator[Row]) -> list[Row]:
    """Rows that follow each other and say the same of several keys are one."""
    together: list[Row] = []
    for row in rows:
        if together and together[-1][::2] == row[::2]:
            together[-1].names.extend(row.names)
        else:
            together.append(row)
    return together


def with_tables(page: Path, root: Path, tables: Tables, seen: set[str]) -> str:
    up = "../" * (len(page.relative_to(root / "docs").parts) - 1)

    def table(match: re.Match[str]) -> str:
        seen.add(match["of"])
        return match[1] + tables.make(match["of"], up) + match[4]

    try:
        return TABLE.sub(table, page.read_text(encoding="utf-8"))
    except WrongPageError as error:
        raise WrongPageError(f"{page.relative_to(root)}: {error}") from None


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0] if __doc__ else None)
    parser.add_argument(
        "--check", action="store_true", help="change nothing; status 1 if a table is old"
    )
    parser.add_argument("root", nargs="?", type=Path, default=Path(__file__).resolve().parents[2])
    options = parser.parse_args()
    tables = Tables(json.loads((options.root / SCHEMA).read_text(encoding="utf-8")))
    seen: set[str] = set()
    old = 0
    try:
        for page in sorted(options.root.glob("docs/**/*.md")):
            translated = page.name.endswith(".zh-CN.md")
            text = with_tables(page, options.root, tables, set() if translated else seen)
            if text == page.read_text(encoding="utf-8"):
                continue
            old += 1
            what = "is not as the schema says" if options.check else "written"
            print(f"{page.relative_to(options.root)}: {what}")
            if not options.check:
                page.write_text(text, encoding="utf-8")
        if missing := tables.wanted() - seen:
            raise WrongPageError(f"on no page: {', '.join(sorted(missing))}")
    except WrongPageError as error:
        print(f"key_tables.py: {error}", file=sys.stderr)
        return 1
    if options.check and old:
        print("key_tables.py: run `cmake --build --preset dev --target reference`", file=sys.stderr)
    return 1 if options.check and old else 0


if __name__ == "__main__":
    sys.exit(main())
