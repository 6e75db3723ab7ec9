"""path_latency_client.cpp through LCM, in Python: path_latency_client.py ROBOT COUNT."""

from __future__ import annotations

import random
import sys
import time
from collections.abc import Callable

import rc10


def now_us() -> float:
    return time.monotonic_ns() / 1000


def send(robot: rc10.Robot, what: str, count: int, once: Callable[[int], None]) -> None:
    """Sends at times that have nothing to do with the tick, and prints each."""
    for i in range(count):
        time.sleep(random.uniform(0.004, 0.008))
        robot.spin()  # nobody else takes the states that have come
        sent_us = now_us()
        once(i)
        print(what, i, f"{sent_us:.1f}")


def main(name: str, count: int) -> None:
    with rc10.connect(name, client="bench-py") as robot:
        robot.wait_for_state()
        feeder = robot.module("feeder")

        def command(i: int) -> None:
            current_a = (1 if i % 2 == 0 else -1) * (0.1 + 0.0005 * i)
            robot.command(wheel=rc10.current_a(current_a))

        send(robot, "command", count, command)
        send(robot, "module", count, lambda i: feeder.send(velocity_rpm=20 + 0.01 * i))
        for i in range(count):
            state = robot.wait_for_state()
            print("state", i, f"{now_us() - state.mono_us:.1f}")


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
