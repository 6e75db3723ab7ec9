"""`python -m rc10.stream --vofa udp://HOST:PORT SIGNAL...`."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from rc10.arguments import Parser
from rc10.client import connect
from rc10.command_line import add_robot_arguments, add_signals_argument, find_robot, run
from rc10.errors import Timeout
from rc10.signals import Signal
from rc10.stream.justfloat import justfloat
from rc10.stream.udp import UdpTarget

if TYPE_CHECKING:
    from rc10.state import RobotState

_EPILOG = """\
In VOFA+ choose the protocol JustFloat and the interface UDP with this local port; channel I0 is
the first signal. What a drive does not report is NaN.

  python -m rc10.stream --vofa udp://192.168.1.20:1347 wheel.target wheel.velocity_rpm
"""

_SILENCE_S = 5.0


def main() -> None:
    """Runs the tool."""
    parser = Parser(
        prog="python -m rc10.stream",
        description="Sends signals of a robot to VOFA+, a frame for each state.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    add_signals_argument(parser, "+", "")
    parser.add_argument("--vofa", metavar="udp://HOST:PORT", required=True, help="where VOFA+ is")
    parser.add_argument("--seconds", type=float, help="end after so long (default: at Ctrl-C)")
    add_robot_arguments(parser)
    options = parser.parse_args()

    def stream() -> None:
        signals = [Signal.parse(text) for text in options.signals]
        with UdpTarget(options.vofa) as target:
            name = find_robot(options.robot, options.url)
            with connect(name, options.url, client="rc10-stream") as robot:
                state = robot.wait_for_state()
                channels = [f"I{number} {signal}" for number, signal in enumerate(signals)]
                justfloat([signal.read(state) for signal in signals])  # or UnknownMotor
                print(f"{', '.join(channels)} -> {options.vofa}", flush=True)

                def send(state: RobotState) -> None:
                    target.send(justfloat([signal.read(state) for signal in signals]))

                end_s = None if options.seconds is None else robot.link.now() + options.seconds
                with robot.states_to(send):
                    while end_s is None or robot.link.now() < end_s:
                        robot.spin(0.1)
                        if robot.state.age_s > _SILENCE_S:
                            raise Timeout(
                                f"no state of robot '{name}' for {_SILENCE_S:g} s: did rc10d end?"
                            )

    run("stream", stream)


main()
