"""The package damiao-motor turns a simulated DM4310, and prints what it has read as JSON."""

import json
import time

from damiao_motor import DaMiaoController  # type: ignore[import-not-found]

controller = DaMiaoController(channel="vcan0", bustype="socketcan")
motor = controller.add_motor(motor_id=4, feedback_id=20, motor_type="4310")
ranges = [motor.get_register(rid) for rid in (21, 22, 23)]
motor.ensure_control_mode("MIT")
motor.enable()
begun = None
for _ in range(100):
    motor.send_cmd_mit(
        target_position=0.0,
        target_velocity=3.0,
        stiffness=0.0,
        damping=1.0,
        feedforward_torque=0.0,
    )
    time.sleep(0.01)
    begun = begun or dict(motor.get_states())
turning = dict(motor.get_states())
motor.disable()
time.sleep(0.2)
motor.request_motor_feedback()
time.sleep(0.05)
stopped = dict(motor.get_states())
controller.shutdown()
print(
    json.dumps(
        {"ranges": ranges, "begun": begun, "turning": turning, "stopped": stopped}, default=str
    )
)
