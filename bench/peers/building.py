"""The programs that are measured."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]


def programs(built: Path | None, *targets: str) -> Path:
    """The build tree that is given; without one, that of the preset `bench`, with these in it."""
    if built is not None:
        return built
    tree = REPO / "build" / "bench"
    print(f"-- building {', '.join(targets)}", file=sys.stderr, flush=True)
    for words in (
        ["cmake", "--preset", "bench", "-S", str(REPO)],
        ["cmake", "--build", str(tree), "--target", *targets],
    ):
        subprocess.run(words, check=True, stdout=sys.stderr)
    return tree


def openarm_client(checkout: Path, tree: Path) -> Path:
    """The client of `clients/` with openarm_can from the user's own checkout, which stays there."""
    program = tree / "bin" / "client_openarm_can"
    sources = sorted((checkout / "src").rglob("*.cpp"))
    if not sources:
        raise SystemExit(f"{checkout}: no checkout of openarm_can: it has no src/")
    client = REPO / "bench/peers/clients/client_openarm_can.cpp"
    include = f"-I{checkout / 'include'}"
    subprocess.run(
        ["g++", "-O2", "-flto", "-std=c++20", include, *sources, client, "-o", program], check=True
    )
    return program
