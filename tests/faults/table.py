"""Writes what the campaign has proven into documents, or compares it with what is there."""

from __future__ import annotations

import argparse
import json
import re
import sys
from pathlib import Path

BEGIN, END = "<!-- faults: begin -->", "<!-- faults: end -->"


def rows(records: Path) -> list[dict[str, object]]:
    files = sorted(records.glob("*.jsonl"))
    return [json.loads(line) for file in files for line in file.read_text().splitlines()]


def table(lines: list[dict[str, object]]) -> list[str]:
    out = ["| fault | reaction | ticks | allowed |", "|---|---|---|---|"]
    for line in lines:
        measured = line["ticks"] is not None
        ticks, within = (line["ticks"], line["within"]) if measured else ("-", "-")
        out.append(f"| {line['fault']} | {line['reaction']} | {ticks} | {within} |")
    return out


def without_measurement(line: str) -> str:
    cells = line.split(" | ")
    return " | ".join([*cells[:2], *cells[3:]])


def update(document: Path, new: list[str], *, write: bool) -> bool:
    """Puts the table into the document, or tells what differs. False: it differs."""
    text = document.read_text()
    found = re.search(f"{BEGIN}\n(.*?){END}", text, re.DOTALL)
    if found is None:
        print(f"{document}: no {BEGIN} ... {END}")
        return False
    if write:
        body = "\n".join(new) + "\n"
        document.write_text(text[: found.start(1)] + body + text[found.end(1) :])
        return True
    written = {without_measurement(line) for line in found[1].splitlines()}
    proven = {without_measurement(line) for line in new}
    for line in sorted(written - proven):
        print(f"{document}: not proven by the campaign: {line}")
    for line in sorted(proven - written):
        print(f"{document}: missing, use tests/faults/run --write: {line}")
    return written == proven


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("records", type=Path)
    parser.add_argument("documents", type=Path, nargs="+")
    arguments = parser.parse_args()
    new = table(rows(arguments.records))
    right = [update(document, new, write=arguments.write) for document in arguments.documents]
    return int(not all(right))


if __name__ == "__main__":
    sys.exit(main())
