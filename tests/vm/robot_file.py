"""The robots of these tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


def write_robot(folder: Path, bus: str) -> Path:
    """Few ticks: an emulated machine is late, and for that its motors need long time-outs too."""
    file = folder / "robot.yaml"
    file.write_text(
        "robot: vm\nrealtime: preferred\nlcm: {enabled: false}\n"
        "scheduler: {rate_hz: 100, overload_ms: 60000}\n"
        f"buses:\n{bus}"
    )
    return file
