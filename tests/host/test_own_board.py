"""A board of one's own on a serial port: examples/own_board against the module serial_link."""

from __future__ import annotations

import json
import os
import shutil
import signal
import struct
import subprocess
import threading
import tty
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon
from hostlib.daemon import ARM, REPO

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

MOTOR = "      - {name: wheel, model: M3508, id: 1, feedback_timeout_ms: 1000}\n"
# Slow: a busy computer may hold the port up for longer than the 20 ms of the default rate.
TEXT = """
    protocol: text
    rate_hz: 10
    receive:
      - {name: range_m, message: range, scale: 0.001}
      - {name: measured_deg, message: claw}
    send:
      - {name: angle_deg, message: claw, min: 0, max: 90}
      - {name: speed, message: claw, place: 2, safe_value: 1}
"""
COBS = """
    protocol: cobs
    rate_hz: 10
    receive:
      - {name: range_m, message: 7, type: u16, scale: 0.001}
      - {name: measured_deg, message: 7, type: i16, scale: 0.1}
    send:
      - {name: angle_deg, message: 1, min: 0, max: 90}
      - {name: speed, message: 1, type: u8, safe_value: 1}
"""
MODBUS = """
    protocol: modbus
    address: 3
    receive:
      - {name: measured_deg, register: 0, type: i16, scale: 0.1}
      - {name: count, register: 4, type: u32, input_register: true}
    send:
      - {name: angle_deg, register: 100, type: i16, scale: 0.1, min: 0, max: 90}
"""


class Port:
    """A pseudo terminal: rc10d opens `path`, the board has the other end."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.board, self._robot = os.openpty()
        tty.setraw(self._robot)
        path.symlink_to(os.ttyname(self._robot))

    def unplug(self) -> None:
        self.path.unlink(missing_ok=True)
        for end in (self.board, self._robot):
            os.close(end)


def robot(port: Path, link: str) -> str:
    return f"{ARM}{MOTOR}modules:\n  - name: claw\n    type: serial_link\n    port: {port}{link}"


def outputs(daemon: Daemon) -> dict[str, float | None]:
    told = json.loads(daemon.must("modules", "--json"))
    found: dict[str, float | None] = told["modules"][0]["outputs"]
    return found


def owner(daemon: Daemon) -> str:
    found: str = json.loads(daemon.must("modules", "--json"))["modules"][0]["owner"]
    return found


def release(daemon: Daemon, *safe: str) -> None:
    """After a start a field obeys once it was commanded its safe value."""
    daemon.wait_state(lambda _: outputs(daemon)["connected"] == 1, "the port is there")
    daemon.must("signal", "claw", *safe, "--for", "100ms")


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The board's, for this computer."""
    if shutil.which("gcc") is None:
        pytest.skip("no gcc: scripts/install-deps.sh languages")
    built = tmp_path_factory.mktemp("board") / "board"
    flags = ["-std=c99", "-O1", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run(
        ["gcc", *flags, REPO / "examples" / "own_board" / "board.c", "-o", built], check=True
    )
    return built


@pytest.fixture(params=["TEXT", "COBS"])
def claw(request: pytest.FixtureRequest, program: Path, tmp_path: Path) -> Iterator[Daemon]:
    port = Port(tmp_path / "robot")
    board = subprocess.Popen([program, request.param, "-"], stdin=port.board)
    os.close(port.board)
    port.board = os.dup(port._robot)  # closed by unplug()
    try:
        with Daemon(robot(port.path, TEXT if request.param == "TEXT" else COBS)) as daemon:
            daemon.wait_ready()
            release(daemon, "angle_deg=0", "speed=1")
            yield daemon
    finally:
        board.kill()
        board.wait()
        port.unplug()


def test_a_board_reports_and_moves_where_it_is_told(claw: Daemon) -> None:
    claw.wait_state(lambda _: outputs(claw)["range_m"] == pytest.approx(1.25), "its range is heard")
    with claw.drive("signal", "claw", "angle_deg=45", "speed=2", "--for", "60s"):
        claw.wait_state(lambda _: outputs(claw)["measured_deg"] == pytest.approx(45), "it moves")
        assert outputs(claw)["speed"] == 2
    claw.wait_state(
        lambda _: outputs(claw)["measured_deg"] == pytest.approx(0), "nobody asks: its safe value"
    )
    assert outputs(claw)["errors"] == 0


def test_a_signal_that_its_computer_holds_up_goes_on(claw: Daemon) -> None:
    with claw.drive("signal", "claw", "angle_deg=45", "--for", "60s") as signalling:
        claw.wait_state(lambda _: outputs(claw)["measured_deg"] == pytest.approx(45), "it moves")
        signalling.signal(signal.SIGSTOP)
        held_up = claw.state()["tick"]
        claw.wait_state(lambda state: state["tick"] > held_up + 700, "its inputs have lapsed")
        claw.wait_state(lambda _: outputs(claw)["measured_deg"] == pytest.approx(0), "safe value")
        signalling.signal(signal.SIGCONT)
        claw.wait_state(lambda _: outputs(claw)["measured_deg"] == pytest.approx(45), "moves again")
        assert signalling.running


def test_an_estop_sends_the_safe_value_and_a_clear_alone_moves_nothing(claw: Daemon) -> None:
    with claw.drive("signal", "claw", "angle_deg=30", "--for", "60s") as signalling:
        claw.wait_state(lambda _: outputs(claw)["measured_deg"] == pytest.approx(30), "it moves")
        claw.must("estop")
        claw.wait_state(lambda _: outputs(claw)["measured_deg"] == pytest.approx(0), "it is safe")
        assert signalling.wait() == 1
    with claw.drive("signal", "claw", "angle_deg=30", "--for", "60s"):
        claw.wait_state(lambda _: owner(claw) == "rc10ctl", "it is commanded in the e-stop")
        claw.must("clear")
        assert outputs(claw)["angle_deg"] == 0


def test_a_board_that_was_unplugged_is_reported(program: Path, tmp_path: Path) -> None:
    port = Port(tmp_path / "robot")
    board = subprocess.Popen([program, "TEXT", "-"], stdin=port.board)
    try:
        with Daemon(robot(port.path, TEXT)) as daemon:
            daemon.wait_ready()
            daemon.wait_state(lambda _: outputs(daemon)["connected"] == 1, "the port is there")
            daemon.wait_state(lambda _: outputs(daemon)["range_m"] is not None, "it is heard")
            board.kill()
            board.wait()
            daemon.wait_state(lambda _: outputs(daemon)["range_m"] is None, "it is silent")
            daemon.program.wait_line("the board is silent")
    finally:
        board.kill()
        board.wait()
        port.unplug()


def crc(data: bytes) -> bytes:
    """CRC-16/MODBUS, lowest byte first."""
    value = 0xFFFF
    for byte in data:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ 0xA001 if value & 1 else value >> 1
    return struct.pack("<H", value)


class Slave(threading.Thread):
    """A Modbus slave with one holding register that follows register 100."""

    def __init__(self, descriptor: int) -> None:
        super().__init__(daemon=True)
        self.angle = 0
        self._descriptor = descriptor

    def run(self) -> None:
        data = b""
        try:
            while True:
                data += os.read(self._descriptor, 256)
                while len(data) >= 8:
                    question, data = data[:8], data[8:]
                    if crc(question[:6]) == question[6:]:
                        os.write(self._descriptor, self.answer(question))
        except OSError:
            return  # unplugged

    def answer(self, question: bytes) -> bytes:
        address, function, first, word = struct.unpack(">BBHH", question[:6])
        if function == 6 and first == 100:
            self.angle = word
            return question
        if function == 3:
            head = struct.pack(">BBBH", address, function, 2, self.angle)
        else:
            head = struct.pack(">BBBHH", address, function, 4, 1, 2)
        return head + crc(head)


def test_registers_of_a_modbus_slave_are_inputs_and_outputs(tmp_path: Path) -> None:
    port = Port(tmp_path / "robot")
    Slave(port.board).start()
    with Daemon(robot(port.path, MODBUS)) as daemon:
        daemon.wait_ready()
        daemon.wait_state(lambda _: outputs(daemon)["count"] == 65538, "it is read")
        release(daemon, "angle_deg=0")
        with daemon.drive("signal", "claw", "angle_deg=45.5", "--for", "60s"):
            daemon.wait_state(
                lambda _: outputs(daemon)["measured_deg"] == pytest.approx(45.5), "it is written"
            )
    port.unplug()


def test_a_mistake_is_named_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(robot(tmp_path / "port", TEXT.replace("place: 2, ", "")))
    with Daemon(ARM + MOTOR) as daemon:
        done = daemon.ctl("check", file)
    assert done.returncode == 1
    assert "send[1].place: 'angle_deg' has it already" in done.stdout + done.stderr
