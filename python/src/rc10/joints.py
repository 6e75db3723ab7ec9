"""Several motors as NumPy arrays in radians, for policies and other code that thinks in vectors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rc10.errors import InvalidSetpoint, MissingPackage
from rc10.radians import deg, rad, rad_s, rpm
from rc10.setpoints import Mode, Setpoint

try:
    import numpy as np
except ImportError as error:
    raise MissingPackage("joints()", "numpy", "numpy") from error

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import ArrayLike, NDArray

    from rc10.robot_client import RobotClient

    FloatArray = NDArray[np.float64]


class Joints:
    """Motors of one robot in an order of your own; Robot.joints() makes it.

    Angles are multi-turn, at the output shaft, counter-clockwise positive. Each reading is of the
    newest state received, and a new array; NaN is what a drive does not report.
    """

    def __init__(self, robot: RobotClient, names: Iterable[str]) -> None:
        self.names = tuple(names)
        if not self.names:
            raise ValueError("no motors named: give at least one name")
        if len(set(self.names)) < len(self.names):
            raise ValueError(f"a motor stands twice in {', '.join(self.names)}")
        self._robot = robot

    def __len__(self) -> int:
        return len(self.names)

    @property
    def q(self) -> FloatArray:
        """Angles in rad."""
        return rad(self._read("total_angle_deg"))

    @property
    def dq(self) -> FloatArray:
        """Velocities in rad/s."""
        return rad_s(self._read("velocity_rpm"))

    @property
    def tau(self) -> FloatArray:
        """Torques in N·m."""
        return self._read("torque_nm")

    def command(
        self,
        q: ArrayLike | None = None,
        dq: ArrayLike | None = None,
        kp: ArrayLike | None = None,
        kd: ArrayLike | None = None,
        tau: ArrayLike | None = None,
        *,
        validity_ms: int = 0,
    ) -> None:
        """Sends one message for all of them. A number counts for each, an array has one for each.

        With `kp` or `kd` the drive is a spring and a damper: kp (q - angle) + kd (dq - velocity)
        + tau; without `q` around the present angle. Without both, `q` is an angle for the
        position loop, with `dq` and `tau` added to it; `dq` without `q` a velocity, with `tau`
        added; `tau` alone a torque.

        Args:
            q: angles in rad.
            dq: velocities in rad/s.
            kp: stiffness in N·m/rad.
            kd: damping in N·m·s/rad.
            tau: torques in N·m.
            validity_ms: as in Robot.command().

        Raises:
            InvalidSetpoint: a number that is not finite; the message names the motor.
            ValueError: nothing given, or an array of another length.
            CommandRefused, UnknownMotor: as Robot.command().
        """
        given = {"q": q, "dq": dq, "kp": kp, "kd": kd, "tau": tau}
        vectors = {
            name: self._vector(name, value) for name, value in given.items() if value is not None
        }
        if not vectors:
            raise ValueError("give at least one of q, dq, kp, kd and tau")
        impedance = "kp" in vectors or "kd" in vectors
        if impedance and "q" not in vectors:
            vectors["q"] = self._vector("q", self.q)
        none = np.zeros(len(self))
        angle_deg = deg(vectors.get("q", none))
        velocity_rpm = rpm(vectors.get("dq", none))
        torque_nm = vectors.get("tau", none)
        stiffness, damping = vectors.get("kp", none), vectors.get("kd", none)
        orders = {}
        for i, name in enumerate(self.names):
            tau_nm = float(torque_nm[i])
            if impedance:
                orders[name] = Setpoint(
                    Mode.IMPEDANCE,
                    float(angle_deg[i]),
                    float(velocity_rpm[i]),
                    tau_nm,
                    float(stiffness[i]),
                    float(damping[i]),
                )
            elif "q" in vectors:
                orders[name] = Setpoint(
                    Mode.TOTAL_ANGLE, float(angle_deg[i]), float(velocity_rpm[i]), tau_nm
                )
            elif "dq" in vectors:
                orders[name] = Setpoint(Mode.VELOCITY, float(velocity_rpm[i]), torque_ff_nm=tau_nm)
            else:
                orders[name] = Setpoint(Mode.CURRENT, torque_ff_nm=tau_nm)
        self._robot.command(orders, validity_ms=validity_ms)

    def _read(self, signal: str) -> FloatArray:
        state = self._robot.state
        return np.array([getattr(state.motor(name), signal) for name in self.names])

    def _vector(self, name: str, value: ArrayLike) -> FloatArray:
        array = np.asarray(value, dtype=np.float64)
        if array.shape not in ((), (len(self),)):
            raise ValueError(
                f"{name} has the shape {array.shape}: give a number, or an array of {len(self)}, "
                f"for {', '.join(self.names)}"
            )
        array = np.broadcast_to(array, (len(self),))
        for motor, number in zip(self.names, array):
            if not np.isfinite(number):
                raise InvalidSetpoint(f"{name} of {motor} is {number}: no finite number")
        return array
