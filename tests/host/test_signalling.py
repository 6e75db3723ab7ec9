"""rc10ctl signal: what ends it, and that it begins nothing anew."""

from __future__ import annotations

import contextlib
import signal
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon, Motor, Program
from hostlib.daemon import CONFIG, motor_of

if TYPE_CHECKING:
    from collections.abc import Iterator

LIFT = """
modules:
  - {name: lift, type: synchronised_pair, left: wheel, right: other, velocity_limit_rpm: 60}
"""
PAIR = ("wheel", "other")
HAVE_ENDED = "the inputs of module 'lift' have ended: "
LONG = "held up for more than 2 s"


@pytest.fixture(scope="module")
def lift() -> Iterator[Daemon]:
    with Daemon(CONFIG.format(realtime="preferred") + LIFT) as daemon:
        daemon.wait_ready()
        yield daemon


def turns(motor: Motor) -> bool:
    return abs(float(motor["velocity_rpm"]) - 20) < 3


def stands_without_torque(motor: Motor) -> bool:
    at_rest = {"status": "ACTIVE", "mode": "coast", "command_value": 0, "owner": ""}
    return at_rest.items() <= motor.items()


@contextlib.contextmanager
def copy_as(daemon: Daemon, copy: str) -> Iterator[None]:
    """The file with which the robot started, as rc10ctl sees it."""
    path = daemon.run_dir / "host.config"
    text = path.read_text()
    if copy == "not readable":
        path.unlink()
    elif copy == "with a module of another program":
        path.write_text(text.replace("synchronised_pair", "own_pair"))
    try:
        yield
    finally:
        path.write_text(text)


@contextlib.contextmanager
def signalling(daemon: Daemon) -> Iterator[Program]:
    """An rc10ctl signal that turns both motors."""
    daemon.must("clear")
    daemon.must("enable", *PAIR)
    try:
        with daemon.drive("signal", "lift", "velocity_rpm=20", "--for", "60s") as program:
            daemon.wait_motor("wheel", turns, "turns at 20 rpm")
            yield program
    finally:
        daemon.must("disable", *PAIR)
        daemon.wait_motors(lambda motor: abs(float(motor["velocity_rpm"])) < 1)


@contextlib.contextmanager
def held_up(daemon: Daemon) -> Iterator[Program]:
    """The same, stopped by a signal, until its inputs have lapsed."""
    with signalling(daemon) as program:
        program.signal(signal.SIGSTOP)
        since = daemon.state()["tick"]
        daemon.wait_state(lambda state: state["tick"] > since + 300, "its inputs have lapsed")
        yield program


@pytest.mark.parametrize(
    ("stop", "copy"),
    [
        (("disable", *PAIR), "readable"),
        (("disable", "other"), "readable"),
        (("estop",), "readable"),
        (("disable", "other"), "not readable"),
        (("disable", "other"), "with a module of another program"),
    ],
)
def test_a_signal_ends_with_what_stops_a_motor_of_its_module(
    lift: Daemon, stop: tuple[str, ...], copy: str
) -> None:
    with copy_as(lift, copy), signalling(lift) as program:
        lift.must(*stop)
        assert program.wait() == 1
        assert HAVE_ENDED in program.output


@pytest.mark.parametrize("copy", ["readable", "not readable"])
def test_a_signal_does_not_wait_in_an_estop_for_somebody_to_clear_it(
    lift: Daemon, copy: str
) -> None:
    lift.must("estop")
    with copy_as(lift, copy), lift.drive("signal", "lift", "velocity_rpm=20", "--for", "60s") as it:
        assert it.wait() == 1
        assert "the robot is in ESTOP: `rc10ctl clear`" in it.output
    lift.must("clear")


def test_a_signal_without_the_file_needs_no_motor_of_another_module(lift: Daemon) -> None:
    with copy_as(lift, "not readable"), signalling(lift) as program:
        assert motor_of(lift.state(), "yaw")["status"] == "READY"
        program.interrupt()
        assert program.wait() == 0, program.output


@pytest.mark.parametrize(
    ("stop", "copy"), [(("estop",), "readable"), (("disable", *PAIR), "not readable")]
)
def test_a_signal_does_not_go_on_with_motors_that_were_stopped_and_enabled_meanwhile(
    lift: Daemon, stop: tuple[str, ...], copy: str
) -> None:
    with copy_as(lift, copy), held_up(lift) as program:
        lift.must(*stop)
        lift.wait_motors(lambda motor: abs(float(motor["velocity_rpm"])) < 1)
        lift.must("clear")
        lift.must("enable", *PAIR)
        program.signal(signal.SIGCONT)
        assert program.wait() == 1
        assert HAVE_ENDED in program.output
        for name in PAIR:
            assert stands_without_torque(motor_of(lift.state(), name))


def test_a_signal_that_its_computer_holds_up_goes_on_while_nobody_has_stopped_it(
    lift: Daemon,
) -> None:
    with held_up(lift) as program:
        program.signal(signal.SIGCONT)
        lift.wait_state(
            lambda state: turns(motor_of(state, "wheel")) or LONG in program.output, "turns again"
        )


def test_a_signal_that_was_paused_for_long_begins_nothing_anew(lift: Daemon) -> None:
    with held_up(lift) as program:
        since = lift.state()["tick"]
        lift.wait_state(lambda state: state["tick"] > since + 2500, "a long pause")
        program.signal(signal.SIGCONT)
        assert program.wait() == 1
        assert LONG in program.output
        assert stands_without_torque(motor_of(lift.state(), "wheel"))
