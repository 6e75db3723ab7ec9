"""A recording of a simulated robot, and its layout as rc10-web tells it."""

from __future__ import annotations

import json
import urllib.request
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hostlib import Daemon
from hostlib.daemon import CONFIG
from hostlib.program import PATIENCE_S

if TYPE_CHECKING:
    from conftest import Studio


@dataclass
class Box:
    """A recording of a robot that was enabled, driven and stopped, and what rc10ctl reads in it."""

    bytes: bytes
    records: list[dict[str, Any]]

    def of(self, kind: str) -> list[dict[str, Any]]:
        return [record for record in self.records if record["kind"] == kind]

    @property
    def stop_us(self) -> float:
        """The e-stop, since the first record."""
        stop = next(e for e in self.of("event") if e["text"].startswith("RUN -> ESTOP"))
        return float(stop["mono_us"] - self.records[0]["mono_us"])

    def tick_at(self, at_us: float) -> int:
        """Since the first record. Where ticks were missed, the next record bounds it."""
        mono_us = float(self.records[0]["mono_us"]) + at_us
        robots = self.of("robot")
        known = [r for r in robots if r["mono_us"] <= mono_us + 1]
        passed = round((mono_us - float(known[-1]["mono_us"])) / 1000)
        ticks = [int(known[-1]["tick"]) + passed]
        ticks += [int(r["tick"]) - 1 for r in robots[len(known) : len(known) + 1]]
        return min(ticks)


def record() -> Box:
    # So small that its history has begun anew several times.
    with Daemon("blackbox_mib: 1\n" + CONFIG.format(realtime="preferred")) as daemon:
        daemon.wait_ready()
        # Nine seconds where no tick is missed.
        daemon.wait_state(lambda state: state["tick"] > 9000, "its history is full", 3 * PATIENCE_S)
        daemon.must("enable")
        with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s"):
            daemon.wait_motor("wheel", lambda motor: motor["velocity_rpm"] > 50, "turns")
            daemon.must("estop")
        daemon.wait_motor("wheel", lambda motor: abs(motor["velocity_rpm"]) < 1, "stands")
        daemon.kill()
        content = (daemon.run_dir / "host.blackbox").read_bytes()
        lines = daemon.must("blackbox", "--json").splitlines()
    return Box(content, [json.loads(line) for line in lines])


def patched(content: bytes, at: int, value: bytes) -> bytes:
    return content[:at] + value + content[at + len(value) :]


def field_at(web: Studio, structure: str, name: str) -> int:
    return int(format_of(web)["structures"][structure]["fields"][name]["at"])


def format_of(web: Studio) -> dict[str, Any]:
    # A bare system has no /etc/hosts: only browsers know "localhost" by themselves.
    with urllib.request.urlopen(f"http://127.0.0.1:{web.port}/recording-format.json") as answer:
        found: dict[str, Any] = json.load(answer)
    return found
