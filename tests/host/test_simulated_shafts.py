"""A simulated shaft has gravity and end stops: a joint homes without hardware."""

from __future__ import annotations

from hostlib import Daemon
from hostlib.daemon import ARM

# Hangs at -90 degrees; its lower stop lies 30 degrees away: gravity pulls with half of its 0.3 N m.
SHOULDER = (
    ARM
    + """
      - name: shoulder
        model: M3508
        id: 1
        feedback_timeout_ms: 1000
        on_disable: coast
        angle_min_deg: 0
        angle_max_deg: 100
        simulated: {gravity_nm: 0.3, hangs_at_deg: -90, stop_min_deg: -60, stop_max_deg: 120,
                    inertia_kg_m2: 0.02, initial_angle_deg: -20}
modules:
  - {name: lift, type: joint, motor: shoulder, max_velocity_deg_s: 90, max_acceleration_deg_s2: 360,
     homing: stop, homing_velocity_rpm: -10, homing_current_a: 2}
"""
)


def test_a_joint_homes_at_the_stop_of_its_simulated_shaft() -> None:
    with Daemon(SHOULDER) as daemon:
        daemon.wait_ready()
        daemon.must("enable", "shoulder")
        with daemon.drive("signal", "lift", "home=1", "--for", "60s"):
            daemon.wait_motor(
                "shoulder",
                lambda motor: motor["zeroed"] and abs(float(motor["total_angle_deg"])) < 10.0,
                "has found the stop",
            )
        with daemon.drive("signal", "lift", "angle_deg=60", "--for", "60s"):
            shoulder = daemon.wait_motor(
                "shoulder",
                lambda motor: abs(float(motor["total_angle_deg"]) - 60.0) < 1.0,
                "moves up against gravity",
            )
            assert float(shoulder["current_a"]) > 0.0
        daemon.must("disable", "shoulder")
        # It falls, and the stop catches it: where the joint found 0.
        daemon.wait_motor(
            "shoulder",
            lambda motor: abs(float(motor["total_angle_deg"])) < 1.0 and motor["velocity_rpm"] == 0,
            "lies on its stop",
        )
