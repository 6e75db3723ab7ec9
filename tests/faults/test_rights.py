"""Rights of clients: identities, rights, replayed and forged messages."""
# run-guest: --timeout 900

from __future__ import annotations

import contextlib
import socket
import time
from typing import TYPE_CHECKING

import pytest
from faultrig import (
    CONFIG,
    VALIDITY_MS,
    Stranger,
    Witness,
    client,
    ctl,
    daemon,
    datagram,
    drive,
    drives,
    proven,
    robot_under_test,
    witness,
)
from rig import wait_status
from test_clients import VELOCITY, wait_refusals

import rc10

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from guestlib import Proc

CLIENTS = """
clients:
  - {lcm: test, may: [command, clear], motors: [left, right, other]}
  - {lcm: low, may: [command], motors: [left], max_priority: 0}
  - {user: root, may: [command, clear, tune, configure]}
"""


@contextlib.contextmanager
def robot_with(tmp_path: Path, keys: str) -> Iterator[tuple[Proc, rc10.Robot, Witness]]:
    """The robot under test, with more keys at the end of its file."""
    config = tmp_path / "robot.yaml"
    config.write_text(CONFIG.read_text() + keys)
    with drives(), witness() as log, daemon(config) as process, client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable(["left", "other"])
        yield process, robot, log


@pytest.mark.parametrize(
    ("name", "motor", "priority", "words"),
    [
        ("stranger", "left", 0, "commands of a client that `clients` does not name"),
        ("low", "other", 0, "commands for a motor that `clients` does not give it"),
        ("low", "left", 5, "commands above the `max_priority` of their client"),
    ],
)
def test_commands_that_are_not_permitted(
    name: str, motor: str, priority: int, words: str, tmp_path: Path
) -> None:
    with robot_with(tmp_path, CLIENTS) as (_, robot, log):
        stranger = Stranger(name)
        for _ in range(20):
            stranger.command(motor, VELOCITY, 60.0, priority=priority)
            time.sleep(0.01)
        wait_refusals(robot, "not permitted", 20)
        assert log.last_torque_ns(motor) == 0
        log.check()
        proven(words, "refused, counted, told", None, None, 0)


def test_an_estop_of_a_client_without_rights(tmp_path: Path) -> None:
    with robot_with(tmp_path, CLIENTS) as (_, robot, log), client("stranger") as stranger:
        start_ns = time.time_ns()
        robot.command(left=rc10.velocity_rpm(60), validity_ms=500)
        time.sleep(0.05)
        asked_ns = time.time_ns()
        stranger.estop()
        time.sleep(0.1)
        log.driven(start_ns, asked_ns, "left", validity_ms=10)
        log.check()
        with pytest.raises(rc10.RequestRefused):
            stranger.clear()
        assert robot.wait_for_state(5.0).estopped
        proven(
            "e-stop of a client that may only observe",
            "rest, latched; its `clear` is refused",
            asked_ns,
            log.last_torque_ns("left"),
            10,
        )


def test_gains_while_tuning_is_locked(tmp_path: Path) -> None:
    with robot_with(tmp_path, "\ntuning: locked\n") as (_, robot, log):
        refused = ctl("gains", "left", "velocity.kp=0.3")
        assert refused.returncode != 0
        assert "`tuning: locked` at " in refused.stderr
        assert rc10.Condition.TUNING_LOCKED in robot.wait_for_state(5.0).conditions
        drive(robot, log, 0.2, left=rc10.velocity_rpm(60))
        log.check()
        proven("gains are changed with `tuning: locked`", "refused, told", None, None, 0)


def test_a_client_that_takes_the_name_of_a_module(tmp_path: Path) -> None:
    modules = """
modules:
  - {name: blink, type: gpio, chip: gpiochip9, inputs: [{name: limit, line: 0}]}
"""
    with robot_with(tmp_path, modules) as (_, robot, log):
        stranger = Stranger("blink")
        for _ in range(20):
            stranger.command("other", VELOCITY, 60.0)
            time.sleep(0.01)
        time.sleep(0.1)
        assert log.last_torque_ns("other") == 0
        assert robot.wait_for_state(5.0).motors["other"].owner == ""
        log.check()
        proven("commands under the name of a module", "refused, told", None, None, 0)


def recorded(seconds: float, robot: rc10.Robot, log: Witness) -> list[bytes]:
    """Datagrams of a client that drives, as whoever listens on LCM's group has them."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        udp.bind(("239.255.76.67", 7667))
        member = socket.inet_aton("239.255.76.67") + socket.inet_aton("127.0.0.1")
        udp.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, member)
        udp.setblocking(False)
        drive(robot, log, seconds, left=rc10.velocity_rpm(60))
        taken = []
        with contextlib.suppress(BlockingIOError):
            while True:
                taken.append(udp.recv(65536))
    return [data for data in taken if data[8:].startswith(b"faults.v1.command\0")]


def test_a_recording_of_a_clients_datagrams_is_played_again() -> None:
    with robot_under_test() as (_, robot, log):
        datagrams = recorded(0.2, robot, log)
        assert len(datagrams) >= 15
        last_ns = time.time_ns()
        time.sleep(1.0)
        assert log.last_torque_ns("left") <= last_ns + (VALIDITY_MS + 1) * 1_000_000
        for data in datagrams:
            datagram(data)
            time.sleep(0.01)
        wait_refusals(robot, "old sequence", len(datagrams))
        log.check()
        proven(
            "datagrams of a client, recorded and sent again",
            "refused, counted, told",
            None,
            None,
            0,
        )
