#!/usr/bin/env python3
"""Requirements with the hashes of scripts/python-hashes.txt, for pip's --require-hashes.

hashed_requirements.py FILE...   the requirements of these files, each with its hashes
hashed_requirements.py --pins    those of all files of the project, without hashes or conditions
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
HASHES = REPO / "scripts/python-hashes.txt"
FILES = [
    REPO / "python/requirements.txt",
    REPO / "python/requirements-dev.txt",
    REPO / "scripts/requirements.txt",
    REPO / "web/requirements.txt",
]
PIN = re.compile(r"([A-Za-z0-9_.-]+)==([^ ;\\]+)")


def lines(file: Path) -> list[str]:
    """Requirements of a file, one a line, without comments."""
    text = file.read_text(encoding="utf-8").replace("\\\n", " ")
    return [line.strip() for line in text.splitlines() if line.strip() and line[0] != "#"]


def pin(line: str) -> str:
    """Name and version, spelt as PyPI does not tell apart (PEP 503)."""
    found = PIN.match(line)
    if not found:
        sys.exit(f"hashed_requirements: '{line}' has no version: write name==version")
    return f"{re.sub('[-_.]+', '-', found[1]).lower()}=={found[2]}"


def hashed(files: list[Path]) -> list[str]:
    """Each requirement with its hashes; ends the program where one has none."""
    known = {pin(line): re.findall(r"--hash=sha256:[0-9a-f]{64}", line) for line in lines(HASHES)}
    wanted = [line for file in files for line in lines(file)]
    missing = [line for line in wanted if not known.get(pin(line))]
    if missing:
        words = f"{HASHES} has no hashes of {', '.join(missing)}; its head says how to get them"
        sys.exit(f"hashed_requirements: {words}")
    return [f"{line} {' '.join(known[pin(line)])}" for line in wanted]


if __name__ == "__main__":
    if sys.argv[1:] == ["--pins"]:
        print("\n".join(line.partition(";")[0] for file in FILES for line in lines(file)))
    else:
        print("\n".join(hashed([Path(name) for name in sys.argv[1:]])))
