"""The programs that are measured."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
PEERS = REPO / "bench/peers"
CLIENTS = PEERS / "clients"


def described(tree: Path) -> str:
    """Commit of the sources that a build tree is of; `-dirty`: they have changed since."""
    cache = tree / "CMakeCache.txt"
    text = cache.read_text() if cache.exists() else ""
    found = re.search(r"^CMAKE_HOME_DIRECTORY:INTERNAL=(.*)$", text, re.MULTILINE)
    if not found:
        return "of unknown sources"
    words = ["git", "-C", found[1], "describe", "--always", "--dirty"]
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout.strip()


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
    sources = sorted((checkout / "src").rglob("*.cpp"))
    if not sources:
        raise SystemExit(f"{checkout}: no checkout of openarm_can: it has no src/")
    return _compiled("client_openarm_can", tree, [checkout / "include"], sources)


def rm_hw_client(checkout: Path, tree: Path) -> Path:
    """The same with the CAN layer of rm_control's rm_hw. `stand_in` is there instead of ROS."""
    folder = checkout / "rm_hw/src/hardware_interface"
    sources = [folder / "can_bus.cpp", folder / "socketcan.cpp"]
    if not all(source.exists() for source in sources):
        raise SystemExit(f"{checkout}: no checkout of rm_control: it has no {folder}/can_bus.cpp")
    include = [PEERS / "stand_in", checkout / "rm_hw/include", checkout / "rm_common/include"]
    return _compiled("client_rm_hw", tree, include, sources)


def axol_client(checkout: Path, tree: Path) -> Path:
    """The same with socket and frames of axol-rt, by cargo and with its own settings."""
    crate = checkout / "rust/axol-rt"
    if not (crate / "src/can.rs").exists():
        raise SystemExit(f"{checkout}: no checkout of axol: it has no rust/axol-rt/src/can.rs")
    folder = tree / "client_axol_rt"
    shutil.rmtree(folder / "src", ignore_errors=True)
    (folder / "src").mkdir(parents=True)
    for name in ("Cargo.toml", "Cargo.lock"):
        shutil.copy(crate / name, folder)
    for module in ("can.rs", "proto.rs"):
        shutil.copy(crate / "src" / module, folder / "src")
    shutil.copy(CLIENTS / "client_axol_rt.rs", folder / "src/main.rs")
    cargo = ["cargo", "build", "--release", "--locked", "--target-dir", "target"]
    subprocess.run(cargo, cwd=folder, check=True, stdout=sys.stderr)
    return folder / "target/release/axol-rt"


def _compiled(client: str, tree: Path, include: list[Path], sources: list[Path]) -> Path:
    program = tree / "bin" / client
    flags = ["-O2", "-flto", "-std=c++20", "-pthread", *(f"-I{folder}" for folder in include)]
    subprocess.run(["g++", *flags, *sources, CLIENTS / f"{client}.cpp", "-o", program], check=True)
    return program
