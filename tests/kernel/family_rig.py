"""Robots of any family on vcan0: the Python fakes, the real rc10d, rc10ctl as a user's hand."""

from __future__ import annotations

import contextlib
import json
import re
import sys
from typing import TYPE_CHECKING, Any

from guestlib import Frame, Proc, run, wait_for
from rig import BIN

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from pathlib import Path

ROBOT = "families"


def write_config(folder: Path, *motors: str, bus: str = "", rate_hz: int = 1000) -> Path:
    """A robot on vcan0; `motors` are the keys of each, `bus` more keys of the bus."""
    lines = [f"robot: {ROBOT}", "realtime: preferred", f"scheduler: {{rate_hz: {rate_hz}}}"]
    lines += ["buses:"]
    lines += ["  - name: wire", "    type: socketcan", "    interface: vcan0"]
    lines += [f"    {key}" for key in bus.splitlines()]
    lines += ["    motors:", *(f"      - {{{motor}}}" for motor in motors)]
    path = folder / "robot.yaml"
    path.write_text("\n".join(lines) + "\n")
    return path


@contextlib.contextmanager
def running(config: Path, *drives: str, rate_hz: int = 1000) -> Iterator[Proc]:
    """The drives as fakes, and rc10d, until every motor is READY. `rate_hz`: of the fakes."""
    command = [sys.executable, "-m", "rc10.fakes", "--interface", "socketcan", "--channel", "vcan0"]
    command += ["--rate-hz", str(rate_hz)]
    for drive in drives:
        command += ["--motor", drive]
    with Proc(*command) as fakes:
        fakes.wait_line("^ready", 30.0)
        with Proc(BIN / "rc10d", "-c", config) as daemon:
            daemon.wait_line("robot '.*' runs", 10.0)
            wait_status("READY")
            yield daemon


def rc10ctl(*words: str) -> str:
    """Output of rc10ctl; raises when it fails."""
    return run(BIN / "rc10ctl", "--robot", ROBOT, *words)


def setting(motor: str, mode: str, value: float, seconds: float, *more: str) -> Proc:
    """A rc10ctl that gives a motor a target for so long."""
    words = (motor, mode, str(value), *more, "--for", f"{round(seconds * 1000)}ms")
    return Proc(BIN / "rc10ctl", "--robot", ROBOT, "set", *words)


def reading_after(motor: str, mode: str, value: float, seconds: float) -> float:
    """Gives a motor a target for so long; returns what was measured at the end."""
    # The last one's hand is still on the motor, for as long as its coasting is valid.
    wait_for(lambda: not any(state["owner"] for state in motors()), 2.0, "a free motor")
    with setting(motor, mode, value, seconds) as hand:
        assert hand.wait(seconds + 10.0) == 0, hand.output()
    (*_, last) = re.findall(r"measured (-?[\d.]+)", hand.output())
    return float(last)


def motors() -> list[dict[str, Any]]:
    """The state of every motor."""
    state = json.loads(rc10ctl("watch", "--json", "--hz", "100", "--count", "1"))
    return list(state["motors"])


def wait_status(status: str) -> None:
    """Waits until every motor has the status."""
    wait_for(
        lambda: all(motor["status"] == status for motor in motors()),
        5.0,
        f"every motor {status}",
        poll_s=0.1,
    )


def bus_stats() -> dict[str, Any]:
    """The bus in rc10d's diagnostics."""
    (bus,) = json.loads(rc10ctl("stats", "--json"))["buses"]
    return dict(bus)


def text_of(frame: Frame) -> str:
    """ID#DATA, with an x before an extended id, and ## for an FD frame."""
    number = f"x{frame.id:08X}" if frame.ext else f"{frame.id:03X}"
    return f"{number}{'##' if frame.fd else '#'}{frame.data.hex().upper()}"


def wire_seconds(frames: Iterable[Frame]) -> float:
    """Time for which they hold a wire of 1 Mbit/s, FD data at 5 Mbit/s, without stuff bits."""
    return sum(_wire_us(frame) for frame in frames) * 1e-6


def _wire_us(frame: Frame) -> float:
    size = len(frame.data)
    if not frame.fd:
        return (67 if frame.ext else 47) + 8 * size
    bits = (81 if frame.ext else 62) + 8 * size + (5 if size > 16 else 0)
    slow_bits = (36 if frame.ext else 17) + 12
    return slow_bits + (bits - slow_bits) / 5
