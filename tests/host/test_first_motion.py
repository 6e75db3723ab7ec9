"""rc10ctl jog and commission: a person at a terminal moves a motor for the first time."""

from __future__ import annotations

import os
import pty
import subprocess
import termios
import threading
from typing import TYPE_CHECKING

from hostlib.daemon import BIN
from hostlib.program import eventually

if TYPE_CHECKING:
    from hostlib import Daemon
    from hostlib.daemon import Motor

RIGHT = b"\x1b[C"


# Not a geared motor: after a pause of this machine it has jumped, a fault, as it should be.
def yaw(daemon: Daemon) -> Motor:
    found: Motor = next(m for m in daemon.state()["motors"] if m["name"] == "yaw")
    return found


def test_a_motor_turns_as_long_as_an_arrow_is_held(daemon: Daemon) -> None:
    daemon.must("enable", "yaw")
    keyboard, terminal = pty.openpty()
    before = termios.tcgetattr(terminal)
    jog = subprocess.Popen(
        [BIN / "rc10ctl", "jog", "yaw", "--speed", "30", "--dead-man-ms", "2000"],
        stdin=terminal,
        stdout=subprocess.DEVNULL,
        env={**os.environ, **daemon.env},
    )
    try:
        eventually(lambda: yaw(daemon)["owner"] == "rc10ctl", "jog holds the motor")
        assert yaw(daemon)["target"] == 0

        def turning() -> bool:
            os.write(keyboard, RIGHT)
            return bool(yaw(daemon)["target"] == 30)

        eventually(turning, "it is told to turn")
        stands = {"target": 0, "mode": "velocity", "owner": "rc10ctl"}
        eventually(lambda: stands.items() <= yaw(daemon).items(), "the dead man's time is over")
        os.write(keyboard, b"q")
        assert jog.wait(20) == 0
        assert termios.tcgetattr(terminal) == before
        eventually(lambda: yaw(daemon)["mode"] == "coast", "it coasts")
    finally:
        jog.kill()
        jog.wait()
        os.close(keyboard)
        os.close(terminal)


def test_jog_needs_a_terminal(daemon: Daemon) -> None:
    done = daemon.ctl("jog", "wheel")
    assert done.returncode == 2
    assert "terminal" in done.stderr


class Person:
    """Who answers what rc10ctl commission asks, by what it prints."""

    def __init__(self, daemon: Daemon, *words: str) -> None:
        self.process = subprocess.Popen(
            [BIN / "rc10ctl", "commission", *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**os.environ, **daemon.env},
        )
        self.output = b""
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        while part := os.read(self.process.stdout.fileno(), 4096):
            self.output += part

    def answer(self, question: str, words: str) -> None:
        eventually(lambda: question.encode() in self.output, question)
        assert self.process.stdin is not None
        self.process.stdin.write(words.encode() + b"\n")
        self.process.stdin.flush()

    def end(self) -> int:
        code = self.process.wait(30)
        eventually(lambda: self.output.endswith(b"\n"), "all it printed")
        return code


def turn_by_hand(person: Person, daemon: Daemon, motor: str, angle_deg: float) -> None:
    """A simulated motor has no hand: its angle is given anew."""
    daemon.must("zero", motor, 0)
    person.answer("Press Enter", "")
    daemon.wait_state(lambda _: b"press Enter when" in person.output, "the second question")
    daemon.must("zero", motor, angle_deg)
    person.answer("press Enter when", "")


def test_a_motor_that_is_right_is_spun_and_disabled(daemon: Daemon) -> None:
    person = Person(daemon, "yaw", "--limit", "1A")
    turn_by_hand(person, daemon, "yaw", 358)
    person.answer("Type its name", "yaw")
    code = person.end()
    assert code == 0, person.output
    assert b"name, sign and ratio are right" in person.output
    assert b"it is ready" in person.output
    assert yaw(daemon)["status"] == "READY"


def test_nothing_is_enabled_without_the_name(daemon: Daemon) -> None:
    person = Person(daemon, "wheel")
    turn_by_hand(person, daemon, "wheel", 360)
    person.answer("Type its name", "weel")
    assert person.end() == 1
    assert b"nothing was enabled" in person.output


def test_another_motor_that_turned_is_named(daemon: Daemon) -> None:
    person = Person(daemon, "wheel")
    daemon.must("zero", "wheel", 0)
    turn_by_hand(person, daemon, "other", 360)
    assert person.end() == 1
    assert b"other turned by 360.0 deg, and wheel did not" in person.output


def test_other_motors_have_to_be_disabled(daemon: Daemon) -> None:
    daemon.must("enable", "yaw")
    done = daemon.ctl("commission", "wheel")
    assert done.returncode == 1
    assert "yaw" in done.stderr
    assert "rc10ctl disable" in done.stderr
