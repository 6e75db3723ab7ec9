"""The states of a log as a table, as Recording.to_csv() writes them."""

from __future__ import annotations

import csv
from typing import TYPE_CHECKING

from rc10.signals import SIGNALS

if TYPE_CHECKING:
    from pathlib import Path
    from typing import TextIO

    from rc10.export.log import Logged


class Tables:
    """Writes one CSV file for each robot, a row for each state; use it in a `with` statement.

    Time is that of the daemon, in seconds since its first state in the log.

    Args:
        path: of the file; with several robots their names are put before the extension.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._tables: dict[str, _Table] = {}

    def __enter__(self) -> Tables:
        return self

    def __exit__(self, *_: object) -> None:
        for table in self._tables.values():
            table.file.close()

    def add(self, logged: Logged) -> None:
        """Takes in a message."""
        if logged.name != "state" or not logged.robot or not hasattr(logged.message, "motors"):
            return
        if logged.robot not in self._tables:
            path = self._path
            if self._tables:
                path = path.with_name(f"{path.stem}.{logged.robot}{path.suffix}")
            self._tables[logged.robot] = _Table(path, logged)
        self._tables[logged.robot].add(logged)

    def written(self) -> dict[str, tuple[Path, int]]:
        """Returns the file and the number of its rows, by robot."""
        return {robot: (table.path, table.rows) for robot, table in self._tables.items()}


class _Table:
    def __init__(self, path: Path, first: Logged) -> None:
        self.path = path
        self.rows = 0
        self.file: TextIO = path.open("w", newline="", encoding="utf-8")
        self._writer = csv.writer(self.file)
        self._start_us: int = first.message.mono_us
        self._motors: list[str] = [motor.name for motor in first.message.motors]
        self._writer.writerow(
            ["time_s", *(f"{motor}.{name}" for motor in self._motors for name in SIGNALS)]
        )

    def add(self, logged: Logged) -> None:
        motors = {motor.name: motor for motor in logged.message.motors}
        row = [f"{(logged.message.mono_us - self._start_us) * 1e-6:.6f}"]
        for name in self._motors:
            motor = motors.get(name)
            for signal in SIGNALS:
                value = float("nan") if motor is None else float(getattr(motor, signal))
                row.append("" if value != value else f"{value:.9g}")
        self._writer.writerow(row)
        self.rows += 1
