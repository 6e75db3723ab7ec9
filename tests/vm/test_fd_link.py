"""rc10d and real CAN FD controllers: both bit rates, FD mode, restarts, and advice.

can2 is the robot's bus; a simulated drive is on can3, at the other end of the wire. can0 knows
classic CAN only.
"""

from __future__ import annotations

import contextlib
import os
import re
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from guestlib import Proc, run, wait_for
from link_setup import link_details, set_link
from patience import PATIENCE_S
from robot_file import write_robot

if TYPE_CHECKING:
    from collections.abc import Iterator

BIN = Path(os.environ["RC10_BUILD"]) / "bin" if "RC10_BUILD" in os.environ else Path()

READY = "knee: OFFLINE -> READY"
FD = "dbitrate 5000000 fd on"
COMMAND = (
    "ip link set can2 down; "
    "ip link set can2 up type can bitrate 1000000 dbitrate 5000000 fd on restart-ms 0"
)


def config(
    tmp_path: Path, *, managed: bool, interface: str = "can2", data_bitrate: int = 5_000_000
) -> Path:
    return write_robot(
        tmp_path,
        f"""\
  - name: legs
    interface: {interface}
    data_bitrate: {data_bitrate}
    manage_link: {str(managed).lower()}
    motors:
      - name: knee
        model: moteus
        id: 1
        motor_kv_rpm_per_v: 304
        feedback_timeout_ms: 1000
        watchdog_ms: 1000
""",
    )


def set_up(iface: str, settings: str, *, unseen_by: Proc | None = None) -> None:
    set_link(iface, f"bitrate 1000000 listen-only off {settings} restart-ms 0", unseen_by=unseen_by)


@pytest.fixture(autouse=True)
def the_other_end() -> None:
    set_up("can3", FD)
    set_up("can2", "fd off")


@contextlib.contextmanager
def running(file: Path) -> Iterator[Proc]:
    """A drive on can3 and rc10d, which has seen it."""
    with Proc(BIN / "rc10-sim", "--bus", "legs=can3", "-c", file) as simulator:
        simulator.wait_line("^ready", PATIENCE_S)
        with Proc(BIN / "rc10d", "-c", file, env={"RC10_RUN_DIR": "/tmp/rc10"}) as process:
            process.wait_line(READY, PATIENCE_S)
            yield process


def missing() -> list[str]:
    """Differences from the configuration, then all findings."""
    text = link_details("can2")
    # Not its state: the emulated controller has no register of it.
    wanted = ["<FD", " bitrate 1000000 ", "dbitrate 5000000 ", "mtu 72", "restart-ms 0", "LOWER_UP"]
    absent = [words for words in wanted if words not in text]
    return [*absent, text] if absent else []


def is_as_configured() -> bool:
    return not missing()


def test_a_classic_interface_becomes_one_for_fd_and_stays_so(tmp_path: Path) -> None:
    file = config(tmp_path, managed=True)
    with running(file) as process:
        assert missing() == []
        assert "legs: can2 brought up at 1000000 bit/s, data 5000000 bit/s" in process.output()
        findings = Proc(
            BIN / "rc10ctl", "--json", "doctor", "--config", file, "--latency-seconds", "0"
        )
        with findings:
            findings.wait(PATIENCE_S)
        assert re.search(r"can2 FD mode.*on, data phase 5000 kbit/s", findings.output())

        set_up("can2", "dbitrate 2000000 fd on", unseen_by=process)
        process.wait_lines(
            "can2 is set to 2000000 bit/s in the data phase, the configuration says 5000000: "
            "can2 taken down and up at 1000000 bit/s, data 5000000 bit/s",
            READY,
            timeout_s=PATIENCE_S,
        )
        wait_for(is_as_configured, PATIENCE_S, "the configured data bit rate", poll_s=0.1)

        set_up("can2", "fd off listen-only on", unseen_by=process)
        process.wait_lines(
            "can2 has CAN FD off, the configuration has data_bitrate: can2 taken down",
            READY,
            timeout_s=PATIENCE_S,
        )
        wait_for(is_as_configured, PATIENCE_S, "CAN FD", poll_s=0.1)

        run("ip", "link", "set", "can2", "down")
        process.wait_lines(
            "interface down: can2 taken down and up at 1000000 bit/s, data 5000000",
            READY,
            timeout_s=PATIENCE_S,
        )
        assert missing() == []


def test_without_manage_link_the_command_is_told_and_helps(tmp_path: Path) -> None:
    file = config(tmp_path, managed=False)
    with Proc(BIN / "rc10d", "-c", file) as process:
        assert process.wait(PATIENCE_S) == 1
        told = re.search(r"does not take CAN FD frames; type: (.*)", process.output())
    assert told is not None
    assert told[1].strip() == COMMAND
    for command in told[1].strip().split("; "):
        run(*shlex.split(command))
    with running(file) as process:
        assert missing() == []
        set_up("can2", "dbitrate 2000000 fd on", unseen_by=process)
        process.wait_line(
            f"in the data phase, the configuration says 5000000; type: {re.escape(COMMAND)}",
            PATIENCE_S,
        )
        assert "dbitrate 2000000 " in link_details("can2")


def test_a_controller_for_classic_can_refuses_and_rc10d_says_why(tmp_path: Path) -> None:
    with Proc(BIN / "rc10d", "-c", config(tmp_path, managed=True, interface="can0")) as process:
        assert process.wait(PATIENCE_S) == 1
        said = process.output()
    assert (
        "bus 'legs': CAN interface 'can0': cannot set 1000000 bit/s, data 5000000 bit/s and CAN FD"
        in said
    )
    assert "Operation not supported" in said
    assert "the controller may know classic CAN only: remove data_bitrate" in said
    assert f"by hand: {COMMAND.replace('can2', 'can0')}" in said


def test_a_rate_that_the_clock_cannot_make_is_refused_and_the_bus_left_alone(
    tmp_path: Path,
) -> None:
    # 100 MHz / 7 Mbit/s is 14.3 quanta: the kernel takes 14, which is 2 % off.
    with Proc(
        BIN / "rc10d", "-c", config(tmp_path, managed=True, data_bitrate=7_000_000)
    ) as process:
        assert process.wait(PATIENCE_S) == 1
        said = process.output()
    assert "can2 is set to 7142857 bit/s in the data phase, the configuration says 7000000" in said
    assert "state STOPPED" in link_details("can2")


def test_a_classic_bus_takes_fd_away(tmp_path: Path) -> None:
    set_up("can2", FD)
    file = tmp_path / "robot.yaml"
    file.write_text(
        """\
robot: vm
realtime: preferred
scheduler: {rate_hz: 100}
lcm: {enabled: false}
buses:
  - name: chassis
    interface: can2
    sample_point: 0.8
    manage_link: true
    motors:
      - {name: left, model: M3508, id: 1, feedback_timeout_ms: 1000}
"""
    )
    with Proc(BIN / "rc10d", "-c", file, env={"RC10_RUN_DIR": "/tmp/rc10"}) as process:
        process.wait_line("can2 brought up at 1000000 bit/s", PATIENCE_S)
        text = link_details("can2")
    assert "<FD" not in text
    assert "mtu 16" in text
    assert "sample-point 0.800" in text
