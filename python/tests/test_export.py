"""Logs as lcm-logger writes them, read back as MCAP and as a table."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import lcm
import pytest
from mcap.reader import make_reader

from fake_daemon import FakeDaemon
from rc10.lcm_types import command_t, diagnostics_t, event_t, setpoint_t, signals_t
from rc10.link import LcmLink

START_US = 1_700_000_000_000_000
STATES = 50


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """Half a second of a robot 'demo', and a message that is not ours."""
    path = tmp_path / "match.lcmlog"
    daemon = FakeDaemon("demo", LcmLink("memq://"))
    log = lcm.EventLog(str(path), "w", overwrite=True)
    for number in range(STATES):
        state = daemon.state()
        state.mono_us = 5_000_000 + number * 10_000
        state.utime = START_US + number * 10_000
        state.motors[0].velocity_rpm = float(number)
        log.write_event(state.utime + 100, "demo.v1.state", state.encode())

    command = command_t()
    command.client, command.setpoint_count = "teleop", 1
    setpoint = setpoint_t()
    setpoint.motor, setpoint.mode, setpoint.value = "wheel", setpoint_t.MODE_VELOCITY, 60.0
    setpoint.stiffness_nm_per_rad = float("nan")
    command.setpoints = [setpoint]
    log.write_event(START_US, "demo.v1.command", command.encode())

    event = event_t()
    event.utime, event.severity, event.code = START_US + 7, event_t.SEVERITY_ERROR, 101
    event.source, event.text = "wheel", "stalled"
    log.write_event(START_US, "demo.v1.event", event.encode())

    outputs = signals_t()
    outputs.count, outputs.names, outputs.values = 2, ["x_m", "y_m"], [1.5, float("nan")]
    log.write_event(START_US, "demo.v1.base.state", outputs.encode())
    log.write_event(START_US, "demo.v1.diagnostics", diagnostics_t().encode())
    log.write_event(START_US, "camera", b"not one of our types")
    log.close()
    return path


def export(*words: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "rc10.export", *words], capture_output=True, text=True, check=False
    )


def read_back(path: Path) -> tuple[dict[str, list[dict[str, Any]]], dict[str, dict[str, Any]]]:
    """Returns the messages and the schema by topic."""
    messages: dict[str, list[dict[str, Any]]] = {}
    schemas: dict[str, dict[str, Any]] = {}
    with path.open("rb") as file:
        for schema, channel, message in make_reader(file).iter_messages():
            assert schema is not None
            assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
            schemas[channel.topic] = {"name": schema.name, **json.loads(schema.data)}
            messages.setdefault(channel.topic, []).append(
                {**json.loads(message.data), "log_time": message.log_time}
            )
    return messages, schemas


def test_mcap_has_a_topic_for_each_motor(log: Path) -> None:
    done = export(log, "--only", "mcap")
    assert done.returncode == 0, done.stderr
    messages, schemas = read_back(log.with_name("match.lcmlog.mcap"))
    wheel = messages["/demo/motor/wheel"]
    assert [m["velocity_rpm"] for m in wheel] == list(range(STATES))
    assert wheel[3]["log_time"] == (START_US + 30_100) * 1000
    assert wheel[0]["voltage_v"] is None, "JSON has no NaN"
    assert messages.keys() >= {"/demo/motor/yaw", "/demo/motor/left-arm"}
    assert schemas["/demo/motor/wheel"]["properties"]["velocity_rpm"] == {"type": "number"}
    assert schemas["/demo/motor/wheel"]["type"] == "object"
    assert len(messages["/demo/state"]) == STATES
    assert "motors" not in messages["/demo/state"][0]
    assert f"wrote {log}.mcap: {4 * STATES + 5} messages" in done.stdout


def test_mcap_has_everything_else_too(log: Path) -> None:
    assert export(log).returncode == 0
    messages, schemas = read_back(log.with_name("match.lcmlog.mcap"))
    (command,) = messages["/demo/command"]
    assert command["setpoints"][0]["value"] == 60
    items = schemas["/demo/command"]["properties"]["setpoints"]
    assert items["items"]["properties"]["motor"] == {"type": "string"}
    (outputs,) = messages["/demo/module/base"]
    assert (outputs["x_m"], outputs["y_m"]) == (1.5, None)
    (entry,) = messages["/demo/log"]
    assert schemas["/demo/log"]["name"] == "foxglove.Log"
    assert (entry["level"], entry["message"]) == (4, "wheel: stalled")
    assert entry["timestamp"] == {"sec": 1_700_000_000, "nsec": 7000}
    assert "/demo/diagnostics" in messages


def test_a_table_of_the_states(log: Path, tmp_path: Path) -> None:
    table = tmp_path / "states.csv"
    done = export(log, "--only", "csv", "--csv", table)
    assert done.returncode == 0, done.stderr
    with table.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == STATES
    assert (rows[3]["time_s"], rows[3]["wheel.velocity_rpm"]) == ("0.030000", "3")
    assert rows[3]["wheel.voltage_v"] == ""
    assert not log.with_name("match.lcmlog.mcap").exists()
    assert "camera: 1 messages of other types than this rc10's" in done.stderr


def test_two_robots_get_a_table_each(log: Path) -> None:
    other = FakeDaemon("other", LcmLink("memq://"))
    more = log.with_name("more")
    writer = lcm.EventLog(str(more), "w")
    writer.write_event(START_US, "other.v1.state", other.state().encode())
    writer.close()
    log.write_bytes(log.read_bytes() + more.read_bytes())
    done = export(log, "--only", "csv")
    assert done.returncode == 0, done.stderr
    assert log.with_name("match.lcmlog.csv").exists()
    assert log.with_name("match.lcmlog.other.csv").exists()


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "No such file or directory"),
        (b"", "is no log of lcm-logger: it is empty"),
        (b"#!/bin/sh", "is no log of lcm-logger"),
    ],
)
def test_another_file_is_refused(tmp_path: Path, content: bytes | None, message: str) -> None:
    path = tmp_path / "x.lcmlog"
    if content is not None:
        path.write_bytes(content)
    done = export(path)
    assert done.returncode == 1
    assert message in done.stderr
    assert "Traceback" not in done.stderr


def test_a_log_that_was_cut_off_gives_what_it_has(log: Path) -> None:
    data = log.read_bytes()
    log.write_bytes(data[: len(data) // 2])
    done = export(log)
    assert done.returncode == 0, done.stderr
    messages, _ = read_back(log.with_name("match.lcmlog.mcap"))
    assert 10 < len(messages["/demo/state"]) < STATES
