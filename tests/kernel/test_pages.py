# run-guest: --timeout 900
"""Commands that pages show for a CAN interface, typed on virtual ones in the page's order."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from guestlib import Candump, link_add, link_delete, wait_for
from hostlib.page import Block, blocks, blocks_run_by, robots
from hostlib.reader import Command, Reader, commands, only_command
from hostlib.shown import assert_shown
from hostlib.terminal import Terminal
from rig import REPO
from stage import Stage, motor

from rc10.fakes import FakeMotor
from rc10.fakes.vesc import FakeVesc

if TYPE_CHECKING:
    from collections.abc import Iterator

DOCS = REPO / "docs"
HERE = str(Path(__file__).relative_to(REPO))
HERO = """
robot: hero
realtime: preferred
buses:
  - name: chassis
    interface: can0
    motors:
      - {name: left, model: M3508, id: 1, zero: power_on}
"""


def mine(page: str) -> list[Block]:
    return blocks_run_by(HERE, DOCS / page)


@pytest.fixture
def reader(tmp_path: Path) -> Iterator[Reader]:
    with Reader(tmp_path) as reader:
        # Modules of other kernels are part of the guest's.
        modprobe = tmp_path / "root" / "modprobe"
        modprobe.write_text("#!/bin/sh\n")
        modprobe.chmod(0o755)
        yield reader


@pytest.fixture
def can0() -> Iterator[None]:
    """A virtual bus under the name of a real one."""
    link_add("can0")
    yield
    link_delete("can0")


class Delivered(FakeVesc):
    """A VESC as it is sold: it answers, and says nothing unasked."""

    def _tell(self, dt_s: float) -> None:
        pass


class Hand:
    """Turns an output shaft, at one turn a second."""

    def __init__(self, motor: FakeMotor) -> None:
        self.left_deg = 0.0
        self._motor = motor

    def step(self, dt_s: float) -> None:
        """Lets `dt_s` seconds pass."""
        turn_deg = min(self.left_deg, 360.0 * dt_s)
        self._motor.rotor_turns += turn_deg / 360.0 * self._motor.spec.model.gear_ratio
        self.left_deg -= turn_deg


# Pages of whose blocks the tests below choose by the command.
CHOSEN = {
    "rc10ctl.md": ("rc10ctl scan", "rc10ctl doctor", "rc10-stop"),
    "realtime.md": ("rc10ctl doctor",),
}


@pytest.mark.parametrize("page", CHOSEN)
def test_no_command_of_a_page_is_left(page: str) -> None:
    shown = [command.text for block in mine(page) for command in commands(block)]
    assert [text for text in shown if not any(word in text for word in CHOSEN[page])] == []


def printed_by(reader: Reader, command: Command, status: int = 0) -> str:
    done = reader.shell(command.text)
    assert done.returncode == status, f"{command.text}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def test_the_quick_start_drives_simulated_motors_on_a_virtual_bus(reader: Reader) -> None:
    link_delete("vcan0")
    before = next(b for b in blocks(DOCS / "quick-start.md") if b.text.startswith("export "))
    *set_up, shown = mine("quick-start.md")
    # The environment of its second section.
    reader.read(Block("sh", before.text.partition("\n")[0] + "\n"))
    for block in set_up:
        reader.read(block)
    dumped = printed_by(reader, only_command(shown)).splitlines()
    assert len(dumped) == 8
    assert {line.split()[1] for line in dumped} == {
        line.split()[1] for line in only_command(shown).output.splitlines()
    }


def found_by_doctor(reader: Reader, command: Command) -> str:
    """Its findings; the quality of this guest, which has just started, is not judged."""
    done = reader.shell(command.text)
    counts = re.search(r"^\d+ passed, \d+ warned, (\d+) failed$", done.stdout, re.M)
    assert counts, done.stdout + done.stderr
    assert done.returncode == (1 if int(counts[1]) else 0)
    return done.stdout


@pytest.mark.usefixtures("can0")
def test_the_first_motor_is_found_commissioned_and_turned(reader: Reader, tmp_path: Path) -> None:
    page = DOCS / "first-motor.md"
    (robot,) = robots(page)
    (tmp_path / "bench.yaml").write_text(robot)
    check, start, watch, turn = (b for b in blocks(page) if b.kind in ("sh", "console"))
    ready, scan, commission = mine("first-motor.md")
    reader.read(check)
    assert "can0 link: up" in found_by_doctor(reader, only_command(ready))
    wheel = motor("M3508:1")
    hand = Hand(wheel)
    with Stage({"can0": [wheel]}) as stage:
        stage.things.append(hand)
        assert_shown(only_command(scan), printed_by(reader, only_command(scan)))
        reader.read(start)
        reader.read(watch)
        spin = only_command(commission)
        with Terminal(["bash", "-ec", reader.script(spin.text)], reader.env()) as person:
            person.answer("Press Enter", "")
            hand.left_deg = 358.0
            wait_for(lambda: hand.left_deg == 0.0, 5.0, "the turn")
            person.answer("press Enter when", "")
            person.answer("Type its name to spin it: ", "wheel")
            assert person.end() == 0, person.text
        assert_shown(spin, person.text)
        for command in commands(turn):
            assert_shown(command, printed_by(reader, command))


@pytest.mark.usefixtures("can0")
def test_a_scan_that_hears_nothing_says_what_to_look_at(reader: Reader) -> None:
    _, scan, _ = mine("first-motor.md")
    said = printed_by(reader, only_command(scan))
    assert said.startswith("nothing was heard: check the drives' power, the wiring, ")
    said = printed_by(reader, Command("rc10ctl scan can0 --listen-only", ""))
    assert "VESC as delivered, RobStride and CyberGear may be silent too." in said


@pytest.mark.usefixtures("can0")
def test_a_scan_tells_drives_apart_and_what_a_silent_one_wants(reader: Reader) -> None:
    scan = next(c for b in mine("rc10ctl.md") for c in commands(b) if "scan" in c.text)
    with Stage({"can0": [motor("M3508:1"), motor("GM6020:2"), Delivered(42)]}):
        assert_shown(scan, printed_by(reader, scan))


@pytest.mark.usefixtures("can0")
def test_a_doctor_looks_at_the_computer_and_the_interfaces(reader: Reader, tmp_path: Path) -> None:
    (tmp_path / "robot.yaml").write_text(HERO)
    shown = [b for b in (*mine("rc10ctl.md"), *mine("realtime.md")) if "doctor" in b.text]
    asked = [command for block in shown for command in commands(block)]
    assert len(asked) == 3
    for command in asked:
        # A day takes a day even where waiting costs nothing.
        said = found_by_doctor(reader, Command(command.text.replace("86400", "20"), ""))
        assert re.search(r"^\w+ +kernel: ", said, re.M)


@pytest.mark.usefixtures("can0")
def test_the_last_word_is_kept_for_when_rc10d_is_dead(reader: Reader, tmp_path: Path) -> None:
    (tmp_path / "hero.yaml").write_text(HERO)
    stop = next(c for b in mine("rc10ctl.md") for c in commands(b) if "rc10-stop" in c.text)
    with Stage({"can0": [motor("M3508:1")]}):
        reader.serve("rc10d -c hero.yaml")
        assert_shown(stop, printed_by(reader, stop, status=1))


@pytest.mark.usefixtures("can0")
def test_a_black_box_is_replayed_on_a_virtual_bus(reader: Reader, tmp_path: Path) -> None:
    (tmp_path / "hero.yaml").write_text(HERO)
    with Stage({"can0": [motor("M3508:1")]}):
        reader.serve("rc10d -c hero.yaml")
        reader.run(Command("rc10ctl estop", ""))
        copy = wait_for(lambda: next(reader.run_dir.glob("*-estop.blackbox"), None), 5.0, "a copy")
    reader.replace["FILE"] = str(copy)
    (block,) = mine("blackbox.md")
    with Candump("vcan0") as bus:
        reader.read(block)
    assert {frame.id for frame in bus.frames()} == {0x201}


def test_the_fakes_of_the_python_package_are_motors_on_a_virtual_bus(reader: Reader) -> None:
    link_delete("vcan0")
    (block,) = blocks_run_by(HERE, REPO / "python" / "README.md")
    link, fakes = commands(block)
    reader.run(link)
    with Terminal(["bash", "-ec", reader.script(f"exec {fakes.text}")], reader.env()) as terminal:
        terminal.answer("ready", "")
        with Candump("vcan0") as bus:
            bus.wait_frame(lambda frame: frame.id == 0x201)
