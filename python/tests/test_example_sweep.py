"""The analysis of the sine sweep, against systems whose response is known."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import rc10
from rc10.plot.figure import save_png
from rc10.recording import MotorRecording
from rc10.signals import SIGNALS
from sine_sweep import bandwidth_hz, bode_figure, disturbed, frequencies_hz, response_at, write_csv

RANDOM = np.random.default_rng(1)


def first_order(frequency_hz: float, corner_hz: float = 5.0) -> complex:
    return 1 / complex(1, frequency_hz / corner_hz)


@pytest.mark.parametrize("frequency_hz", [0.5, 5.0, 20.0])
def test_gain_and_phase_from_uneven_noisy_samples(frequency_hz: float) -> None:
    expected = first_order(frequency_hz)
    time_s = np.sort(RANDOM.uniform(0, 4 / frequency_hz, 400))
    angle = 2 * math.pi * frequency_hz * time_s
    target = 60 + 20 * np.sin(angle)
    measured = 58 + 20 * abs(expected) * np.sin(angle + np.angle(expected))
    measured += RANDOM.normal(0, 0.1, len(time_s))
    measured[::50] = np.nan
    found = response_at(time_s, target, measured, frequency_hz)
    assert abs(found) == pytest.approx(abs(expected), rel=0.01)
    assert np.angle(found) == pytest.approx(np.angle(expected), abs=0.01)


def test_the_bandwidth_of_a_first_order_is_its_corner() -> None:
    frequencies = np.array(frequencies_hz(0.5, 50, 30))
    response = np.array([first_order(f) for f in frequencies])
    assert bandwidth_hz(frequencies, response) == pytest.approx(5.0, rel=0.02)
    assert math.isnan(bandwidth_hz(frequencies[:5], response[:5]))


def test_the_plot_has_gain_and_phase(tmp_path: Path) -> None:
    frequencies = np.array(frequencies_hz(1, 20, 5))
    assert frequencies[[0, -1]] == pytest.approx([1, 20])
    response = np.array([first_order(f) for f in frequencies])
    figure = bode_figure("a loop", frequencies, response)
    assert [axes.get_ylabel() for axes in figure.axes] == ["gain (dB)", "phase (deg)"]
    save_png(figure, tmp_path / "bode.png")
    assert (tmp_path / "bode.png").read_bytes().startswith(b"\x89PNG")
    write_csv(tmp_path / "bode.csv", frequencies, response)
    rows = (tmp_path / "bode.csv").read_text().splitlines()
    assert rows[0] == "frequency_hz,gain_db,phase_deg"
    assert len(rows) == 6


@pytest.mark.parametrize(
    ("spacing_s", "mode", "bad"),
    [(0.005, rc10.Mode.VELOCITY, False), (0.1, rc10.Mode.VELOCITY, True), (0.005, 0, True)],
)
def test_late_commands_and_states_are_noticed(spacing_s: float, mode: int, bad: bool) -> None:
    time_s: NDArray[np.float64] = np.arange(0, 1, 0.005, dtype=np.float64)
    time_s[100:] += spacing_s
    nothing = np.zeros_like(time_s)
    modes = np.full_like(time_s, rc10.Mode.VELOCITY)
    modes[50] = mode
    motor = MotorRecording("wheel", {**dict.fromkeys(SIGNALS, nothing), "mode": modes})
    assert disturbed(motor, time_s, 5.0) is bad
    assert len(motor.part(slice(10, None)).mode) == len(time_s) - 10
