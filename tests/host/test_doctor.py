"""rc10ctl doctor, on whatever computer the tests run: what differs is not looked at."""

from __future__ import annotations

import json
import subprocess
from typing import TYPE_CHECKING, Any

from hostlib.daemon import BIN, REPO

if TYPE_CHECKING:
    from pathlib import Path

    from hostlib import Daemon


def doctor(*words: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [BIN / "rc10ctl", "doctor", *words], capture_output=True, text=True, timeout=60, check=False
    )


def findings(done: subprocess.CompletedProcess[str]) -> dict[str, dict[str, Any]]:
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    return {line["check"]: line for line in lines if "check" in line}


def test_it_needs_neither_daemon_nor_can() -> None:
    done = doctor("--json", "--config", REPO / "config" / "demo.yaml", "--latency-seconds", "0.05")
    found = findings(done)
    assert found["CAN interfaces"]["status"] == "pass"
    assert found["multicast route"]["status"] == "pass"  # tests/host/run makes the route
    assert "wake-up latency" in found
    for finding in found.values():
        assert (finding["fix"] is None) == (finding["status"] == "pass"), finding
    failed = any(finding["status"] == "fail" for finding in found.values())
    assert done.returncode == (1 if failed else 0)


def test_an_interface_that_is_not_there_fails() -> None:
    config = REPO / "config" / "four_wheels_can0.yaml"
    done = doctor("--json", "--config", config, "--latency-seconds", "0")
    assert done.returncode == 1
    found = findings(done)
    assert "can0 link" in found, done.stdout + done.stderr
    assert found["can0 link"]["status"] == "fail"


def test_a_wrong_configuration_is_told(tmp_path: Path) -> None:
    config = tmp_path / "bad.yaml"
    config.write_text("robot: [")
    done = doctor("--config", config)
    assert done.returncode == 1
    assert "bad.yaml:1" in done.stderr


def test_a_running_daemon_is_asked_for_its_own_latency(daemon: Daemon) -> None:
    done = daemon.ctl("doctor", "--json", "--config", daemon.config)
    assert "rc10d itself" in findings(done)["wake-up latency"]["why"]
    assert "histogram" not in done.stdout
