"""The command line of the fake motors."""

from __future__ import annotations

import argparse
import random
import re
import signal
import sys
from typing import TYPE_CHECKING

import can

from rc10.arguments import Parser
from rc10.fakes.address import MotorSpec, check_collisions
from rc10.fakes.drives import Drives
from rc10.fakes.families import FAMILIES, family_spec
from rc10.fakes.models import GM6020
from rc10.fakes.motor import FakeMotor
from rc10.fakes.runner import MAX_RATE_HZ, Runner
from rc10.spelling import did_you_mean

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rc10.fakes.fake import Fake, FamilySpec

_EPILOG = """\
Motors are named by model and id, as given: M3508:1.

example: four wheels and a gimbal on a virtual bus
  sudo ip link add vcan0 type vcan && sudo ip link set vcan0 up
  python -m rc10.fakes --channel vcan0 --motor M3508:1 --motor M3508:2 --motor M3508:3 \\
      --motor M3508:4 --motor GM6020:7 --angle-deg GM6020:7=90

Prints a line that begins with "ready" when it runs, and a summary when it ends by itself, by
SIGINT or by SIGTERM.
"""


def _motor(text: str) -> MotorSpec | FamilySpec:
    try:
        return family_spec(text) or MotorSpec.parse(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _per_motor(text: str) -> tuple[str, float]:
    # NAME=VALUE, or NAME:VALUE in the way of --motor.
    parts = re.fullmatch(r"([\w-]+:\d+)[=:](.+)", text)
    try:
        if parts is not None:
            return parts[1], float(parts[2])
    except ValueError:
        pass
    raise argparse.ArgumentTypeError(
        f"{text!r}: give the name of a motor and a number, such as M3508:1=0.2"
    )


def _rate(text: str) -> float:
    rate_hz = float(text)
    if not 0 < rate_hz <= MAX_RATE_HZ:
        raise argparse.ArgumentTypeError(f"{text} is not within 0 to {MAX_RATE_HZ}")
    return rate_hz


def _parser() -> Parser:
    parser = Parser(
        prog="python -m rc10.fakes",
        description="Fake motors on a CAN bus.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add = parser.add_argument
    add("--interface", default="socketcan", help="python-can interface (default: socketcan)")
    add("--channel", default="vcan0", help="its channel (default: vcan0)")
    add(
        "--motor",
        action="append",
        required=True,
        type=_motor,
        metavar="MODEL:ID[:voltage]",
        help="a motor: M3508, M2006 or GM6020, its id, and for a GM6020 that takes voltages "
        "instead of currents that word; or a model of another family, which begins with "
        f"{', '.join(FAMILIES)}; repeat for more motors",
    )
    add("--rate-hz", type=_rate, default=1000.0, help="feedback of each motor (default: 1000)")
    add("--seed", type=int, default=0, help="of the rotors' positions and lost frames")
    add("--duration", type=float, metavar="S", help="end after so many seconds")
    for option, metavar, what in (
        ("--load-nm", "MOTOR=NM", "constant torque against positive rotation"),
        ("--angle-deg", "MOTOR=DEG", "initial angle of the output shaft (GM6020: 0, others: any)"),
        ("--silent-after", "MOTOR:SECONDS", "cut its cable: it neither sends nor hears any more"),
        ("--drop", "MOTOR=P", "lose its feedback frames with this probability"),
    ):
        add(option, action="append", default=[], type=_per_motor, metavar=metavar, help=what)
    add(
        "--command-timeout-ms",
        type=float,
        metavar="MS",
        help="no torque after so long without a command; without it the last one holds, since "
        "no watchdog of these drives is known",
    )
    return parser


def build_drives(options: argparse.Namespace) -> Drives:
    """Makes the motors that the command line asks for.

    Raises:
        ValueError: they cannot be on one bus, or an option names a motor that is not there.
    """
    check_collisions(options.motor)
    loads_nm = dict(options.load_nm)
    angles_deg = dict(options.angle_deg)
    names = [spec.name for spec in options.motor]
    for name in (*loads_nm, *angles_deg):
        if name not in names:
            raise ValueError(
                f"{name}: no such motor here; there are {', '.join(names)}"
                f"{did_you_mean(name, names)}"
            )
    timeout_ms = options.command_timeout_ms
    # Where the rotor of a geared motor stands when power comes on says nothing about its output.
    generator = random.Random(options.seed)
    motors: list[Fake] = []
    for spec in options.motor:
        if not isinstance(spec, MotorSpec):
            motors.append(
                spec.make(
                    initial_angle_deg=angles_deg.get(spec.name, 0.0),
                    load_nm=loads_nm.get(spec.name, 0.0),
                )
            )
            continue
        any_deg = generator.uniform(0.0, 360.0)
        motors.append(
            FakeMotor(
                spec,
                initial_angle_deg=angles_deg.get(
                    spec.name, 0.0 if spec.model is GM6020 else any_deg
                ),
                load_nm=loads_nm.get(spec.name, 0.0),
                command_timeout_s=None if timeout_ms is None else timeout_ms * 1e-3,
            )
        )
    return Drives(
        motors,
        silent_after_s=dict(options.silent_after),
        drop=dict(options.drop),
        seed=options.seed,
    )


def summary(drives: Drives, runner: Runner) -> str:
    """Returns what became of the motors, a line for each."""
    lines = [
        f"{motor.name}: commands={motor.commands} feedback={drives.sent[motor.name]} "
        f"dropped={drives.dropped[motor.name]} command={motor.command:.3f} "
        f"current_a={motor.current_a:.3f} velocity_rpm={motor.velocity_rpm:.2f} "
        f"angle_deg={motor.angle_deg:.2f} temperature_c={motor.temperature_c:.1f}"
        for motor in drives.motors
    ]
    lines.append(f"late_ticks={runner.late_ticks} lost_frames={runner.lost_frames}")
    return "\n".join(lines)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command line; returns the exit status."""
    parser = _parser()
    options = parser.parse_args(arguments)
    where = f"{options.interface}:{options.channel}"
    try:
        drives = build_drives(options)
    except ValueError as error:
        parser.error(str(error))
    try:
        if drives.fd:
            bus = can.Bus(interface=options.interface, channel=options.channel, fd=True)
        else:  # not every interface knows the word
            bus = can.Bus(interface=options.interface, channel=options.channel)
    except (can.CanError, OSError, ValueError) as error:
        print(
            f"{parser.prog}: cannot open {where}: {error}. For a virtual bus: sudo ip link add "
            f"{options.channel} type vcan && sudo ip link set {options.channel} up",
            file=sys.stderr,
        )
        return 1

    try:
        return _run(bus, drives, options.rate_hz, options.duration, where)
    except can.CanError as error:
        print(f"{parser.prog}: {where}: {error}", file=sys.stderr)
        return 1
    finally:
        bus.shutdown()


def _run(
    bus: can.BusABC, drives: Drives, rate_hz: float, duration_s: float | None, where: str
) -> int:
    stopped = False

    def stop(*_: object) -> None:
        nonlocal stopped
        stopped = True

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, stop)
    runner = Runner(bus, drives, rate_hz)
    print(f"ready: {' '.join(motor.name for motor in drives.motors)} on {where}", flush=True)
    runner.run(lambda: stopped, duration_s)
    print(summary(drives, runner), flush=True)
    return 0
