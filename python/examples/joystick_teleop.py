"""Drives a robot with a joystick or gamepad: a chassis module, or wheels on the left and right.

    pip install './python[teleop]'
    python joystick_teleop.py hero --module base --enable a,b,c,d --speed 1.0 --turn 90
    python joystick_teleop.py demo --left front_left,rear_left --right front_right,rear_right

Hold the shoulder button (5) to drive. When it is let go, or the joystick is unplugged, or this
program dies, nothing is sent any more, and the motors do their `on_timeout` after 100 ms.
"""

from __future__ import annotations

import argparse
import math
from dataclasses import dataclass
from typing import Protocol

import rc10

_VALIDITY_MS = 100
_HZ = 50.0


@dataclass(frozen=True)
class Sticks:
    """Where they are, from -1 to 1: forward, to the left and counter-clockwise positive."""

    forward: float
    left: float
    turn: float
    dead_man: bool
    """The button that has to be held."""


class Pad(Protocol):
    """Something with sticks."""

    def read(self) -> Sticks:
        """Returns where they are now."""


class Gamepad:
    """A joystick that pygame knows; the layout is that of Xbox-like pads.

    Raises:
        rc10.Rc10Error: pygame or the joystick is missing.
    """

    def __init__(self, button: int) -> None:
        try:
            import pygame
        except ImportError:
            raise rc10.MissingPackage("a joystick", "pygame", "teleop") from None
        self._pygame = pygame
        self._button = button
        pygame.init()
        if not pygame.joystick.get_count():
            raise rc10.Rc10Error("no joystick: plug one in; `ls /dev/input/js*` shows it")
        self._stick = pygame.joystick.Joystick(0)

    def read(self) -> Sticks:
        """Returns where the sticks are now."""
        self._pygame.event.pump()
        if not self._pygame.joystick.get_count():
            return Sticks(0.0, 0.0, 0.0, dead_man=False)
        turn = self._stick.get_axis(3 if self._stick.get_numaxes() > 3 else 2)
        return Sticks(
            -self._stick.get_axis(1),
            -self._stick.get_axis(0),
            -turn,
            dead_man=bool(self._stick.get_button(self._button)),
        )


def shaped(value: float, dead_zone: float = 0.08, expo: float = 0.5) -> float:
    """Makes a stick quiet around its middle and gentle near it, and keeps its ends.

    Args:
        value: from -1 to 1.
        dead_zone: what the stick may be off its middle without effect.
        expo: 0 is linear, 1 is cubic.
    """
    beyond = (min(1.0, abs(value)) - dead_zone) / (1.0 - dead_zone)
    if not math.isfinite(value) or beyond <= 0.0:
        return 0.0
    return math.copysign((1.0 - expo) * beyond + expo * beyond**3, value)


class Slew:
    """Follows a value no faster than so much a second; starts at zero."""

    def __init__(self, per_second: float) -> None:
        self._per_second = per_second
        self.value = 0.0

    def step(self, wanted: float, dt_s: float) -> float:
        """Returns the next value."""
        most = self._per_second * dt_s
        self.value += max(-most, min(most, wanted - self.value))
        return self.value


class Teleop:
    """Makes speeds of sticks, from -1 to 1; None while the dead man's button is not held."""

    def __init__(self, per_second: float = 3.0) -> None:
        self._slews = [Slew(per_second) for _ in range(3)]

    def step(self, sticks: Sticks, dt_s: float) -> tuple[float, float, float] | None:
        """Returns forward, left and turn."""
        if not sticks.dead_man:
            # The next one driven starts from rest.
            for slew in self._slews:
                slew.value = 0.0
            return None
        wanted = (sticks.forward, sticks.left, sticks.turn)
        forward, left, turn = (
            slew.step(shaped(value), dt_s) for slew, value in zip(self._slews, wanted)
        )
        return forward, left, turn


def wheels(forward: float, turn: float) -> tuple[float, float]:
    """Returns the speeds of the left and the right side, neither beyond 1."""
    left, right = forward - turn, forward + turn
    most = max(1.0, abs(left), abs(right))
    return left / most, right / most


def drive(robot: rc10.Robot, pad: Pad, options: argparse.Namespace) -> None:
    """Drives until Ctrl-C, or for `options.seconds`."""
    teleop = Teleop()
    module = robot.module(options.module) if options.module else None
    last_s = 0.0
    for t_s in robot.rate(_HZ):
        speeds = teleop.step(pad.read(), t_s - last_s)
        last_s = t_s
        if speeds is not None and module is not None:
            forward, left, turn = speeds
            module.send(
                validity_ms=_VALIDITY_MS,
                vx_m_s=forward * options.speed,
                vy_m_s=left * options.speed,
                wz_deg_s=turn * options.turn,
            )
        elif speeds is not None:
            sides = zip((options.left, options.right), wheels(speeds[0], speeds[2]))
            orders = {
                name: rc10.velocity_rpm(speed * options.rpm)
                for names, speed in sides
                for name in names
            }
            robot.command(orders, validity_ms=_VALIDITY_MS)
        if options.seconds is not None and t_s >= options.seconds:
            return


def parse(words: list[str] | None = None) -> argparse.Namespace:
    """Reads the command line."""

    def names(text: str) -> list[str]:
        return [name for name in text.split(",") if name]

    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("robot", help="robot: in the daemon's configuration")
    parser.add_argument("--module", help="a chassis module")
    parser.add_argument("--enable", type=names, default=[], help="motors of the module: a,b")
    parser.add_argument("--speed", type=float, default=0.5, help="of the chassis, m/s (0.5)")
    parser.add_argument("--turn", type=float, default=60.0, help="of the chassis, deg/s (60)")
    parser.add_argument("--left", type=names, default=[], help="wheels on the left: a,b")
    parser.add_argument("--right", type=names, default=[], help="wheels on the right")
    parser.add_argument("--rpm", type=float, default=60.0, help="of the wheels (60)")
    parser.add_argument("--button", type=int, default=5, help="that has to be held (5)")
    parser.add_argument("--seconds", type=float, help="end after so long")
    options = parser.parse_args(words)
    if bool(options.module) == bool(options.left or options.right):
        parser.error("give either --module, or --left and --right")
    return options


def main() -> None:
    """Runs the example."""
    options = parse()
    pad = Gamepad(options.button)
    with rc10.connect(options.robot, client="joystick", priority=10, at_end="disable") as robot:
        robot.wait_for_state()
        # Never all: others may use the rest of the robot.
        motors = options.left + options.right + options.enable
        if motors:
            robot.enable(motors)
        else:
            print("nothing is enabled: --enable names the motors of the module")
        drive(robot, pad, options)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
    except rc10.Rc10Error as error:
        raise SystemExit(f"joystick_teleop: {error}") from None
