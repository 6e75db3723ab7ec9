"""A recording as MCAP, for Foxglove and PlotJuggler."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING

from rc10.errors import MissingPackage
from rc10.export.schema import encoded, numbers_schema

try:
    from mcap.writer import CompressionType, Writer
except ImportError as error:
    raise MissingPackage("MCAP", "mcap", "mcap") from error

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    import numpy as np
    from numpy.typing import NDArray


class RecordingFile:
    """Writes signals by motor, each a topic with a JSON message a sample; in a `with` statement.

    Args:
        path: of the file.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("wb")
        self._writer = Writer(self._file, compression=CompressionType.ZSTD)
        self._writer.start(profile="", library="rc10.recording")

    def __enter__(self) -> RecordingFile:
        return self

    def __exit__(self, *_: object) -> None:
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._file.close()

    def legends(self, words: Mapping[str, Mapping[str, str]]) -> None:
        """Writes the words for the numbers of signals, as metadata `legend: SIGNAL`."""
        for signal, legend in words.items():
            self._writer.add_metadata(f"legend: {signal}", dict(legend))

    def motor(
        self, topic: str, times_ns: NDArray[np.int64], columns: Mapping[str, NDArray[np.float64]]
    ) -> None:
        """Writes the signals of a motor; what its drive does not report is null."""
        schema = self._writer.register_schema(
            f"rc10{topic}", "jsonschema", encoded(numbers_schema(dict.fromkeys(columns)))
        )
        channel = self._writer.register_channel(topic, "json", schema)
        rows = zip(*(column.tolist() for column in columns.values()))
        for time_ns, row in zip(times_ns.tolist(), rows):
            message = {
                name: value if abs(value) < float("inf") else None
                for name, value in zip(columns, row)
            }
            self._writer.add_message(
                channel,
                log_time=time_ns,
                data=json.dumps(message, allow_nan=False).encode(),
                publish_time=time_ns,
            )
