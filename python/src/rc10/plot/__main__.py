"""`python -m rc10.plot SIGNAL...`."""

from __future__ import annotations

import argparse

from rc10.arguments import Parser
from rc10.client import connect
from rc10.command_line import add_robot_arguments, add_signals_argument, find_robot, run
from rc10.signals import Signal

_EPILOG = """\
  python -m rc10.plot wheel.velocity_rpm wheel.target wheel.current_a
  python -m rc10.plot --png wheel.png --seconds 5 wheel.velocity_rpm
"""


def main() -> None:
    """Runs the tool."""
    parser = Parser(
        prog="python -m rc10.plot",
        description="Shows signals of a robot while they come, in a window or as a picture.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_signals_argument(parser, "*", "; none: the velocity of every motor")
    parser.add_argument("--window", type=float, default=10.0, help="seconds that it shows (10)")
    parser.add_argument("--png", metavar="FILE", help="record, and write a picture: no window")
    parser.add_argument("--csv", metavar="FILE", help="record, and write a table: no window")
    parser.add_argument("--seconds", type=float, default=5.0, help="how long to record (5)")
    add_robot_arguments(parser)
    options = parser.parse_args()
    if not (0 < options.seconds <= 3600 and 0 < options.window <= 3600):
        parser.error("--seconds and --window are above 0 and 3600 at most")

    def plot() -> None:
        name = find_robot(options.robot, options.url)
        with connect(name, options.url, client="rc10-plot") as robot:
            state = robot.wait_for_state()
            names = options.signals or [f"{motor}.velocity_rpm" for motor in state.motors]
            signals = [Signal.parse(text) for text in names]
            for signal in signals:
                signal.read(state)  # or UnknownMotor, before anything else
            if not (options.png or options.csv):
                from rc10.plot.live import show

                show(robot, signals, options.window)
                return
            recording = robot.record(options.seconds, dict.fromkeys(s.motor for s in signals))
            if options.csv:
                recording.to_csv(options.csv, names)
                print(f"wrote {options.csv}")
            if options.png:
                recording.save_png(options.png, *names)
                print(f"wrote {options.png}")

    run("plot", plot)


main()
