"""The package motorbridge with four DM4310: its own CAN socket, under a Python loop."""

from motorbridge import Controller  # type: ignore[import-not-found]
from pair import arguments, run

options = arguments()
bus = Controller(options.channel)
motors = [bus.add_damiao_motor(number, 16 + number, "4310") for number in range(1, 5)]
for motor in motors:
    motor.enable()


def cycle() -> None:
    """One millisecond."""
    for each in motors:
        each.send_mit(0.0, 0.0, 0.0, 0.0, 0.0)
        each.get_state()


run(options.seconds, cycle)
