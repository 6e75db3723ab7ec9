"""Buses in trouble and strangers on a bus: what rc10d sends, and what it tells."""

from __future__ import annotations

import json
import signal
import time
from pathlib import Path

import pytest
from guestlib import (
    Candump,
    Frame,
    Proc,
    link_add,
    link_delete,
    link_down,
    link_up,
    netem,
    netem_clear,
    run,
)
from rig import (
    BIN,
    C6XX_COMMAND,
    COMMAND_IDS,
    CONFIG,
    MS,
    ROBOT,
    client,
    commands,
    daemon,
    drive,
    enabled_robot,
    fakes,
    next_diagnostics,
    receiving,
    wait_status,
)

import rc10

# SO_SNDBUF has a minimum in the kernel: room for 6 or 7 frames.
MOST_IN_FLIGHT = 8


def bus_count(counter: str) -> int:
    (bus,) = json.loads(run(BIN / "rc10ctl", "--robot", ROBOT, "stats", "--json"))["buses"]
    return int(bus[counter])


def stall(process: Proc, robot: rc10.Robot, rules: str) -> None:
    """Take the wire away while `left` is driven."""
    drive(robot, 0.2, left=rc10.velocity_rpm(100))
    netem("vcan0", rules)
    process.wait_line("bus stalled", 5.0)


def driving(frames: list[Frame]) -> list[Frame]:
    return [frame for frame in commands(frames, C6XX_COMMAND) if any(frame.data)]


def test_an_interface_that_is_down_is_told_with_the_command_that_mends_it() -> None:
    with daemon() as process:
        link_down("vcan0")
        process.wait_line("bus interface down", 5.0)
        command = process.wait_line("vcan0 is down; type: (ip link set vcan0 up)", 5.0)
        # Nothing more of it, however long it lasts.
        time.sleep(10.0)
        run(*command[1].split())
        process.wait_line("bus (active|silent)", 5.0)
        assert process.output().count("vcan0 is down; type") == 1


def test_an_interface_that_is_down_at_the_start_is_told_too() -> None:
    link_down("vcan0")
    with daemon() as process:
        process.wait_line("vcan0 is down; type: ip link set vcan0 up", 5.0)
        link_up("vcan0")
        with fakes():
            process.wait_line("bus active", 5.0)


def test_a_service_waits_for_an_interface_that_comes_late() -> None:
    service = {"NOTIFY_SOCKET": "/tmp/no_systemd"}
    link_delete("vcan0")
    with Proc(BIN / "rc10d", "-c", CONFIG, env=service) as process:
        process.wait_line("CAN interface 'vcan0' is not there yet: waiting for it", 5.0)
        link_add("vcan0")
        process.wait_line("robot '.*' runs", 10.0)


def test_a_service_whose_interface_does_not_come_says_so_and_stops_when_told() -> None:
    service = {"NOTIFY_SOCKET": "/tmp/no_systemd"}
    link_delete("vcan0")
    try:
        with Proc(BIN / "rc10d", "-c", CONFIG, env=service) as process:
            process.wait_line("CAN interface 'vcan0': No such device", 15.0)
        with Proc(BIN / "rc10d", "-c", CONFIG, env=service) as process:
            process.wait_line("waiting for it", 5.0)
            process.signal(signal.SIGTERM)
            assert process.wait(5.0) == 0
    finally:
        link_add("vcan0")


@pytest.mark.parametrize("reader", ["tick", "thread"])
def test_a_stalled_bus_comes_back_with_rest_and_waits_to_be_enabled(reader: str) -> None:
    with enabled_robot(receiving(reader)) as (process, robot):
        stall(process, robot, "loss 100%")
        # The program goes on commanding; its motors are out of reach.
        drive(robot, 1.0, left=rc10.velocity_rpm(100))
        assert robot.motor("left").status is rc10.MotorStatus.OFFLINE
        assert bus_count("tx_held") > 1000
        with Candump("vcan0") as bus:
            netem_clear("vcan0")
            drive(robot, 1.0, left=rc10.velocity_rpm(100))
            bus.stop()
            assert len(commands(bus.frames(), C6XX_COMMAND)) > 500
            assert driving(bus.frames()) == []
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        drive(robot, 1.0, left=rc10.velocity_rpm(100))
        assert abs(robot.motor("left").velocity_rpm - 100) < 2


@pytest.mark.parametrize(("stalled_ms", "stalls"), [(5, True), (20, False)])
def test_a_bus_whose_echoes_are_late_is_stalled_after_the_time_that_it_has(
    stalled_ms: int, stalls: bool
) -> None:
    config = Path("/tmp/late_echoes.yaml")
    interface = "    interface: vcan0\n"
    config.write_text(
        CONFIG.read_text().replace(interface, f"{interface}    stalled_ms: {stalled_ms}\n")
    )
    with enabled_robot(config) as (process, robot):
        netem("vcan0", "delay 10ms limit 200")
        drive(robot, 0.5, left=rc10.velocity_rpm(100))
        assert ("bus stalled" in process.output()) == stalls
        kept = robot.motor("left").status is rc10.MotorStatus.ACTIVE
        assert kept != stalls


def test_a_stalled_bus_gets_no_frames_but_a_rest_probe() -> None:
    with enabled_robot() as (process, robot), Candump("vcan0") as bus:
        # A frame handed over now arrives, and is echoed, after the test has looked.
        stall(process, robot, "delay 3s")
        netem_ns = time.time_ns()
        drive(robot, 1.0, left=rc10.velocity_rpm(100))
        time.sleep(3.0)
        bus.stop()
        late = [f for f in bus.frames() if f.t_ns > netem_ns and f.id in COMMAND_IDS]
        # From before the stall: bounded. After it: rest only.
        stale = driving(late)
        assert 0 < len(stale) <= MOST_IN_FLIGHT
        assert stale[-1].t_ns - stale[0].t_ns <= 10 * MS


def test_taking_the_link_down_drops_what_was_in_flight() -> None:
    with enabled_robot() as (process, robot):
        stall(process, robot, "delay 3s")
        link_down("vcan0")
        link_up("vcan0")
        with Candump("vcan0") as bus:
            time.sleep(4.0)
            bus.stop()
            # Only what left after the link was up again comes out of the delay.
            assert commands(bus.frames(), C6XX_COMMAND)
            assert driving(bus.frames()) == []


def test_another_program_that_commands_the_motors_is_told() -> None:
    with fakes(), daemon() as process, client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        # The guard of a test before may rest a bus that carried nothing then, until it hands over.
        next_diagnostics(robot)
        run("cansend", "vcan0", "200#03E8000000000000")
        process.wait_line(r"1 frames .* \(0x200\) from another program on this", 5.0)
        assert bus_count("rx_foreign") == 1
        next_diagnostics(robot)
        assert any(event.code == 302 for event in robot.events())


def test_another_node_that_commands_the_motors_is_told_once_a_second() -> None:
    with daemon() as process:
        # To vcan0 a frame that the gateway brings from vcan1 comes from the wire.
        run("cangw", "-A", "-s", "vcan1", "-d", "vcan0", "-e")
        try:
            run("cangen", "vcan1", "-g", "10", "-n", "250", "-I", "2FE", "-L", "8")
        finally:
            run("cangw", "-F")
        time.sleep(1.5)
        told = [line for line in process.output().splitlines() if "another node on the bus" in line]
        assert 3 <= len(told) <= 4
        assert bus_count("rx_foreign") == 250


def test_a_vcan_interface_cannot_be_managed_and_it_says_why() -> None:
    managed = CONFIG.read_text().replace(
        "interface: vcan0", "interface: vcan0\n    manage_link: true"
    )
    config = Path("/tmp/managed.yaml")
    config.write_text(managed)
    with Proc(BIN / "rc10d", "-c", config) as process:
        assert process.wait(10.0) == 1
        assert "'vcan0': is no CAN controller (vcan)" in process.output()
        assert "remove manage_link" in process.output()
    # It was not touched.
    assert "UP" in run("ip", "link", "show", "vcan0")
