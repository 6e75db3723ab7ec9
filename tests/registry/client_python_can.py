"""A program with python-can alone turns a simulated M3508, and prints what it has read as JSON."""

import json
import struct

import can


def next_feedback(bus: can.BusABC) -> tuple[int, int, int, int]:
    """Angle, rpm, current and temperature of the next frame of drive 1."""
    while True:
        message = bus.recv(1.0)
        assert message is not None, "the drive is silent"
        if message.arbitration_id == 0x201:
            counts, rpm, current, temperature_c, _ = struct.unpack(">HhhBB", message.data)
            return counts, rpm, current, temperature_c


def tell(bus: can.BusABC, raw: int) -> None:
    bus.send(
        can.Message(
            arbitration_id=0x200, is_extended_id=False, data=struct.pack(">4h", raw, 0, 0, 0)
        )
    )


with can.Bus(interface="socketcan", channel="vcan0") as bus:
    first = next_feedback(bus)
    for _ in range(300):
        tell(bus, 1000)
        turning = next_feedback(bus)
    for _ in range(100):
        tell(bus, 0)
        resting = next_feedback(bus)
print(json.dumps({"first": first, "turning": turning, "resting": resting}))
