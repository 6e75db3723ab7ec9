"""The package motorbridge turns simulated drives of three makers; prints as JSON what it read."""

import json
import time
from typing import Any

from motorbridge import Controller, Mode, Motor  # type: ignore[import-not-found]


def turn(motor: Motor, rad_s: float) -> dict[str, Any]:
    """State of the motor after a second at this speed, by a damping alone."""
    motor.enable()
    for _ in range(100):
        motor.send_mit(0.0, rad_s, 0.0, 1.0, 0.0)
        time.sleep(0.01)
    turning = motor.get_state()
    motor.disable()
    time.sleep(0.2)
    return {
        "rad_s": turning.vel if turning else None,
        "status": turning.status_code if turning else None,
    }


said: dict[str, Any] = {}
with Controller("vcan0") as bus:
    motor = bus.add_damiao_motor(4, 20, "4310")
    said["damiao_ranges"] = [motor.get_register_f32(rid) for rid in (21, 22, 23)]
    motor.ensure_mode(Mode.MIT)
    said["damiao"] = turn(motor, 3.0)
with Controller("vcan0") as bus:
    motor = bus.add_robstride_motor(127, 0xFD, "rs-00")
    said["robstride_ping"] = motor.robstride_ping()
    said["robstride_volts"] = motor.robstride_get_param_f32(0x701C)
    motor.ensure_mode(Mode.MIT)
    said["robstride"] = turn(motor, 3.0)
with Controller("vcan0") as bus:
    motor = bus.add_myactuator_motor(3, 0x243, "X8")
    motor.enable()
    for _ in range(100):
        motor.send_vel(3.0)
        time.sleep(0.01)
    seen = motor.get_state()
    said["myactuator"] = {"rad_s": seen.vel if seen else None}
    motor.disable()
print(json.dumps(said))
