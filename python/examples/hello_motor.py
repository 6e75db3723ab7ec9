"""Turns one motor for three seconds and prints how well it follows.

Start a robot first, for example rc10d with a simulated bus; then, with its name and a motor's:

    python hello_motor.py demo wheel --rpm 60
"""

from __future__ import annotations

import argparse

import rc10


def main() -> None:
    """Runs the example."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("robot", help="robot: in the daemon's configuration")
    parser.add_argument("motor", help="name of one of its motors")
    parser.add_argument("--rpm", type=float, default=60.0, help="at the output shaft (60)")
    parser.add_argument("--seconds", type=float, default=3.0, help="how long (3)")
    options = parser.parse_args()

    with rc10.connect(options.robot, client="hello-motor", at_end="disable") as robot:
        robot.wait_for_state()
        robot.enable(options.motor)
        watch = rc10.Watch(robot, options.motor)
        # The loop is what keeps the motor going: a command acts for 50 ms. It ends with an error
        # when somebody stops the motor.
        for t_s in robot.rate(50):
            if t_s > options.seconds:
                break
            if not watch.may_send():
                continue
            robot.command({options.motor: rc10.velocity_rpm(options.rpm)})
            motor = robot.motor(options.motor)
            print(
                f"{t_s:5.2f} s  target {motor.target:7.1f} rpm  "
                f"measured {motor.velocity_rpm:7.1f} rpm  {motor.current_a:6.2f} A"
            )
    # Leaving the block has let go of the motor and disabled it.


if __name__ == "__main__":
    try:
        main()
    except rc10.Rc10Error as error:
        raise SystemExit(f"hello_motor: {error}") from None
