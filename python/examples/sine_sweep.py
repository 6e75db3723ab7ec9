"""Measures how a velocity loop follows sines of rising frequency, and draws its Bode plot.

    python sine_sweep.py demo front_left --from 1 --to 20 --png bode.png

Turns the motor around `--offset` rpm, so that neither friction nor backlash at standstill counts.
"""

from __future__ import annotations

import argparse
import csv
import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

import rc10

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from rc10.recording import MotorRecording

# A sine needs ten points, and states come 200 times a second by default.
_COMMAND_HZ = 200.0
_HIGHEST_HZ = 20.0
_VALIDITY_MS = 100
# Shortest sine of each frequency: its beginning is the transient.
_SETTLE_PERIODS, _PERIODS, _LEAST_S = 1, 4, 0.4
# Tries of a run that a busy computer has disturbed.
_TRIES = 3

Floats = NDArray[np.float64]


def frequencies_hz(lowest: float, highest: float, points: int) -> list[float]:
    """Returns frequencies with equal ratios."""
    return [float(f) for f in np.geomspace(lowest, highest, points)]


def response_at(time_s: Floats, target: Floats, measured: Floats, frequency_hz: float) -> complex:
    """Returns what a sine of this frequency becomes: its gain and its phase, as one number.

    A least-squares fit of both signals: samples may be unevenly spaced, and noise averages out.
    """
    usable = np.isfinite(target) & np.isfinite(measured)
    angle = 2 * math.pi * frequency_hz * time_s[usable]
    # The slope takes up what the offset does meanwhile.
    basis = np.column_stack([np.cos(angle), np.sin(angle), np.ones_like(angle), time_s[usable]])
    both = np.column_stack([target[usable], measured[usable]])
    (cosines, sines, *_), *_ = np.linalg.lstsq(basis, both, rcond=None)
    sent, came = (complex(c, -s) for c, s in zip(cosines, sines))
    return came / sent


def bandwidth_hz(frequencies: Floats, response: NDArray[np.complex128]) -> float:
    """Returns where the gain falls below -3 dB for the first time; NaN: within these nowhere."""
    gain_db = 20 * np.log10(np.abs(response))
    below = np.flatnonzero(gain_db < -3.0)
    if not len(below) or below[0] == 0:
        return math.nan
    after = int(below[0])
    return float(
        np.exp(
            np.interp(
                3.0,
                -gain_db[after - 1 : after + 1],
                np.log(frequencies[after - 1 : after + 1]),
            )
        )
    )


def disturbed(seen: MotorRecording, time_s: Floats, frequency_hz: float) -> bool:
    """Whether commands or states came too late for this frequency: the computer was busy."""
    expired = bool((seen.mode != rc10.Mode.VELOCITY).any())
    return expired or len(time_s) < 8 or float(np.diff(time_s).max()) > 0.2 / frequency_hz


def measure(
    robot: rc10.Robot,
    watch: rc10.Watch,
    motor: str,
    frequency_hz: float,
    amplitude_rpm: float,
    offset_rpm: float,
) -> tuple[complex, bool]:
    """Runs one sine; returns the response, and whether it was disturbed."""
    length_s = max(_LEAST_S, _PERIODS / frequency_hz)
    settle_s = max(0.3, _SETTLE_PERIODS / frequency_hz)
    with robot.recorder([motor]) as recorder:
        for t_s in robot.rate(_COMMAND_HZ):
            if not watch.may_send():
                continue
            sine = math.sin(2 * math.pi * frequency_hz * t_s)
            target = rc10.velocity_rpm(offset_rpm + amplitude_rpm * sine)
            robot.command({motor: target}, validity_ms=_VALIDITY_MS)
            if t_s > settle_s + length_s:
                break
    recording = recorder.recording()
    used = slice(int(np.searchsorted(recording.time_s, settle_s)), None)
    time_s, seen = recording.time_s[used], recording.motor(motor).part(used)
    response = response_at(time_s, seen.target, seen.velocity_rpm, frequency_hz)
    return response, disturbed(seen, time_s, frequency_hz)


def sweep(
    robot: rc10.Robot, motor: str, frequencies: list[float], amplitude_rpm: float, offset_rpm: float
) -> NDArray[np.complex128]:
    """Runs one sine after the other; the motor has to be ACTIVE."""
    responses = []
    watch = rc10.Watch(robot, motor)
    for frequency_hz in frequencies:
        for _ in range(_TRIES):
            response, bad = measure(robot, watch, motor, frequency_hz, amplitude_rpm, offset_rpm)
            if not bad:
                break
        responses.append(response)
        gain_db = 20 * math.log10(abs(response))
        phase_deg = math.degrees(math.atan2(response.imag, response.real))
        note = "  disturbed: this computer is too busy" if bad else ""
        print(f"{frequency_hz:7.2f} Hz  {gain_db:6.1f} dB  {phase_deg:7.1f} deg{note}", flush=True)
    return np.array(responses)


def bode_figure(title: str, frequencies: Floats, response: NDArray[np.complex128]) -> Figure:
    """Returns gain and phase over the frequency."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    from rc10.plot.figure import COLOURS, figure_with, style_axes

    figure, (gain, phase) = figure_with(2, title)
    gain.semilogx(frequencies, 20 * np.log10(np.abs(response)), "o-", color=COLOURS[0])
    gain.axhline(-3.0, color=COLOURS[1], linestyle="--", linewidth=1.0, label="-3 dB")
    gain.legend(loc="lower left", frameon=False, fontsize="small")
    angles = np.degrees(np.unwrap(np.angle(response)))
    phase.semilogx(frequencies, angles, "o-", color=COLOURS[0])
    style_axes(gain, "gain (dB)")
    style_axes(phase, "phase (deg)")
    phase.set_xlabel("frequency (Hz)")
    phase.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    phase.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    phase.xaxis.set_minor_formatter(NullFormatter())
    for axes in (gain, phase):
        axes.grid(visible=True, which="minor", color="#eeeeee", linewidth=0.5)
    return figure


def write_csv(path: Path, frequencies: Floats, response: NDArray[np.complex128]) -> None:
    """Writes a row for each frequency."""
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["frequency_hz", "gain_db", "phase_deg"])
        gains = 20 * np.log10(np.abs(response))
        angles = np.degrees(np.unwrap(np.angle(response)))
        writer.writerows(zip(frequencies.tolist(), gains.tolist(), angles.tolist()))


def main() -> None:
    """Runs the example."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("robot", help="robot: in the daemon's configuration")
    parser.add_argument("motor", help="name of one of its motors; it turns")
    parser.add_argument("--from", dest="lowest", type=float, default=1.0, help="Hz (1)")
    parser.add_argument("--to", dest="highest", type=float, default=20.0, help="Hz, 20 at most")
    parser.add_argument("--points", type=int, default=10, help="frequencies (10)")
    parser.add_argument("--amplitude", type=float, default=20.0, help="rpm (20)")
    parser.add_argument("--offset", type=float, default=60.0, help="rpm (60)")
    parser.add_argument("--png", type=Path, help="write the Bode plot")
    parser.add_argument("--csv", type=Path, help="write a table")
    options = parser.parse_args()
    if not (0.05 <= options.lowest < options.highest <= _HIGHEST_HZ and options.points >= 2):
        parser.error(f"0.05 <= --from < --to <= {_HIGHEST_HZ:g}, and two points at least")

    frequencies = frequencies_hz(options.lowest, options.highest, options.points)
    with rc10.connect(options.robot, client="sine-sweep", at_end="disable") as robot:
        robot.wait_for_state()
        robot.enable(options.motor)
        robot.wait_for_state()  # that shows it: the one known is older than the answer
        response = sweep(robot, options.motor, frequencies, options.amplitude, options.offset)
    over = np.array(frequencies)
    width_hz = bandwidth_hz(over, response)
    verdict = "not within these" if math.isnan(width_hz) else f"{width_hz:.1f} Hz"
    print(f"bandwidth (-3 dB): {verdict}")
    if options.csv:
        write_csv(options.csv, over, response)
    if options.png:
        from rc10.plot.figure import save_png

        title = f"{options.robot}, {options.motor}: velocity loop, bandwidth {verdict}"
        save_png(bode_figure(title, over, response), options.png)


if __name__ == "__main__":
    try:
        main()
    except rc10.Rc10Error as error:
        raise SystemExit(f"sine_sweep: {error}") from None
