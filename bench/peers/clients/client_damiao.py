"""The package damiao-motor with four DM4310: a thread of its own reads, the loop sends."""

from damiao_motor import DaMiaoController  # type: ignore[import-not-found]
from pair import arguments, run

options = arguments()
controller = DaMiaoController(channel=options.channel, bustype="socketcan")
motors = [
    controller.add_motor(motor_id=number, feedback_id=16 + number, motor_type="4310")
    for number in range(1, 5)
]
for motor in motors:
    if options.fd is not None:  # the drives of the counted guest begin a second later
        motor.ensure_control_mode("MIT")
    motor.enable()


def cycle() -> None:
    """One millisecond."""
    for each in motors:
        each.send_cmd_mit(
            target_position=0.0,
            target_velocity=0.0,
            stiffness=0.0,
            damping=0.0,
            feedforward_torque=0.0,
        )
        each.get_states()


run(options.seconds, cycle)
