"""Tests of motion: step, ramp, sine sweep and multisine, run by `rc10ctl test-motion`.

rc10ctl and the page run the same code of rc10d's client library, on this computer's rc10d.
"""

from __future__ import annotations

import csv
import json
import math
import os
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from rc10.errors import Rc10Error

Kind = Literal["step", "ramp", "sweep", "multisine"]


class MotionAborted(Rc10Error):
    """A test of motion ended before its time, and the motor was let go.

    Attributes:
        criterion: "angle", "velocity", "current", "feedback_age", "limit", "ownership", "status",
            "connection" or "interrupted".
        value: what was measured, in the unit of the limit; NaN if the criterion has no number.
        limit: the one that was set.
    """

    def __init__(self, criterion: str, value: float, limit: float, text: str) -> None:
        super().__init__(text)
        self.criterion = criterion
        self.value = value
        self.limit = limit


@dataclass(frozen=True)
class StepNumbers:
    """Numbers of a step, as those of `rc10.step`. NaN: it never got there."""

    rise_s: float
    overshoot_percent: float
    peak: float
    peak_s: float
    settling_s: float
    steady_error: float


@dataclass(frozen=True)
class BodePoint:
    """The response at one frequency: measured value over target."""

    frequency_hz: float
    gain_db: float
    phase_deg: float
    coherence: float
    """Share of the motion that the target explains, 0 to 1."""


@dataclass(frozen=True)
class MotionResult:
    """Numbers and curve of a test. NaN: not within the test's frequencies."""

    ticks: int
    unit: str
    following_error_rms: float
    following_error_max: float
    limits: tuple[str, ...]
    """Limits of the motor that acted."""
    step: StepNumbers | None
    acceleration_rpm_per_s: float
    """Slope of the velocity in a step of the current, once that has risen; else NaN."""
    bandwidth_hz: float
    phase_margin_deg: float
    gain_margin_db: float
    response: tuple[BodePoint, ...]
    curve: dict[str, list[float]]
    """Each tick, by the names of `rc10ctl test-motion --csv`."""


def run_motion_test(
    motor: str,
    kind: Kind,
    amplitude: float,
    *,
    max_current_a: float,
    mode: Literal["velocity", "total_angle", "current"] = "velocity",
    base: float = 0.0,
    seconds: float | None = None,
    rate_per_s: float | None = None,
    from_hz: float = 1.0,
    to_hz: float = 20.0,
    linear: bool = False,
    max_speed_rpm: float | None = None,
    min_angle_deg: float | None = None,
    max_angle_deg: float | None = None,
    max_feedback_age_s: float = 0.2,
    stop_at_limits: bool = False,
    dead_man_ms: int = 200,
    priority: int = 0,
    robot: str | None = None,
    program: str = "rc10ctl",
) -> MotionResult:
    """Moves an ACTIVE motor, and judges how it follows; the options are those of rc10ctl.

    When this program ends meanwhile, killed too, the test ends and the motor is let go.

    Args:
        motor: its name.
        kind: of the target over time.
        amplitude: height of a step or ramp, peak of sines, in the unit of the mode.
        max_current_a: above it the motor is let go; so with the other max_ and min_.
        mode: targets of total_angle count from where the motor stands.
        base: the target before a step or ramp, and in the middle of sines.
        seconds: how long; by default that of rc10ctl.
        rate_per_s: of a ramp.
        from_hz: lowest frequency of sines.
        to_hz: highest frequency of sines.
        linear: a sweep by equal steps of frequency, not by equal ratios.
        max_speed_rpm: needed in the modes total_angle and current.
        min_angle_deg: from where the motor stands.
        max_angle_deg: from where the motor stands.
        max_feedback_age_s: of the motor's feedback, as it arrives here.
        stop_at_limits: let go too when a limit of the motor acts.
        dead_man_ms: let go so long after the last word of a program that died.
        priority: a higher one takes the motor over from a lower one.
        robot: needed only if several run on this computer.
        program: rc10ctl, or its path.

    Raises:
        MotionAborted: a criterion was not met; the text has cause and remedy.
        Rc10Error: the test could not begin.
    """
    words = [program, "test-motion", "--json", "--end-with-stdin"]
    words += [f"--max-current={max_current_a!r}"]
    words += [f"--mode={mode}", f"--base={base!r}", f"--from={from_hz!r}", f"--to={to_hz!r}"]
    words += [f"--max-feedback-age={max_feedback_age_s!r}", f"--priority={priority}"]
    words += [f"--dead-man-ms={dead_man_ms}"]
    chosen = {
        "for": seconds,
        "rate": rate_per_s,
        "max-speed": max_speed_rpm,
        "min-angle": min_angle_deg,
        "max-angle": max_angle_deg,
    }
    words += [f"--{name}={value!r}" for name, value in chosen.items() if value is not None]
    words += ["--linear"] if linear else []
    words += ["--stop-at-limits"] if stop_at_limits else []
    words += [f"--robot={robot}"] if robot is not None else []
    with tempfile.TemporaryDirectory() as folder:
        table = Path(folder) / "curve.csv"
        words += [f"--csv={table}", "--", motor, kind, repr(amplitude)]
        result = _result_of(words)
        with table.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
    curve = {name: [float(row[name]) for row in rows] for name in rows[0]} if rows else {}
    step = result["step"]
    return MotionResult(
        ticks=result["ticks"],
        unit=result["unit"],
        following_error_rms=_number(result["following_error"]["rms"]),
        following_error_max=_number(result["following_error"]["max"]),
        limits=tuple(result["limits"]),
        step=step and StepNumbers(**{name: _number(value) for name, value in step.items()}),
        acceleration_rpm_per_s=_number(result["acceleration_rpm_per_s"]),
        bandwidth_hz=_number(result["bandwidth_hz"]),
        phase_margin_deg=_number(result["phase_margin_deg"]),
        gain_margin_db=_number(result["gain_margin_db"]),
        response=tuple(BodePoint(**point) for point in result["response"]),
        curve=curve,
    )


def _result_of(words: list[str]) -> dict[str, Any]:
    try:
        done = _run(words)
    except FileNotFoundError as error:
        raise Rc10Error(
            f"{words[0]} is not installed here: install rc10d's package, or give program="
        ) from error
    # A mistake of usage is told on stderr alone.
    result: dict[str, Any] = json.loads(done.stdout or "{}")
    said = result.get("error") or done.stderr.strip().removeprefix("rc10ctl: ")
    if abort := result.get("abort"):
        raise MotionAborted(
            abort["criterion"], _number(abort["value"]), _number(abort["limit"]), said
        )
    if done.returncode != 0:
        raise Rc10Error(said)
    return result


def _run(words: list[str]) -> subprocess.CompletedProcess[str]:
    """Runs a program whose stdin ends with this one: the kernel closes the pipe in any case."""
    stdin, held = os.pipe()
    try:
        return subprocess.run(words, stdin=stdin, capture_output=True, text=True, check=False)
    finally:
        os.close(stdin)
        os.close(held)


def _number(value: float | None) -> float:
    return math.nan if value is None else float(value)
