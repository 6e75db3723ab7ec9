"""rc10d and a real controller driver: bit rates, restarts, and advice where it may not act.

can0 is the robot's bus; simulated drives are on can1, at the other end of the wire.
"""

from __future__ import annotations

import contextlib
import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from guestlib import Candump, Proc, netem, netem_clear, run, wait_for
from link_setup import link_details, set_link
from patience import PATIENCE_S
from robot_file import write_robot

if TYPE_CHECKING:
    from collections.abc import Iterator

BIN = Path(os.environ["RC10_BUILD"]) / "bin" if "RC10_BUILD" in os.environ else Path()

READY = "left: OFFLINE -> READY"

# An error frame that a program writes comes back as one, when the controller has sent it.
BUS_OFF = "20000040#0000000000000000"


def config(tmp_path: Path, *, managed: bool) -> Path:
    return write_robot(
        tmp_path,
        f"""\
  - name: chassis
    interface: can0
    manage_link: {str(managed).lower()}
    motors:
      - {{name: left, model: M3508, id: 1, feedback_timeout_ms: 1000}}
""",
    )


def set_bitrate(bitrate: int, restart_ms: int = 0, iface: str = "can0") -> None:
    set_link(iface, f"bitrate {bitrate} restart-ms {restart_ms}")


@pytest.fixture(autouse=True)
def settings_as_before() -> Iterator[None]:
    yield
    set_bitrate(1_000_000)


@contextlib.contextmanager
def daemon(file: Path, until: str = "robot 'vm' runs") -> Iterator[Proc]:
    with Proc(BIN / "rc10d", "-c", file, env={"RC10_RUN_DIR": "/tmp/rc10"}) as process:
        process.wait_line(until, PATIENCE_S)
        yield process


@contextlib.contextmanager
def running(file: Path) -> Iterator[Proc]:
    """Drives on can1 and rc10d, which has seen them."""
    with Proc(BIN / "rc10-sim", "--bus", "chassis=can1", "-c", file) as simulator:
        simulator.wait_line("^ready", PATIENCE_S)
        with daemon(file, READY) as process:
            yield process


def is_as_configured() -> bool:
    text = link_details("can0")
    return "bitrate 1000000 " in text and "restart-ms 0" in text and "state ERROR-ACTIVE" in text


def test_the_configured_bit_rate_wins_at_the_start(tmp_path: Path) -> None:
    set_bitrate(500_000, restart_ms=100)
    with running(config(tmp_path, managed=True)) as process:
        assert is_as_configured()
        assert "chassis: can0 brought up at 1000000 bit/s" in process.output()


def test_an_interface_that_was_never_up_is_brought_up(tmp_path: Path) -> None:
    run("ip", "link", "set", "can0", "down")
    with running(config(tmp_path, managed=True)):
        assert is_as_configured()


def test_an_interface_that_somebody_stops_is_started_again(tmp_path: Path) -> None:
    with running(config(tmp_path, managed=True)) as process:
        run("ip", "link", "set", "can0", "down")
        process.wait_lines(
            "bus interface down",
            "interface down: can0 taken down and up at 1000000 bit/s",
            READY,
            timeout_s=PATIENCE_S,
        )
        assert is_as_configured()


def test_another_bit_rate_while_it_runs_is_mended(tmp_path: Path) -> None:
    with running(config(tmp_path, managed=True)) as process:
        set_link("can0", "bitrate 500000 restart-ms 0", unseen_by=process)
        process.wait_line("500000 bit/s.*: can0 taken down and up at 1000000 bit/s", PATIENCE_S)
        wait_for(is_as_configured, PATIENCE_S, "the configured bit rate", poll_s=0.1)


def test_modes_in_which_frames_get_lost_are_taken_away(tmp_path: Path) -> None:
    with running(config(tmp_path, managed=True)) as process:
        set_link(
            "can0",
            "bitrate 1000000 one-shot on presume-ack on restart-ms 0",
            unseen_by=process,
        )
        process.wait_line(
            "the mode one-shot on: .*: can0 taken down and up at 1000000 bit/s", PATIENCE_S
        )
        wait_for(
            lambda: (
                "ONE-SHOT" not in link_details("can0")
                and "PRESUME-ACK" not in link_details("can0")
                and is_as_configured()
            ),
            PATIENCE_S,
            "modes of a robot's bus",
            poll_s=0.1,
        )


def test_bus_off_ends_in_a_restart(tmp_path: Path) -> None:
    with running(config(tmp_path, managed=True)) as process:
        run("cansend", "can0", BUS_OFF)
        process.wait_lines(
            "bus bus-off",
            "left: READY -> OFFLINE",
            "bus-off: can0 taken down and up at 1000000 bit/s",
            READY,
            timeout_s=PATIENCE_S,
        )


def test_a_stalled_bus_is_restarted_until_its_frames_reach_the_wire(tmp_path: Path) -> None:
    with running(config(tmp_path, managed=True)) as process:
        netem("can0", "loss 100%")
        try:
            process.wait_line("bus stalled", PATIENCE_S)
            for _ in range(3):
                process.wait_line("stalled: can0 taken down and up", PATIENCE_S)
        finally:
            netem_clear("can0")
        with Candump("can1") as wire:
            frame = wire.wait_frame(lambda frame: frame.id == 0x200, PATIENCE_S)
        assert not any(frame.data)


def test_without_manage_link_it_says_what_to_type_and_that_helps(tmp_path: Path) -> None:
    set_bitrate(500_000)
    with daemon(config(tmp_path, managed=False)) as process:
        assert "bitrate 500000 " in link_details("can0")
        line = process.output().replace("\n", " ")
        assert "can0 is set to 500000 bit/s, the configuration says 1000000; type: ip link" in line
        run("ip", "link", "set", "can0", "down")
        told = process.wait_line(r"can0 is down; type: (ip link set can0 up [^(]*) \(", PATIENCE_S)
        run(*shlex.split(told[1]))
        wait_for(is_as_configured, PATIENCE_S, "the configured bit rate", poll_s=0.1)
        process.wait_line("bus (active|silent)", PATIENCE_S)


def test_a_driver_that_restarts_by_itself_is_told(tmp_path: Path) -> None:
    set_bitrate(1_000_000, restart_ms=100)
    with daemon(config(tmp_path, managed=False)) as process:
        assert "can0 restarts by itself 100 ms after bus-off" in process.output()


def test_bus_off_is_not_believed_when_the_driver_knows_better(tmp_path: Path) -> None:
    with running(config(tmp_path, managed=False)) as process:
        run("cansend", "can0", BUS_OFF)
        process.wait_line("bus bus-off", PATIENCE_S)
        process.wait_line("bus active", PATIENCE_S)
        process.wait_line(READY, PATIENCE_S)


def test_without_the_right_to_do_it_the_start_fails_and_says_how_to_get_it(tmp_path: Path) -> None:
    command = ["setpriv", "--bounding-set=-net_admin", "--inh-caps=-net_admin"]
    with Proc(*command, BIN / "rc10d", "-c", config(tmp_path, managed=True)) as process:
        assert process.wait(PATIENCE_S) == 1
        assert "CAP_NET_ADMIN" in process.output()
        assert "AmbientCapabilities" in process.output()
    assert "state ERROR-ACTIVE" in link_details("can0")
