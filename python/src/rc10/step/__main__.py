"""`python -m rc10.step MOTOR MODE VALUE`."""

from __future__ import annotations

import argparse

from rc10.arguments import Parser
from rc10.client import connect
from rc10.command_line import add_robot_arguments, check_writable, find_robot, run
from rc10.printable import printable
from rc10.setpoints import Mode
from rc10.step.plan import MODES, StepPlan

_EPILOG = """\
The motor really moves. It is commanded for as long as this runs, with a lease that nobody of the
same priority can take; then it goes back to where it was. One that this has enabled is disabled in
the end and does its on_disable, another does its on_timeout; by Ctrl-C at once. A motor that was
stopped meanwhile is not driven on.

  python -m rc10.step wheel velocity 100 --enable --png step.png
  python -m rc10.step yaw angle 45 --relative --enable
  python -m rc10.step wheel current 1.5 --seconds 0.3 --csv step.csv
"""


def main() -> None:
    """Runs the tool."""
    parser = Parser(
        prog="python -m rc10.step",
        description="Runs a step on a live motor and judges how it follows.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("motor")
    parser.add_argument("mode", choices=[mode.name.lower() for mode in MODES])
    parser.add_argument("value", type=float, help="in rpm, deg or A, at the output shaft")
    parser.add_argument(
        "--relative", action="store_true", help="an angle counts from where the motor stands"
    )
    parser.add_argument(
        "--from",
        dest="base",
        type=float,
        default=0.0,
        metavar="VALUE",
        help="velocity or current before the step (0)",
    )
    parser.add_argument("--seconds", type=float, default=1.5, help="how long it lasts (1.5)")
    parser.add_argument(
        "--settle-percent", type=float, default=2.0, help="tolerance of the settling time (2)"
    )
    parser.add_argument(
        "--enable", action="store_true", help="enable the motor, and disable it in the end"
    )
    parser.add_argument("--png", metavar="FILE", help="write a figure")
    parser.add_argument("--csv", metavar="FILE", help="write every signal of the motor")
    add_robot_arguments(parser)
    options = parser.parse_args()

    def step() -> None:
        from rc10.step.run import run_step
        from rc10.step.table import text_of

        try:
            plan = StepPlan(
                options.motor,
                Mode[options.mode.upper()],
                options.value,
                relative=options.relative,
                base=options.base,
                seconds=options.seconds,
                tolerance=options.settle_percent / 100.0,
                enable=options.enable,
            )
        except ValueError as error:
            parser.error(str(error))
        for path in filter(None, (options.csv, options.png)):
            check_writable(path)
        if options.png:
            # Missing packages are named before the motor moves.
            from rc10.plot.figure import save_png
            from rc10.step.figure import figure_of
        name = find_robot(options.robot, options.url)
        with connect(name, options.url, client="rc10-step", at_end="disable") as robot:
            result = run_step(robot, plan)
        for line in text_of(result).splitlines():
            print(printable(line))
        if options.csv:
            result.recording.to_csv(options.csv)
            print(f"wrote {options.csv}")
        if options.png:
            save_png(figure_of(result), options.png)
            print(f"wrote {options.png}")

    run("step", step)


main()
