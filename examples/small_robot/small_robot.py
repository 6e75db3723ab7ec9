"""A small robot: waits until the driver arms it, drives a square, aims, and fires three shots.

    WAIT_ARMED -> DRIVE -> AIM -> FIRE -> DONE      and SAFE, from each of them, on any trouble

    python small_robot.py ROBOT [--no-remote]       for example: python small_robot.py small

small_robot.cpp is the same in C++. The loops that need every millisecond are modules of rc10d
(robot.yaml); what is here decides 50 times a second what they are told. Nothing that it sends holds
for long: if this program ends or hangs, the chassis stands and the feeder rests.
"""

from __future__ import annotations

import argparse
import math
import time
from enum import Enum, auto

import rc10

SQUARE = ((0.3, 0.0), (0.3, 0.3), (0.0, 0.3), (0.0, 0.0))  # m
SPEED_M_S = 0.8
GAIN_PER_S = 4.0  # near a corner: m/s for each metre that is left
CLOSE_M = 0.03

YAW_DEG = 30.0
PITCH_DEG = 10.0
AIMED_DEG = 1.0

SHOTS = 3
DEG_PER_SHOT = 45.0  # as in robot.yaml
NEARLY = 0.2  # of a shot: the ball has left by then

RATE_HZ = 50
VALIDITY_MS = 200  # some periods: a message may get lost
FORGOTTEN_S = 0.5  # idle time after which the feeder has no shot left
SILENCE_S = 0.5  # older than this nothing is believed
PATIENCE_S = 15.0  # time limit of a state of the mission

CLIENT = "small-robot"
MODULES = ("remote", "base", "gimbal", "feeder")


class State(Enum):
    """The robot's program."""

    WAIT_ARMED = auto()
    DRIVE = auto()
    AIM = auto()
    FIRE = auto()
    DONE = auto()
    SAFE = auto()


ON_MISSION = (State.DRIVE, State.AIM, State.FIRE)


class SmallRobot:
    """The state machine."""

    def __init__(self, robot: rc10.Robot, has_remote: bool) -> None:
        self.robot = robot
        self.has_remote = has_remote
        self.remote = robot.module("remote")
        self.base = robot.module("base")
        self.gimbal = robot.module("gimbal")
        self.feeder = robot.module("feeder")
        self.state = State.WAIT_ARMED
        self.entered_s = time.monotonic()
        self.start_m = (0.0, 0.0)  # of the square, in the world
        self.corner = 0  # to which it drives
        self.start_deg = 0.0  # of the feeder's wheel
        self.shots = 0  # asked for so far
        self.firing_s = 0.0  # when the feeder last had a shot to fire

    def step(self) -> State:
        """One turn of the loop: looks, acts, and says where the robot is now."""
        trouble = self.find_trouble()
        on_mission = self.state in ON_MISSION
        if on_mission and trouble:
            self.enter(State.SAFE, trouble)
        elif on_mission and time.monotonic() - self.entered_s > PATIENCE_S:
            self.enter(State.SAFE, "it takes too long")
        elif (next_state := self.act(trouble)) is not self.state:
            self.enter(next_state)
        return self.state

    def act(self, trouble: str) -> State:
        """Does what the state is for. Returns the next state, or the same."""
        match self.state:
            case State.WAIT_ARMED:
                return self.wait_armed(trouble)
            case State.DRIVE:
                return self.drive()
            case State.AIM:
                return self.aim()
            case State.FIRE:
                return self.fire()
            case State.SAFE:
                return self.safe()
        return self.state

    def wait_armed(self, trouble: str) -> State:
        """The driver's switch enables the motors; without a remote, main() has done it."""
        return State.WAIT_ARMED if trouble else State.DRIVE

    def drive(self) -> State:
        """From corner to corner of the square, sideways too: the front looks ahead."""
        x_m = self.start_m[0] + SQUARE[self.corner][0] - self.base.state["x_m"]
        y_m = self.start_m[1] + SQUARE[self.corner][1] - self.base.state["y_m"]
        left_m = math.hypot(x_m, y_m)
        if left_m < CLOSE_M:
            self.corner += 1
            if self.corner == len(SQUARE):
                return State.AIM
        # At the set speed, and slower near the corner.
        per_s = min(SPEED_M_S / max(left_m, 1e-9), GAIN_PER_S)
        self.base.send(vx_m_s=per_s * x_m, vy_m_s=per_s * y_m, frame=1, validity_ms=VALIDITY_MS)
        return State.DRIVE

    def aim(self) -> State:
        """Turns the gimbal, and has the feeder begin to count."""
        self.point_gimbal()
        # Shots are counted from here; its first message fires nothing.
        self.feeder.send(shots=0, validity_ms=VALIDITY_MS)
        gimbal = self.gimbal.state
        aimed = (
            abs(gimbal["yaw_deg"] - YAW_DEG) < AIMED_DEG
            and abs(gimbal["pitch_deg"] - PITCH_DEG) < AIMED_DEG
        )
        return State.FIRE if aimed and self.feeder.state.owner == CLIENT else State.AIM

    def fire(self) -> State:
        """Three shots, counted by how far the feeder's wheel has turned."""
        self.point_gimbal()
        turned_deg = self.robot.motor("feeder_wheel").total_angle_deg - self.start_deg
        if self.feeder.state["shots_left"] > 0:
            self.firing_s = time.monotonic()
        elif time.monotonic() - self.firing_s > FORGOTTEN_S:
            # Our message lapsed once, or somebody else had the feeder: it forgets its shots then,
            # and begins to count anew. One more for each that is missing.
            self.shots += SHOTS - math.floor(turned_deg / DEG_PER_SHOT + NEARLY)
            self.firing_s = time.monotonic()
        self.feeder.send(shots=self.shots, validity_ms=VALIDITY_MS)
        return State.DONE if turned_deg > (SHOTS - NEARLY) * DEG_PER_SHOT else State.FIRE

    def safe(self) -> State:
        """Nothing is sent: what was given lapses, and the modules let go.

        Back again when the driver has seen it, which he shows by the arm switch: down, and then up.
        """
        if self.has_remote and self.remote.state["armed"] == 0:
            return State.WAIT_ARMED
        return State.SAFE

    def point_gimbal(self) -> None:
        """Gives the direction; the gimbal holds it by itself."""
        self.gimbal.send(yaw_deg=YAW_DEG, pitch_deg=PITCH_DEG, validity_ms=VALIDITY_MS)

    def find_trouble(self) -> str:
        """Reason why the robot must not go on; empty: all is well."""
        state = self.robot.state
        if state.age_s > SILENCE_S:
            return "no news of rc10d"
        if state.estopped:
            return "the robot is in ESTOP"
        if self.has_remote:
            remote = self.remote.state
            if remote.age_s > SILENCE_S:
                return "no news of the remote"
            if remote["connected"] != 1:
                return "the remote is lost"
            if remote["armed"] != 1:
                return "the driver has disarmed the robot"
        for motor in state.motors.values():
            if motor.status is not rc10.MotorStatus.ACTIVE:
                return f"{motor.name} is {motor.status.name}"
        return ""

    def enter(self, next_state: State, why: str = "") -> None:
        """Changes the state, and says so."""
        because = f": {why}" if why else ""
        print(f"{self.state.name} -> {next_state.name}{because}", flush=True)
        self.state = next_state
        self.entered_s = time.monotonic()
        if next_state is State.DRIVE:
            self.start_m = (self.base.state["x_m"], self.base.state["y_m"])
            self.corner = 0
        if next_state is State.FIRE:
            self.start_deg = self.robot.motor("feeder_wheel").total_angle_deg
            self.shots = SHOTS
            self.firing_s = self.entered_s


def run(name: str, has_remote: bool) -> int:
    """The program; returns its exit status."""
    with rc10.connect(name, client=CLIENT) as robot:
        robot.wait_for_state()
        small_robot = SmallRobot(robot, has_remote)
        for module in MODULES:
            robot.module(module).wait_for_state()
        if not has_remote:
            robot.enable()
        # Receives, and gives a turn 50 times a second.
        for _ in robot.rate(RATE_HZ):
            state = small_robot.step()
            if state is State.DONE:
                return 0
            # Without a driver nobody can say that all is well again.
            if state is State.SAFE and not has_remote:
                return 1
    # Leaving the block disables what this program has enabled.
    return 0


def main() -> int:
    """Reads the command line."""
    assert __doc__ is not None
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("robot", help="robot: in the daemon's configuration")
    parser.add_argument("--no-remote", action="store_true", help="enable the motors; no driver")
    options = parser.parse_args()
    return run(options.robot, not options.no_remote)


if __name__ == "__main__":
    try:
        raise SystemExit(main())
    except (rc10.Rc10Error, KeyboardInterrupt) as error:
        raise SystemExit(f"small_robot: {error}") from None
