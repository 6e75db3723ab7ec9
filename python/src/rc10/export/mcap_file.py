"""A log as MCAP, for Foxglove and PlotJuggler: JSON messages with JSON Schemas."""

from __future__ import annotations

import json
from functools import partial
from typing import TYPE_CHECKING, Any

from rc10.errors import MissingPackage
from rc10.export.log import plain
from rc10.export.schema import encoded, numbers_schema, schema_of
from rc10.lcm_types.motor_state_t import motor_state_t
from rc10.lcm_types.robot_state_t import robot_state_t
from rc10.lcm_types.signals_t import signals_t

try:
    from mcap.writer import CompressionType, Writer
except ImportError as error:
    raise MissingPackage("MCAP", "mcap", "mcap") from error

if TYPE_CHECKING:
    from pathlib import Path
    from typing import Callable

    from rc10.export.log import Logged

_NS_PER_US = 1000
_LEVELS = {0: 2, 1: 3, 2: 4}  # severity to foxglove.Log: INFO, WARNING, ERROR

_LOG_SCHEMA = {
    "type": "object",
    "properties": {
        "timestamp": {
            "type": "object",
            "title": "time",
            "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}},
        },
        "level": {"type": "integer"},
        "message": {"type": "string"},
        "name": {"type": "string"},
        "file": {"type": "string"},
        "line": {"type": "integer"},
    },
}


class McapFile:
    """Writes the messages of a log; use it in a `with` statement.

    What a viewer plots best is one topic for each motor, `/ROBOT/motor/wheel`, whose fields are
    the signals, and one for each module, `/ROBOT/module/base`, whose fields are its values.
    Events are foxglove.Log too, `/ROBOT/log`. All else keeps its form: `/ROBOT/command`.

    Args:
        path: of the file.
    """

    def __init__(self, path: Path) -> None:
        self.messages = 0
        self._file = path.open("wb")
        # Both viewers read zstd.
        self._writer = Writer(self._file, compression=CompressionType.ZSTD)
        self._writer.start(profile="", library="rc10.export")
        self._schemas: dict[str, int] = {}
        self._channels: dict[tuple[str, int], int] = {}

    def __enter__(self) -> McapFile:
        return self

    def __exit__(self, *_: object) -> None:
        self._writer.finish()  # type: ignore[no-untyped-call]
        self._file.close()

    def add(self, logged: Logged) -> None:
        """Takes in a message."""
        message = logged.message
        # A name of LCM's may have what a topic should not.
        topic = f"/{logged.robot}/{logged.name}" if logged.robot else f"/{logged.channel}"
        if isinstance(message, robot_state_t):
            self._add_state(logged, topic)
        elif isinstance(message, signals_t):
            self._add_signals(logged)
        else:
            kind = type(message)
            self._write(
                logged, topic, f"rc10.{kind.__name__}", partial(schema_of, kind), plain(message)
            )
            if kind.__name__ == "event_t":
                self._add_log(logged)

    def _add_state(self, logged: Logged, topic: str) -> None:
        message: robot_state_t = logged.message
        robot = plain(message)
        for motor in robot.pop("motors"):
            self._write(
                logged,
                f"/{logged.robot}/motor/{motor['name']}",
                "rc10.motor_state_t",
                partial(schema_of, motor_state_t),
                motor,
            )
        self._write(
            logged,
            topic,
            "rc10.robot_state_t",
            partial(schema_of, robot_state_t, ("motors",)),
            robot,
        )

    def _add_signals(self, logged: Logged) -> None:
        message: signals_t = logged.message
        values = {name: plain(value) for name, value in zip(message.names, message.values)}
        module, _, state = logged.name.partition(".")
        topic = f"/{logged.robot}/module/{module}" + ("" if state else "/input")
        # The names are those of this module: a schema of its own.
        self._write(logged, topic, f"rc10.signals{topic}", partial(numbers_schema, values), values)

    def _add_log(self, logged: Logged) -> None:
        event = logged.message
        seconds, microseconds = divmod(event.utime, 1_000_000)
        entry = {
            "timestamp": {"sec": seconds, "nsec": microseconds * _NS_PER_US},
            "level": _LEVELS.get(event.severity, 2),
            "message": f"{event.source}: {event.text}",
            "name": event.source,
            "file": "",
            "line": event.code,
        }
        self._write(logged, f"/{logged.robot}/log", "foxglove.Log", lambda: _LOG_SCHEMA, entry)

    def _write(
        self,
        logged: Logged,
        topic: str,
        name: str,
        schema: Callable[[], dict[str, Any]],
        message: Any,
    ) -> None:
        if name not in self._schemas:
            self._schemas[name] = self._writer.register_schema(
                name, "jsonschema", encoded(schema())
            )
        key = (topic, self._schemas[name])
        if key not in self._channels:
            self._channels[key] = self._writer.register_channel(topic, "json", key[1])
        # Published on the daemon's clock, received on the logger's.
        sent_us = getattr(logged.message, "utime", 0) or logged.utime
        self._writer.add_message(
            self._channels[key],
            log_time=logged.utime * _NS_PER_US,
            data=json.dumps(message, allow_nan=False).encode(),
            publish_time=max(0, sent_us) * _NS_PER_US,
        )
        self.messages += 1
