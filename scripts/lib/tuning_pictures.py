#!/usr/bin/env python3
"""Makes the pictures of docs/tuning.md: real steps of the robot that the page shows.

  .venv/bin/python scripts/lib/tuning_pictures.py [--build build/dev]

A quiet computer and root's rights make better figures: everything in the pictures is measured.
"""

from __future__ import annotations

import argparse
import csv
import json
import os
import re
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from screenshots import IMAGES, REPO, enter_namespace

PAGE = REPO / "docs" / "tuning.md"
SECONDS = 1.0
CURRENT_A = (-11.0, 11.0)
DPI = 85
PATIENCE_S = 20.0
# Steps of which the best is shown: a computer that pauses spoils one. States come every 5 ms.
TRIES, WHOLE_S = 10, 0.007
STANDS_RPM = 0.05


@dataclass(frozen=True)
class Picture:
    """Steps of some motors, beside each other."""

    file: str
    mode: str
    target: float
    signal: str
    unit: str
    top: float
    # By motor: the gains that its title names.
    motors: dict[str, tuple[str, ...]]


PICTURES = (
    Picture(
        "tuning-velocity.png",
        "velocity",
        60.0,
        "velocity_rpm",
        "rpm",
        95.0,
        dict.fromkeys(
            ("as_shipped", "kp_low", "ki_high", "kp_high"),
            ("velocity_pid.kp_a_per_rpm", "velocity_pid.ki_a_per_rpm_s"),
        ),
    ),
    Picture(
        "tuning-angle.png",
        "total_angle",
        90.0,
        "total_angle_deg",
        "deg",
        150.0,
        dict.fromkeys(
            ("angle_shipped", "angle_low", "angle_high", "angle_slew"),
            ("angle_pid.kp_rpm_per_deg",),
        ),
    ),
)


@dataclass(frozen=True)
class Step:
    """Response to one step; time 0 is when the target changed."""

    title: str
    time_s: list[float]
    measured: list[float]
    current_a: list[float]

    @property
    def longest_pause_s(self) -> float:
        """Between two states."""
        shown = [time_s for time_s in self.time_s if time_s >= 0.0]
        return max(after - before for before, after in pairwise(shown))


class Robot:
    """The page's robot, in a folder of its own. Leaving the `with` statement ends it."""

    def __init__(self, build: Path, folder: Path) -> None:
        self.folder = folder
        self.ctl = build / "bin" / "rc10ctl"
        self.env = {**os.environ, "RC10_RUN_DIR": str(folder), "RC10_STATE_DIR": str(folder)}
        (self.text,) = re.findall(r"^```yaml\n(robot: .*?)^```$", PAGE.read_text(), re.M | re.S)
        file = folder / "tuning.yaml"
        file.write_text(self.text)
        # As systemd hears that a service is ready.
        self._ready = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._ready.bind(str(folder / "notify"))
        self._ready.settimeout(PATIENCE_S)
        env = {**self.env, "NOTIFY_SOCKET": str(folder / "notify")}
        self._rc10d = subprocess.Popen([build / "bin" / "rc10d", "-c", file], env=env)

    def __enter__(self) -> Robot:
        while b"READY=1" not in self._ready.recv(4096):
            pass
        self._wait(lambda motors: all(m["status"] == "READY" for m in motors.values()), "the robot")
        return self

    def __exit__(self, *_: object) -> None:
        self._rc10d.terminate()
        self._rc10d.wait()
        self._ready.close()

    def best_step(self, motor: str, picture: Picture) -> Step:
        """The one that the computer disturbed least."""
        tried: list[Step] = []
        while len(tried) < TRIES and all(step.longest_pause_s > WHOLE_S for step in tried):
            tried.append(self._step(motor, picture))
        return min(tried, key=lambda step: step.longest_pause_s)

    def _step(self, motor: str, picture: Picture) -> Step:
        # As the page says it.
        if picture.mode == "total_angle":
            # After a step it coasts.
            self._wait(lambda motors: abs(motors[motor]["velocity_rpm"]) < STANDS_RPM, motor)
            subprocess.run([self.ctl, "zero", motor], env=self.env, check=True)
        table = self.folder / f"{motor}.csv"
        command = [sys.executable, "-m", "rc10.step", motor, picture.mode, f"{picture.target:g}"]
        command += ["--seconds", f"{SECONDS:g}", "--enable", "--csv", str(table)]
        subprocess.run(command, env=self.env, check=True)
        with table.open() as rows:
            records = list(csv.DictReader(rows))
        return Step(
            self._title(motor, picture),
            [float(row["time_s"]) for row in records],
            [float(row[f"{motor}.{picture.signal}"]) for row in records],
            [float(row[f"{motor}.current_a"]) for row in records],
        )

    def _title(self, motor: str, picture: Picture) -> str:
        gains = json.loads(self._output("gains", motor, "--json"))["gains"]
        named = [f"{key.split('.')[1][:2]} {gains[key]:g}" for key in picture.motors[motor]]
        if slew := re.search(rf"{motor},.*angle_slew_deg_per_s: (\d+)", self.text):
            named.append(f"slew {slew[1]} deg/s")
        default = " (default)" if motor.endswith("shipped") else ""
        return ", ".join(named) + default

    def _wait(self, wanted: Callable[[dict[str, Any]], bool], who: str) -> None:
        there = False
        deadline = time.monotonic() + PATIENCE_S
        command = [str(self.ctl), "watch", "--json", "--hz", "20"]
        with subprocess.Popen(command, env=self.env, stdout=subprocess.PIPE, text=True) as watch:
            assert watch.stdout is not None
            for state in watch.stdout:
                there = wanted({motor["name"]: motor for motor in json.loads(state)["motors"]})
                if there or time.monotonic() > deadline:
                    break
            watch.terminate()
        if not there:
            raise TimeoutError(f"{who} does not come to rest")

    def _output(self, *words: str) -> str:
        done = subprocess.run(
            [self.ctl, *words], env=self.env, capture_output=True, text=True, check=False
        )
        return done.stdout


def draw(picture: Picture, steps: list[Step]) -> None:
    """Curves of each: position above, current below."""
    figure = Figure(figsize=(8.2, 3.2), layout="constrained")
    axes = figure.subplots(
        2, len(steps), sharex=True, sharey="row", squeeze=False, height_ratios=(2, 1)
    )
    for column, step in enumerate(steps):
        above, below = axes[0][column], axes[1][column]
        above.set_title(step.title, fontsize=8)
        above.axhline(picture.target, color="#999999", linewidth=1)
        above.plot(step.time_s, step.measured, color="#1b5fa8", linewidth=1.3)
        below.plot(step.time_s, step.current_a, color="#a61c3c", linewidth=0.9)
        below.set_xlabel("s", fontsize=8)
        for panel in (above, below):
            panel.grid(visible=True, color="#dddddd", linewidth=0.7)
            panel.tick_params(labelsize=7)
    axes[0][0].set_xlim(0.0, SECONDS)
    axes[0][0].set_ylim(-5.0, picture.top)
    axes[1][0].set_ylim(*CURRENT_A)
    axes[0][0].set_ylabel(picture.unit, fontsize=8)
    axes[1][0].set_ylabel("A", fontsize=8)
    # Without it the version of matplotlib is in the file.
    figure.savefig(IMAGES / picture.file, dpi=DPI, metadata={"Software": None})


def main() -> None:
    """Runs the steps and draws them."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--build", type=Path, default=REPO / "build" / "dev")
    options = parser.parse_args()
    enter_namespace()
    subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
    route = ["239.255.76.67/32", "dev", "lo", "src", "127.0.0.1"]
    subprocess.run(["ip", "route", "add", *route], check=True)
    with (
        tempfile.TemporaryDirectory(prefix="rc10-tuning-") as folder,
        Robot(options.build.resolve(), Path(folder)) as robot,
    ):
        for picture in PICTURES:
            draw(picture, [robot.best_step(motor, picture) for motor in picture.motors])


if __name__ == "__main__":
    main()
