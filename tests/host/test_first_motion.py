"""rc10ctl jog and commission: a person at a terminal moves a motor for the first time."""

from __future__ import annotations

import os
import pty
import re
import signal
import subprocess
import termios
import threading
import time
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon
from hostlib.daemon import ARM, BIN, CONFIG
from hostlib.program import eventually
from hostlib.stalls import stood_still_since

import rc10

if TYPE_CHECKING:
    from collections.abc import Callable

    from hostlib.daemon import Motor

RIGHT = b"\x1b[C"
TRIES = 5
# The spin of a motor that has no load would be over sooner.
WHOLE_SECOND = ("--over-speed", "10000")


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
    """The person who answers rc10ctl commission, by its output."""

    def __init__(self, daemon: Daemon, *words: str) -> None:
        self.process = subprocess.Popen(
            [BIN / "rc10ctl", "commission", *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**os.environ, **daemon.env},
        )
        self.output = b""
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        while part := os.read(self.process.stdout.fileno(), 4096):
            self.output += part

    def sees(self, *one_of: str) -> None:
        def seen() -> bool:
            return any(words.encode() in self.output for words in one_of)

        eventually(lambda: seen() or self.process.poll() is not None, one_of[0])
        self.reader.join(0 if seen() else 30)
        assert seen(), self.output

    def answer(self, question: str, words: str) -> None:
        self.sees(question)
        assert self.process.stdin is not None
        self.process.stdin.write(words.encode() + b"\n")
        self.process.stdin.flush()

    def end(self) -> int:
        code = self.process.wait(30)
        self.reader.join(30)  # to the end of what it printed
        return code


def turn_by_hand(
    person: Person, daemon: Daemon, motor: str, angle_deg: float, stalled: bool = False
) -> None:
    if stalled:
        daemon.must("zero", motor, 0)
    person.answer("Press Enter", "")
    daemon.wait_state(lambda _: b"press Enter when" in person.output, "the second question")
    if stalled:  # no hand turns it: its angle is given anew
        daemon.must("zero", motor, angle_deg)
    else:
        daemon.must("hand", motor, "--by", angle_deg, "--rpm", 300)
    person.answer("press Enter when", "")


# After a pause of the computer: then it asks to commission again.
HIDES_A_TURN = b"nothing can be judged: commission again"


def in_the_spin(daemon: Daemon, *words: str, stalled: bool = False) -> Person:
    """The person who commissions yaw, at the first line that is shown of the spin."""
    for _ in range(TRIES):
        begin_s = time.monotonic()
        person = Person(daemon, "yaw", *words)
        turn_by_hand(person, daemon, "yaw", 360, stalled=stalled)
        person.sees("Type its name", HIDES_A_TURN.decode())
        if HIDES_A_TURN not in person.output:
            person.answer("Type its name", "yaw")
            person.sees("  current  target")
            return person
        person.end()
        assert stood_still_since(begin_s, "a turn by hand"), person.output
    pytest.fail("a pause in each turn by hand")


def commissioned(
    daemon: Daemon,
    *words: str,
    stalled: bool = False,
    meanwhile: Callable[[], None] = lambda: None,
) -> tuple[int, bytes]:
    """The whole commission of yaw."""
    for _ in range(TRIES):
        begin_s = time.monotonic()
        person = in_the_spin(daemon, *words, stalled=stalled)
        meanwhile()
        code = person.end()
        if HIDES_A_TURN not in person.output:
            return code, person.output
        assert stood_still_since(begin_s, "a spin"), person.output
    pytest.fail("a pause in each spin")


def test_a_motor_that_is_right_is_spun_and_disabled(daemon: Daemon) -> None:
    code, output = commissioned(daemon, "--limit", "1A")
    assert code == 0, output
    assert b"name, sign and ratio are right" in output
    assert b"it is ready" in output
    assert yaw(daemon)["status"] == "READY"


def test_nothing_is_enabled_without_the_name(daemon: Daemon) -> None:
    person = Person(daemon, "wheel")
    turn_by_hand(person, daemon, "wheel", 360)
    person.answer("Type its name", "weel")
    assert person.end() == 1
    assert b"nothing was enabled" in person.output


def test_another_motor_that_turned_is_named(daemon: Daemon) -> None:
    person = Person(daemon, "wheel")
    turn_by_hand(person, daemon, "other", 360)
    assert person.end() == 1
    assert re.search(rb"other turned by 3\d\d\.\d deg, and wheel did not", person.output)


def test_other_motors_have_to_be_disabled(daemon: Daemon) -> None:
    daemon.must("enable", "yaw")
    done = daemon.ctl("commission", "wheel")
    assert done.returncode == 1
    assert "yaw" in done.stderr
    assert "rc10ctl disable" in done.stderr


def test_a_motor_that_was_enabled_meanwhile_is_named_and_nothing_spins(daemon: Daemon) -> None:
    person = Person(daemon, "yaw")
    turn_by_hand(person, daemon, "yaw", 360)
    daemon.must("enable", "other")
    person.answer("Type its name", "yaw")
    assert person.end() == 1
    assert b"not the only one: `rc10ctl disable other` first" in person.output
    assert yaw(daemon)["status"] == "READY"


def test_over_speed_ends_the_spin_early_and_the_motor_is_ready(daemon: Daemon) -> None:
    code, output = commissioned(daemon, "--over-speed", "20")
    assert code == 0, output
    turned = re.search(rb"yaw turned by ([0-9.]+) deg the right way: it is ready", output)
    assert turned, output
    assert float(turned[1]) < 800  # 1640 in the whole second
    assert yaw(daemon)["status"] == "READY"


def test_a_motor_that_is_blocked_is_not_commissioned() -> None:
    blocked = CONFIG.format(realtime="preferred").replace(
        "profile: gm6020, id: 5", "profile: gm6020, id: 5, simulated: {stalled: true}"
    )
    with Daemon(blocked) as daemon:
        daemon.wait_ready()
        code, output = commissioned(daemon, stalled=True)
        assert code == 1
        assert b"it did not move: is it blocked" in output
        assert yaw(daemon)["status"] == "READY"


def test_ctrl_c_in_the_spin_disables_the_motor_and_says_that_it_is_not_commissioned(
    daemon: Daemon,
) -> None:
    person = in_the_spin(daemon, *WHOLE_SECOND)
    person.process.send_signal(signal.SIGINT)
    assert person.end() == 1
    assert b"stopped: it is disabled, and not commissioned" in person.output
    assert b"it is ready" not in person.output
    assert yaw(daemon)["status"] == "READY"


def test_nobody_enables_another_motor_in_the_spin_and_it_goes_on(daemon: Daemon) -> None:
    # Connected before: the spin lasts no longer than a second.
    with rc10.connect("host") as robot:
        robot.wait_for_state()

        def refuses_another() -> None:
            with pytest.raises(rc10.RequestFailed, match="locked while yaw is enabled alone"):
                robot.enable("other")

        code, output = commissioned(daemon, *WHOLE_SECOND, meanwhile=refuses_another)
    assert code == 0, output
    assert b"it is ready" in output
    daemon.must("enable", "other")


def test_a_commission_that_is_killed_in_the_spin_leaves_its_motor_ready_and_nothing_locked(
    daemon: Daemon,
) -> None:
    person = in_the_spin(daemon, *WHOLE_SECOND)
    person.process.kill()
    person.process.wait(30)
    rests = {"status": "READY", "command_value": 0, "owner": ""}
    eventually(lambda: rests.items() <= yaw(daemon).items(), "it is disabled")
    daemon.must("enable", "other")


def test_a_commission_that_is_held_up_in_the_spin_lets_the_motor_go_and_judges_nothing(
    daemon: Daemon,
) -> None:
    person = in_the_spin(daemon, *WHOLE_SECOND)
    person.process.send_signal(signal.SIGSTOP)
    coasts = {"status": "ACTIVE", "acting": "nothing", "owner": ""}
    eventually(lambda: coasts.items() <= yaw(daemon).items(), "it is let go")
    person.process.send_signal(signal.SIGCONT)
    assert person.end() == 1
    # The latter where this machine held it up for longer.
    assert HIDES_A_TURN in person.output or b"held up for more than 2 s" in person.output
    assert yaw(daemon)["status"] == "READY"


@pytest.mark.parametrize("line", ["on_timeout: damp", "on_disable: hold", "on_estop: brake"])
def test_a_motor_that_a_loop_would_catch_is_not_spun(line: str) -> None:
    config = CONFIG.format(realtime="preferred").replace("gm6020, id: 5", "gm6020, id: 5, " + line)
    with Daemon(config) as daemon:
        daemon.wait_ready()
        done = daemon.ctl("commission", "yaw")
        assert done.returncode == 1
        assert f"yaw has `{line}`: a loop that would act when the spin is over" in done.stderr
        assert f"write `{line.split(':')[0]}: coast` for now, restart rc10d" in done.stderr
        assert "Press Enter" not in done.stdout


def test_a_robot_whose_states_are_too_rare_for_the_over_speed_is_refused_with_the_key() -> None:
    rare = CONFIG.format(realtime="preferred").replace("state_hz: 100", "state_hz: 5")
    with Daemon(rare) as daemon:
        daemon.wait_ready()
        done = daemon.ctl("commission", "yaw")
        assert done.returncode == 1
        assert "`lcm: {state_hz: 5}` makes them too rare to end a spin in time" in done.stderr


def test_a_motor_without_the_mode_current_is_refused_with_the_setting_that_gives_it() -> None:
    arm = "      - {name: arm, model: DM4310, id: 1, master_id: 17, control: position_velocity}\n"
    with Daemon(ARM + arm) as daemon:
        eventually(lambda: daemon.ctl("list").returncode == 0, "rc10ctl list")
        done = daemon.ctl("commission", "arm")
        assert done.returncode == 1
        assert "'arm' has no mode current; it has coast,angle,total_angle,brake" in done.stderr
        assert "`control: mit`" in done.stderr
