#!/usr/bin/python3
"""Checks that the public headers of librc10 include public headers alone.

check_public_api.py CLONE     prints the violations; exit status 1 if there are any
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)


def listed(text: str, name: str) -> list[str]:
    """The values of a CMake list."""
    match = re.search(rf"^set\({name}\s([^)]*)\)", text, re.MULTILINE)
    return match[1].split() if match else []


def violations(clone: Path) -> list[str]:
    text = (clone / "cmake" / "PublicApi.cmake").read_text()
    src = clone / "src"
    layers = listed(text, "RC10_PUBLIC_LAYERS")
    headers = listed(text, "RC10_PUBLIC_HEADERS")
    found = [
        f"{name}: no list of it in PublicApi.cmake"
        for name, values in (("RC10_PUBLIC_LAYERS", layers), ("RC10_PUBLIC_HEADERS", headers))
        if not values
    ]
    found += [f"{name}: listed, and not there" for name in headers if not (src / name).is_file()]
    found += [f"{name}/: listed, and no layer" for name in layers if not (src / name).is_dir()]
    public = {src / name for name in headers if (src / name).is_file()}
    for layer in layers:
        public.update((src / layer).rglob("*.hpp"))
    for header in sorted(public):
        found += [
            f"{header.relative_to(src)} is public and includes {name}, which is not:"
            " add it to cmake/PublicApi.cmake, or do without"
            for name in INCLUDE.findall(header.read_text())
            for included in (src / name, header.parent / name)
            if included.is_file() and included not in public
        ]
    return found


def main() -> int:
    found = violations(Path(sys.argv[1]))
    print("\n".join(found) if found else "the public headers are closed")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
