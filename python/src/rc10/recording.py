"""Motion of a robot over time, as NumPy arrays."""

from __future__ import annotations

import csv
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from rc10.errors import MissingPackage, UnknownMotor
from rc10.recorder import TIMES
from rc10.signals import SIGNALS, Signal
from rc10.spelling import did_you_mean

try:
    import numpy as np
except ImportError as error:
    raise MissingPackage("recording", "numpy", "numpy") from error

if TYPE_CHECKING:
    import os
    from array import array
    from collections.abc import Mapping, Sequence

    import pandas as pd
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from rc10.recording_table import Units

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class MotorRecording:
    """The signals of one motor, one value for each of Recording.time_s.

    Units and meaning are those of MotorState; NaN is what the drive does not report. What is a
    whole number or an enumeration there is a float here: `status == rc10.MotorStatus.ACTIVE`.
    Each signal is an attribute too: `recording.motor("wheel").velocity_rpm`.
    """

    name: str
    signals: Mapping[str, FloatArray] = field(repr=False)

    def __getattr__(self, name: str) -> FloatArray:
        try:
            return self.__dict__["signals"][name]  # type: ignore[no-any-return]
        except KeyError:
            raise AttributeError(
                f"a motor has no signal '{name}'; it has: {', '.join(SIGNALS)}"
                f"{did_you_mean(name, SIGNALS)}"
            ) from None

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.signals]

    def part(self, samples: slice) -> MotorRecording:
        """Returns some of the samples."""
        return replace(self, signals={name: of[samples] for name, of in self.signals.items()})

    def signal(self, name: str) -> FloatArray:
        """Returns a signal by its name.

        Raises:
            UnknownSignal: there is none of this name.
        """
        signal = Signal.parse(f"{self.name}.{name}")
        return self.signals[signal.name]


@dataclass(frozen=True)
class Recording:
    """Every state of a robot over some time, on the daemon's clock.

    `recording["wheel.velocity_rpm"]` and `recording.motor("wheel").velocity_rpm` are the same.
    """

    robot: str
    time_s: FloatArray = field(repr=False)
    """Seconds since the first state, by the monotonic clock of the daemon's computer."""
    tick: NDArray[np.int64] = field(repr=False)
    """Ticks since the daemon's start."""
    start_mono_us: int
    """CLOCK_MONOTONIC of the first state, in microseconds: events have it too."""
    start_utime: int
    """Wall clock of the first state, in microseconds since 1970."""
    motors: Mapping[str, MotorRecording] = field(repr=False)

    @classmethod
    def from_samples(
        cls,
        robot: str,
        motors: Sequence[str],
        times: array[int],
        values: array[float],
    ) -> Recording:
        """Makes arrays of what a Recorder has collected, at least one state."""
        when = np.array(times, dtype=np.int64).reshape(-1, len(TIMES))
        table = np.array(values, dtype=np.float64)
        # Each signal becomes contiguous.
        columns = np.ascontiguousarray(table.reshape(len(when), len(motors) * len(SIGNALS)).T)
        by_motor = columns.reshape(len(motors), len(SIGNALS), len(when))
        return cls(
            robot=robot,
            time_s=(when[:, 0] - when[0, 0]) * 1e-6,
            tick=when[:, 2].copy(),
            start_mono_us=int(when[0, 0]),
            start_utime=int(when[0, 1]),
            motors=MappingProxyType(
                {
                    name: MotorRecording(name, dict(zip(SIGNALS, rows)))
                    for name, rows in zip(motors, by_motor)
                }
            ),
        )

    def __len__(self) -> int:
        return len(self.time_s)

    def with_zero_at(self, time_s: float) -> Recording:
        """Returns it with that instant as the new zero of time_s; what was before is negative."""
        return replace(self, time_s=self.time_s - time_s)

    def motor(self, name: str) -> MotorRecording:
        """Returns the motor `name`.

        Raises:
            UnknownMotor: it was not recorded.
        """
        try:
            return self.motors[name]
        except KeyError:
            raise UnknownMotor(
                f"'{name}' was not recorded; there are: {', '.join(self.motors) or 'none'}"
                f"{did_you_mean(name, self.motors)}"
            ) from None

    def signal(self, name: str) -> FloatArray:
        """Returns the signal `motor.signal`.

        Raises:
            UnknownMotor, UnknownSignal: it was not recorded.
        """
        signal = Signal.parse(name)
        return self.motor(signal.motor).signal(signal.name)

    def __getitem__(self, name: str) -> FloatArray:
        return self.signal(name)

    def names(self) -> list[str]:
        """Returns the names of all signals, as `wheel.velocity_rpm`."""
        return [f"{motor}.{name}" for motor in self.motors for name in SIGNALS]

    def to_csv(self, path: str | os.PathLike[str], signals: Sequence[str] | None = None) -> None:
        """Writes a table: a column for the time in seconds and one for each signal.

        What a drive does not report is empty.

        Args:
            path: of the file.
            signals: names as `wheel.velocity_rpm`; None for all.
        """
        chosen = self.names() if signals is None else list(signals)
        columns = [self.time_s, *(self.signal(name) for name in chosen)]
        with Path(path).open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["time_s", *chosen])
            for row in zip(*(column.tolist() for column in columns)):
                writer.writerow(["" if value != value else f"{value:.9g}" for value in row])

    def to_pandas(self, signals: Sequence[str] | None = None, units: Units = "deg") -> pd.DataFrame:
        """Returns a table with time_s as its index; enumerations are words, not numbers.

        Args:
            signals: names as `wheel.velocity_rpm`; None for all.
            units: "deg", or "rad" for rad and rad/s, with columns as `wheel.velocity_rad_s`.

        Raises:
            MissingPackage: pandas is not installed.
            UnknownMotor, UnknownSignal: it was not recorded.
        """
        from rc10.recording_table import data_frame

        return data_frame(self, signals, units)

    def to_mcap(
        self,
        path: str | os.PathLike[str],
        signals: Sequence[str] | None = None,
        units: Units = "deg",
    ) -> None:
        """Writes an MCAP file, for Foxglove and PlotJuggler: a topic for each motor.

        The words for numbers, as of `status`, are its metadata.

        Args:
            path: of the file.
            signals: names as `wheel.velocity_rpm`; None for all.
            units: "deg", or "rad" for rad and rad/s.

        Raises:
            MissingPackage: mcap is not installed.
            UnknownMotor, UnknownSignal: it was not recorded.
        """
        from rc10.recording_table import write_mcap

        write_mcap(self, path, signals, units)

    def plot(self, *signals: str, title: str = "") -> Figure:
        """Returns a figure of these signals, with axes of their own for each unit.

        Args:
            signals: names as `wheel.velocity_rpm`; none: what is followed, and how well, by
                every motor.
            title: written above.

        Raises:
            MissingPackage: matplotlib is not installed.
            UnknownMotor, UnknownSignal: it was not recorded.
        """
        from rc10.plot.figure import figure_of

        return figure_of(self, signals, title)

    def save_png(self, path: str | os.PathLike[str], *signals: str, title: str = "") -> None:
        """Writes what plot() shows to a PNG file; needs no display."""
        from rc10.plot.figure import save_png

        save_png(self.plot(*signals, title=title), path)
