"""Client of rc10d, the real-time motor daemon.

    with rc10.connect("demo") as robot:
        robot.wait_for_state()
        robot.enable("wheel")
        for t_s in robot.rate(100):
            robot.command(wheel=rc10.velocity_rpm(120))
            print(robot.motor("wheel").velocity_rpm)

Units are rpm, degrees, amperes, N·m, °C and seconds, at the output shaft, counter-clockwise
positive. The LCM messages themselves are in rc10.lcm_types.
"""

from rc10 import aio, radians
from rc10.client import Robot, connect
from rc10.diagnostics import BusState, BusStatus, Diagnostics, Durations
from rc10.errors import (
    CommandRefused,
    InvalidSetpoint,
    LinkError,
    MissingPackage,
    MotorStopped,
    NotReceived,
    Rc10Error,
    RequestError,
    RequestFailed,
    RequestRefused,
    ServiceError,
    ServiceFailed,
    ServiceRefused,
    ServiceTimeout,
    Timeout,
    UnknownMotor,
    UnknownSignal,
)
from rc10.events import Event, Severity
from rc10.gains import Gains
from rc10.link import LcmLink
from rc10.modules import Module, ModuleState
from rc10.moves import Move, MoveOutcome, MoveResult
from rc10.rate import Rate
from rc10.recorder import Recorder
from rc10.requests import Response
from rc10.services import ServiceClient, ServiceServer
from rc10.setpoints import (
    Mode,
    Setpoint,
    angle_deg,
    brake,
    coast,
    current_a,
    duty,
    impedance_deg,
    total_angle_deg,
    velocity_rpm,
    voltage_v,
)
from rc10.state import (
    Acting,
    CommandUnit,
    Condition,
    Limit,
    MotorState,
    MotorStatus,
    RobotState,
    RobotStatus,
    StopCause,
)
from rc10.topics import Publisher, Received, Subscriber
from rc10.watch import Watch

__version__ = "0.2.0"

__all__ = [
    "Acting",
    "BusState",
    "BusStatus",
    "CommandRefused",
    "CommandUnit",
    "Condition",
    "Diagnostics",
    "Durations",
    "Event",
    "Gains",
    "InvalidSetpoint",
    "LcmLink",
    "Limit",
    "LinkError",
    "MissingPackage",
    "Mode",
    "Module",
    "ModuleState",
    "MotorState",
    "MotorStatus",
    "MotorStopped",
    "Move",
    "MoveOutcome",
    "MoveResult",
    "NotReceived",
    "Publisher",
    "Rate",
    "Rc10Error",
    "Received",
    "Recorder",
    "RequestError",
    "RequestFailed",
    "RequestRefused",
    "Response",
    "Robot",
    "RobotState",
    "RobotStatus",
    "ServiceClient",
    "ServiceError",
    "ServiceFailed",
    "ServiceRefused",
    "ServiceServer",
    "ServiceTimeout",
    "Setpoint",
    "Severity",
    "StopCause",
    "Subscriber",
    "Timeout",
    "UnknownMotor",
    "UnknownSignal",
    "Watch",
    "aio",
    "angle_deg",
    "brake",
    "coast",
    "connect",
    "current_a",
    "duty",
    "impedance_deg",
    "radians",
    "total_angle_deg",
    "velocity_rpm",
    "voltage_v",
]
