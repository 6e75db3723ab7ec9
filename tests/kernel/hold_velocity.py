"""A client program of its own, to be killed: commands one motor's velocity for ever."""

from __future__ import annotations

import sys

import rc10


def main() -> None:
    name, motor = sys.argv[1], sys.argv[2]
    velocity_rpm, validity_ms = float(sys.argv[3]), int(sys.argv[4])
    with rc10.connect(name, client="hold") as robot:
        robot.wait_for_state(10.0)
        robot.enable()
        print("holding", flush=True)
        for _ in robot.rate(100):
            robot.command({motor: rc10.velocity_rpm(velocity_rpm)}, validity_ms=validity_ms)


if __name__ == "__main__":
    main()
