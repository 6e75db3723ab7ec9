"""python-can's cyclic messages: the kernel sends four DM4310 a MIT command each millisecond.

The loop reads what is there, and gives the kernel the next command.
"""

import can
from pair import arguments, run

PERIOD_S = 0.001
NO_TORQUE = bytes([0x7F, 0xFF, 0x7F, 0xF0, 0x00, 0x00, 0x07, 0xFF])

options = arguments()
bus = can.Bus(interface="socketcan", channel=options.channel)
commands = [
    can.Message(arbitration_id=motor, is_extended_id=False, data=NO_TORQUE) for motor in range(1, 5)
]
tasks = [bus.send_periodic(command, PERIOD_S) for command in commands]


def cycle() -> None:
    """One millisecond."""
    while bus.recv(0) is not None:
        pass
    for task, command in zip(tasks, commands, strict=True):
        if isinstance(task, can.ModifiableCyclicTaskABC):  # SocketCAN's are
            task.modify_data(command)


run(options.seconds, cycle)
