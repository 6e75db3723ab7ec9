"""The black box: what a crash leaves, what is copied and when, and how it is read."""

from __future__ import annotations

import json
import os
import re
import shutil
import signal
import subprocess
from pathlib import Path
from typing import Any

import pytest
from hostlib import Daemon, Program, eventually
from hostlib.daemon import BIN, CONFIG, motor_of

Record = dict[str, Any]

NO_CORE = ("prlimit", "--core=0", "--")
CANDUMP = re.compile(r"^\(\d{10}\.\d{6}\) (chassis|gimbal) [0-9A-F]{3}#[0-9A-F]{16} [RT]$")


def records(daemon: Daemon, *file: str | Path) -> list[Record]:
    lines = daemon.must("blackbox", *map(str, file), "--json").splitlines()
    return [json.loads(line) for line in lines]


def kinds(of: list[Record], kind: str) -> list[Record]:
    return [record for record in of if record["kind"] == kind]


def copies(daemon: Daemon, cause: str) -> list[Path]:
    return sorted(daemon.state_dir.glob(f"host-*Z-{cause}.blackbox"))


def wait_copy(daemon: Daemon, cause: str) -> Path:
    return eventually(lambda: copies(daemon, cause), f"a copy because of {cause}")[0]


@pytest.mark.parametrize("number", [signal.SIGSEGV, signal.SIGKILL, signal.SIGABRT])
def test_what_happened_before_a_crash_is_there_to_the_last_tick(number: signal.Signals) -> None:
    with Daemon(prefix=NO_CORE) as daemon:
        daemon.wait_ready()
        daemon.must("enable", "wheel")
        with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s"):
            daemon.wait_motor("wheel", lambda m: m["velocity_rpm"] > 50, "turns")
            last_seen = daemon.state()
            daemon.program.signal(number)
            assert daemon.program.wait() == -number
        found = records(daemon)
    assert found[0]["kind"] == "recording"
    assert found[0]["ended"] is False
    assert found[0]["dropped"] == 0
    frames = kinds(found, "frame")
    # Nothing that anybody has seen is missing, although the io thread had no time to move it.
    assert frames[-1]["mono_us"] >= last_seen["mono_us"]
    sent = [f for f in frames if f["direction"] == "sent" and f["bus"] == "chassis"]
    received = [f for f in frames if f["direction"] == "received" and f["bus"] == "chassis"]
    assert len({f["mono_us"] for f in sent}) >= last_seen["tick"]
    assert sent[-1]["frame"].startswith("200#")
    assert {f["frame"].split("#")[0] for f in received} == {"201", "202"}
    setpoint = kinds(found, "setpoint")[-1]
    assert (setpoint["motor"], setpoint["mode"], setpoint["value"]) == ("wheel", "velocity", 60.0)
    assert kinds(found, "command")[-1]["client"] == "rc10ctl"
    assert kinds(found, "request")[0]["operation"] == "enable"
    wheel = [m for m in kinds(found, "motor") if m["motor"] == "wheel"][-1]
    assert (wheel["status"], wheel["command_unit"]) == ("ACTIVE", "A")
    assert "ENABLING -> ACTIVE" in [e["text"] for e in kinds(found, "event")]


def test_a_restart_keeps_the_box_of_a_run_that_crashed(daemon: Daemon) -> None:
    daemon.must("enable", "wheel")
    pid = daemon.pid
    daemon.kill()
    assert "crashed or was killed" in daemon.must("blackbox")
    daemon.start()
    copy = wait_copy(daemon, "crash")
    daemon.program.wait_line(f"last run ended without stopping: its black box is in {copy}")
    daemon.wait_ready()
    assert "crashed or was killed" in daemon.must("blackbox", copy)
    assert records(daemon, copy)[0]["pid"] == pid
    # And the new run records on its own.
    assert records(daemon)[0]["pid"] == daemon.pid
    assert "still recording" in daemon.must("blackbox")


def test_a_run_that_stopped_leaves_no_crash(daemon: Daemon) -> None:
    daemon.program.signal(signal.SIGTERM)
    assert daemon.program.wait() == 0
    assert "stopped in good order" in daemon.must("blackbox")
    daemon.start()
    daemon.wait_ready()
    daemon.must("estop")
    wait_copy(daemon, "estop")  # those of a crash come first
    assert copies(daemon, "crash") == []


def test_the_box_of_a_run_that_ended_is_found_beside_its_copies() -> None:
    """The quick start has one folder for both."""
    with Daemon(state_dir=".") as daemon:
        daemon.wait_ready()
        daemon.must("estop")
        daemon.program.wait_line(r"-estop\.blackbox")
        daemon.program.signal(signal.SIGTERM)
        assert daemon.program.wait() == 0
        assert "stopped in good order" in daemon.must("blackbox")


def test_an_estop_is_copied_with_what_followed(daemon: Daemon) -> None:
    daemon.must("enable")
    with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s"):
        daemon.wait_motor("wheel", lambda m: m["velocity_rpm"] > 50, "turns")
        daemon.must("estop")
    copy = wait_copy(daemon, "estop")
    daemon.program.wait_line(re.escape(str(copy)))
    found = records(daemon, copy)
    assert found[0]["cause"] == "estop"
    stop = next(e for e in kinds(found, "event") if e["text"].startswith("RUN -> ESTOP"))
    before = [f for f in kinds(found, "frame") if f["mono_us"] < stop["mono_us"]]
    after = [f for f in kinds(found, "frame") if f["mono_us"] > stop["mono_us"]]
    assert before
    assert len(after) > 10
    assert kinds(found, "robot")[-1]["state"] == "ESTOP"
    # Copies are for a fault and an e-stop each time, not for every tick in it.
    assert len(copies(daemon, "estop")) == 1


def test_an_estop_just_before_the_end_is_copied_too(daemon: Daemon) -> None:
    daemon.must("estop")
    daemon.program.signal(signal.SIGTERM)
    assert daemon.program.wait() == 0
    assert len(copies(daemon, "estop")) == 1


def test_a_full_disk_is_one_warning_and_no_harm() -> None:
    mount = 'mount -t tmpfs -o size=1m none "$RC10_STATE_DIR" && exec "$@"'
    with Daemon(prefix=("unshare", "--mount", "sh", "-c", mount, "sh")) as daemon:
        daemon.wait_ready()
        daemon.must("estop")
        warning = daemon.program.wait_line(r"the black box could not be copied \(estop\): .*")[0]
        assert str(daemon.state_dir) in warning
        assert "No space left on device" in warning
        # As the daemon sees that folder.
        assert list(Path(f"/proc/{daemon.pid}/root{daemon.state_dir}").iterdir()) == []
        tick = daemon.state()["tick"]
        daemon.must("clear")
        daemon.must("enable")
        daemon.wait_state(lambda s: s["tick"] > tick + 500, "ticks on")
        assert daemon.stats()["page_faults"] == 0
        assert "still recording" in daemon.must("blackbox")


def test_a_second_daemon_leaves_the_box_of_the_first_alone(daemon: Daemon) -> None:
    box = daemon.run_dir / "host.blackbox"
    inode = box.stat().st_ino
    with Program(BIN / "rc10d", "-c", daemon.config, env=daemon.env) as second:
        assert second.wait() == 1
    assert box.stat().st_ino == inode
    assert records(daemon)[0]["pid"] == daemon.pid


def test_a_run_folder_on_a_disk_does_too(tmp_path: Path) -> None:
    with Daemon(run_dir=tmp_path) as daemon:
        daemon.wait_ready()
        daemon.must("enable")
        active = "wheel", "ENABLING -> ACTIVE"

        def is_recorded() -> bool:
            events = kinds(records(daemon), "event")
            return active in [(event["source"], event["text"]) for event in events]

        # There the newest are in the file some milliseconds later.
        eventually(is_recorded, "the event in the file")
        daemon.kill()
        assert is_recorded()


def test_without_it_there_is_no_file() -> None:
    with Daemon("blackbox_mib: 0\n" + CONFIG.format(realtime="preferred")) as daemon:
        daemon.wait_ready()
        assert list(daemon.run_dir.glob("*.blackbox*")) == []
        ctl = daemon.ctl("blackbox")
        assert ctl.returncode == 1
        assert "no black box in" in ctl.stderr


def test_can_utils_read_the_log(daemon: Daemon, tmp_path: Path) -> None:
    daemon.wait_state(lambda s: s["tick"] > 500, "500 ticks")
    log, jsonl = map(Path, daemon.must("blackbox", "--out", tmp_path / "out").split())
    lines = log.read_text().splitlines()
    assert all(CANDUMP.match(line) for line in lines)
    assert lines == sorted(lines, key=lambda line: line.split()[0])
    frames = [r for r in map(json.loads, jsonl.read_text().splitlines()) if r["kind"] == "frame"]
    assert len(frames) == len(lines)
    if shutil.which("log2asc") is None:
        pytest.skip("log2asc is not installed: apt install can-utils")
    asc = subprocess.run(
        ["log2asc", "-I", str(log), "chassis", "gimbal"], capture_output=True, text=True, check=True
    ).stdout
    assert len(re.findall(r"^ *\d+\.\d+ +[12] +2[0-9A-F]{2} ", asc, re.MULTILINE)) == len(lines)


def test_a_damaged_file_is_an_error_that_says_so(daemon: Daemon, tmp_path: Path) -> None:
    file = tmp_path / "broken.blackbox"
    whole = (daemon.run_dir / "host.blackbox").read_bytes()
    for content, why in (
        (b"", "no black box"),
        (b"something else" * 10_000, "no black box"),
        (whole[:1_000_000], "cut off"),
        (whole[:40] + bytes(50) + whole[90:], "damaged"),
    ):
        file.write_bytes(content)
        ctl = daemon.ctl("blackbox", file)
        assert ctl.returncode == 1
        assert str(file) in ctl.stderr
        assert why in ctl.stderr
        assert ctl.stdout == ""


@pytest.mark.parametrize("left", [0, 100_000])
def test_a_box_that_somebody_cuts_off_ends_the_recording_and_not_the_torque(
    daemon: Daemon, left: int
) -> None:
    daemon.must("enable", "wheel")
    box = daemon.run_dir / "host.blackbox"
    with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s"):
        daemon.wait_motor("wheel", lambda m: m["velocity_rpm"] > 50, "turns")
        os.truncate(box, left)
        daemon.program.wait_line(re.escape(f"somebody has cut off {box}: nothing is recorded"))
        tick = daemon.state()["tick"]
        eventually(lambda: daemon.state()["tick"] > tick + 2000, "two seconds more")
        wheel = motor_of(daemon.state(), "wheel")
        assert wheel["status"] == "ACTIVE"
        assert wheel["velocity_rpm"] > 50
        assert daemon.ctl("blackbox").returncode != 0
        daemon.must("estop")
    daemon.program.signal(signal.SIGTERM)
    assert daemon.program.wait() == 0
    output = daemon.program.output
    assert output.count("somebody has cut off") == 1
    assert "could not be copied" not in output
    daemon.start()
    daemon.wait_ready()
    assert "ended without stopping" not in daemon.program.output
    daemon.must("blackbox")
