"""The joystick example, without a joystick."""

from __future__ import annotations

import math

import pytest

import rc10
from fake_daemon import FakeDaemon, setpoints
from joystick_teleop import Sticks, Teleop, drive, parse, shaped, wheels
from rc10.lcm_types import signals_t
from virtual_link import VirtualLink


class ScriptedPad:
    """Full ahead while the button is held: from the start for so many readings."""

    def __init__(self, held: int) -> None:
        self.left = held

    def read(self) -> Sticks:
        self.left -= 1
        return Sticks(1.0, 0.0, 0.0, dead_man=self.left >= 0)


def test_a_stick_is_quiet_in_its_middle_and_full_at_its_ends() -> None:
    assert shaped(0.05) == 0
    assert shaped(-0.08) == 0
    assert shaped(1.0) == 1
    assert shaped(-1.2) == -1
    assert 0 < shaped(0.5) < 0.5
    assert shaped(math.nan) == 0


def test_speeds_rise_slowly_and_stop_with_the_button() -> None:
    teleop = Teleop(per_second=2.0)
    ahead = Sticks(1.0, 0.0, -1.0, dead_man=True)
    assert teleop.step(ahead, 0.1) == pytest.approx((0.2, 0.0, -0.2))
    assert teleop.step(ahead, 0.1) == pytest.approx((0.4, 0.0, -0.4))
    assert teleop.step(Sticks(1.0, 0.0, 0.0, dead_man=False), 0.1) is None
    # From rest again.
    assert teleop.step(ahead, 0.1) == pytest.approx((0.2, 0.0, -0.2))


def test_wheels_keep_the_curve_when_they_are_at_their_limit() -> None:
    assert wheels(0.5, 0.0) == (0.5, 0.5)
    assert wheels(0.0, 0.5) == (-0.5, 0.5)
    left, right = wheels(1.0, 1.0)
    assert (left, right) == (0.0, 1.0)


def test_it_sends_only_while_the_button_is_held(robot: rc10.Robot, daemon: FakeDaemon) -> None:
    daemon.active = {"wheel", "yaw"}
    daemon.publish_states()
    options = parse(["demo", "--left", "wheel", "--right", "yaw", "--rpm", "100", "--seconds", "1"])
    drive(robot, ScriptedPad(25), options)
    assert len(daemon.commands) == 25
    speeds = [setpoints(command)["wheel"][1] for command in daemon.commands]
    assert speeds == sorted(speeds)
    assert speeds[-1] == pytest.approx(100)
    assert {c.validity_ms for c in daemon.commands} == {100}


def test_a_chassis_gets_its_inputs(robot: rc10.Robot, link: VirtualLink) -> None:
    received: list[signals_t] = []
    link.subscribe("demo.v1.base", lambda data: received.append(signals_t.decode(data)), 100)
    options = parse(["demo", "--module", "base", "--speed", "2", "--seconds", "1"])
    drive(robot, ScriptedPad(100), options)
    assert received[-1].names == ["vx_m_s", "vy_m_s", "wz_deg_s"]
    assert received[-1].values == pytest.approx([2.0, 0.0, 0.0])


def test_it_wants_to_know_what_to_drive() -> None:
    with pytest.raises(SystemExit):
        parse(["demo"])
