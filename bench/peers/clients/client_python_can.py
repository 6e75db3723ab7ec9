"""A loop with python-can alone: reads what is there, tells four DM4310 a MIT command each."""

import can
from pair import arguments, run

NO_TORQUE = bytes([0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x07, 0xFF])

options = arguments()
bus = can.Bus(interface="socketcan", channel=options.channel)


def cycle() -> None:
    """One millisecond."""
    while bus.recv(0) is not None:
        pass
    for motor in range(1, 5):
        bus.send(can.Message(arbitration_id=motor, is_extended_id=False, data=NO_TORQUE))


run(options.seconds, cycle)
