"""Recordings in the form and units of other tools: pandas, MCAP."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from rc10.errors import MissingPackage
from rc10.radians import rad, rad_s
from rc10.setpoints import Mode
from rc10.signals import Signal
from rc10.state import Acting, CommandUnit, MotorStatus, StopCause

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence
    from enum import IntEnum

    import pandas as pd

    from rc10.recording import FloatArray, Recording

Units = Literal["deg", "rad"]
"""deg: degrees and rpm, as rc10d has them. rad: rad and rad/s."""

LEGENDS: Mapping[str, type[IntEnum]] = {
    "status": MotorStatus,
    "mode": Mode,
    "command_unit": CommandUnit,
    "acting": Acting,
    "stop_cause": StopCause,
}
"""The words for the numbers of these signals."""

# Their unit is that of the mode in force.
_OF_MODE = ("target", "target_shaped")
_ANGLES = (Mode.ANGLE, Mode.TOTAL_ANGLE, Mode.IMPEDANCE)


def in_units(recording: Recording, name: str, units: Units) -> tuple[str, FloatArray]:
    """Returns a signal in these units, and its name then: `wheel.velocity_rad_s`."""
    if units not in get_args(Units):
        raise ValueError(f"units={units!r}: use {' or '.join(get_args(Units))}")
    values = recording.signal(name)
    if units == "deg":
        return name, values
    signal = Signal.parse(name)
    if signal.name in _OF_MODE:
        mode = recording.motor(signal.motor).mode
        angle = np.isin(mode, _ANGLES)
        return name, np.where(
            angle, rad(values), np.where(mode == Mode.VELOCITY, rad_s(values), values)
        )
    stem, _, unit = name.rpartition("_")
    if unit == "deg":
        return f"{stem}_rad", rad(values)
    if unit == "rpm":
        return f"{stem}_rad_s", rad_s(values)
    return name, values


def data_frame(
    recording: Recording, signals: Sequence[str] | None = None, units: Units = "deg"
) -> pd.DataFrame:
    """Recording.to_pandas()."""
    try:
        import pandas as pd
    except ImportError as error:
        raise MissingPackage("to_pandas()", "pandas", "pandas") from error
    columns: dict[str, object] = {}
    for name in recording.names() if signals is None else signals:
        column, values = in_units(recording, name, units)
        legend = LEGENDS.get(Signal.parse(name).name)
        columns[column] = values if legend is None else _words(pd, values, legend)
    return pd.DataFrame(columns, index=pd.Index(recording.time_s, name="time_s"))


def write_mcap(
    recording: Recording,
    path: str | os.PathLike[str],
    signals: Sequence[str] | None = None,
    units: Units = "deg",
) -> None:
    """Recording.to_mcap()."""
    from rc10.export.recording_file import RecordingFile

    by_motor: dict[str, dict[str, FloatArray]] = {}
    for name in recording.names() if signals is None else signals:
        column, values = in_units(recording, name, units)
        motor = Signal.parse(name).motor
        by_motor.setdefault(motor, {})[column[len(motor) + 1 :]] = values
    with RecordingFile(Path(path)) as file:
        file.legends({name: {str(int(m)): m.name for m in kind} for name, kind in LEGENDS.items()})
        start_ns = recording.start_utime * 1000
        times_ns = start_ns + np.round(recording.time_s * 1e9).astype(np.int64)
        for motor, columns in by_motor.items():
            file.motor(f"/{recording.robot}/motor/{motor}", times_ns, columns)


def _words(pd: object, values: FloatArray, legend: type[IntEnum]) -> object:
    words = {int(member): member.name for member in legend}
    return pd.Categorical(  # type: ignore[attr-defined]
        [None if value != value else words.get(int(value), str(int(value))) for value in values],
        categories=list(words.values()),
    )
