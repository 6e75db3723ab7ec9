"""docs/first-motor.md with `type: sim`: all that it shows of a motor, in its order."""

from __future__ import annotations

import re
import signal
from typing import TYPE_CHECKING

import pytest
from hostlib import Program, eventually
from hostlib.daemon import REPO
from hostlib.page import Block, blocks, blocks_run_by, robots
from hostlib.reader import Command, Reader, commands, only_command
from hostlib.shown import assert_shown
from hostlib.terminal import Terminal

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

PAGE = REPO / "docs" / "first-motor.md"
# As the page says; and a pause of this machine is no fault.
SIMULATED = {
    "interface: can0": "type: sim",
    "realtime: required": "realtime: preferred",
    "zero: power_on}": "zero: power_on, feedback_timeout_ms: 1000}",
}
TURNS = "rc10ctl set wheel velocity 20 --for 1min"


def bench() -> str:
    (text,) = robots(PAGE)
    for old, new in SIMULATED.items():
        assert old in text
        text = text.replace(old, new)
    return text


def plain() -> list[Block]:
    return [block for block in blocks(PAGE) if block.kind in ("sh", "console")]


@pytest.fixture
def reader(tmp_path: Path) -> Iterator[Reader]:
    (tmp_path / "bench.yaml").write_text(bench())
    with Reader(tmp_path) as reader:
        yield reader


def said(reader: Reader, command: str) -> str:
    done = reader.shell(command)
    return done.stdout + done.stderr


def wheel(reader: Reader, words: str) -> bool:
    """Whether its line of the state has these."""
    return words in said(reader, "rc10ctl watch --json --count 1")


# Some programs, on a machine that may be busy.
@pytest.mark.timeout(300)
def test_a_simulated_motor_is_commissioned_and_turned_as_the_page_shows(reader: Reader) -> None:
    check, start, watch, turn = plain()
    hand, whole_turn = blocks_run_by("tests/host/test_first_motor.py", PAGE)
    doctor, _, commission = blocks_run_by("tests/kernel/test_pages.py", PAGE)
    reader.read(check)
    # Its findings are of this computer; the latency test is cut short.
    findings = said(reader, only_command(doctor).text + " --latency-seconds 0.2")
    assert re.search(r"^\d+ passed, \d+ warned, \d+ failed$", findings, re.M), findings
    reader.read(start)
    reader.read(watch)
    turned = only_command(hand)
    assert_shown(turned, said(reader, turned.text))
    spin = only_command(commission)
    with Terminal(["bash", "-ec", reader.script(spin.text)], reader.env()) as person:
        person.answer("Press Enter", "")
        person.see("Turn it now")
        reader.run(only_command(whole_turn))
        person.answer("press Enter when", "")
        person.answer("Type its name to spin it: ", "wheel")
        assert person.end() == 0, person.text
    assert_shown(spin, person.text)
    for command in commands(turn):
        assert_shown(command, said(reader, command.text))


def turning(reader: Reader) -> Program:
    """The program that the page has turn the motor."""
    assert TURNS in PAGE.read_text(encoding="utf-8")
    reader.run(Command("rc10ctl enable wheel", ""))
    program = Program("bash", "-ec", reader.script(f"exec {TURNS}"), env=reader.env())
    eventually(lambda: wheel(reader, '"owner":"rc10ctl"'), "it turns")
    return program


@pytest.mark.timeout(300)
def test_all_that_stops_a_simulated_motor_stops_it_as_the_page_says(reader: Reader) -> None:
    reader.read(plain()[1])
    with turning(reader) as program:
        reader.run(Command("rc10ctl estop", ""))
        eventually(lambda: wheel(reader, '"mode":"coast"'), "it coasts")
        assert program.wait() != 0
    assert "ESTOP" in said(reader, "rc10ctl enable wheel")
    reader.run(Command("rc10ctl clear", ""))
    with turning(reader) as program:
        program.signal(signal.SIGKILL)
        program.wait()
        eventually(lambda: wheel(reader, '"mode":"coast"'), "it coasts")
    with turning(reader) as program:
        (rc10d,) = reader.servers
        rc10d.interrupt()
        assert rc10d.wait() == 0, rc10d.output
        assert program.wait() != 0
