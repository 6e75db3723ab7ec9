"""Fake drives that do wrong things when told so, by frames that no robot uses.

FAULT_ID carries {motor id, fault, signed 16-bit argument}: see `faulty_drives.fault()`.
"""

from __future__ import annotations

import math
import signal
import struct
import sys
from enum import IntEnum
from typing import TYPE_CHECKING

import can

from rc10.fakes.address import MotorSpec
from rc10.fakes.drives import Drives
from rc10.fakes.fake import Fake
from rc10.fakes.motor import COUNTS, FakeMotor
from rc10.fakes.runner import Runner

if TYPE_CHECKING:
    from types import FrameType

FAULT_ID = 0x7F0
_FAULT = struct.Struct(">BBh")


class Fault(IntEnum):
    """Behaviour of a drive from now on. The argument is 0 where none is named."""

    NONE = 0
    SILENT = 1
    FROZEN = 2
    REVERSED = 3
    SLIP = 4  # argument: thousandths of a rotor turn
    HOT = 5  # argument: deg C
    STALLED = 6
    SHORT = 7  # frames of 7 bytes
    REBOOT = 8  # no frame for this number of ms, then on with no command
    DEAF = 9  # goes on with its last command: its receiving line is off; argument: 1: blocked, too
    PUSHED = 10  # argument: hundredths of N m of a load from outside
    PARKED = 11  # argument: deg; switched off, turned there by hand, switched on 100 ms later
    WALL = 12  # argument: deg; the shaft turns no farther in the negative direction
    LEAKY = 13  # argument: hundredths of A that it reports, and gives no torque for


def fault(motor_id: int, kind: Fault, argument: int = 0) -> bytes:
    """The data of the frame that orders it."""
    return _FAULT.pack(motor_id, kind, argument)


class FaultyMotor(FakeMotor):
    """A drive that may be broken."""

    def __init__(self, spec: MotorSpec) -> None:
        super().__init__(spec)
        self.fault = Fault.NONE
        self.slip_turns = 0.0
        self._last: can.Message | None = None
        self._off_s = 0.0
        self._hot_c = 0.0
        self._leak_a = 0.0
        self._blocked = False
        self._wall_deg = -math.inf

    def order(self, kind: Fault, argument: int) -> None:
        self.fault = kind
        self._blocked = kind is Fault.STALLED or (kind is Fault.DEAF and argument == 1)
        if kind is Fault.SLIP:
            self.slip_turns += argument / 1000
        elif kind is Fault.HOT:
            self._hot_c = float(argument)
        elif kind is Fault.LEAKY:
            self._leak_a = argument / 100
        elif kind is Fault.REBOOT:
            self._off_s = argument / 1000
            self._command_raw = 0
        elif kind is Fault.PUSHED:
            self.load_nm = -argument / 100
        elif kind is Fault.WALL:
            self._wall_deg = float(argument)
        elif kind is Fault.PARKED:
            self._off_s = 0.1
            self._command_raw = 0
            self.speed_rad_s = self.current_a = 0.0
            self._turn_to(argument)

    def _turn_to(self, angle_deg: float) -> None:
        self.rotor_turns = angle_deg / 360 * self.spec.model.gear_ratio

    def decode_command(self, message: can.Message) -> bool:
        return self.fault is not Fault.DEAF and super().decode_command(message)

    @property
    def silent(self) -> bool:
        return self.fault is Fault.SILENT or self._off_s > 0

    def step(self, dt_s: float) -> None:
        self._off_s = max(0.0, self._off_s - dt_s)
        super().step(dt_s)
        if self.angle_deg < self._wall_deg:
            self._turn_to(self._wall_deg)
            self.speed_rad_s = max(0.0, self.speed_rad_s)
        if self._blocked:
            self.speed_rad_s = 0.0
        elif self.fault is Fault.HOT:
            self.temperature_c = self._hot_c

    def feedback(self) -> can.Message:
        if self.fault is Fault.FROZEN and self._last is not None:
            return self._last
        message = super().feedback()
        counts, rpm = struct.unpack_from(">Hh", message.data)
        if self.fault is Fault.REVERSED:
            counts, rpm = -counts, -rpm
        counts = (counts + round(self.slip_turns * COUNTS)) % COUNTS
        struct.pack_into(">Hh", message.data, 0, counts, rpm)
        if self.fault is Fault.LEAKY:
            model = self.spec.model
            raw = round(self._leak_a / model.current_scale_a * model.current_scale_raw)
            struct.pack_into(">h", message.data, 4, raw)
        self._last = can.Message(
            arbitration_id=message.arbitration_id,
            is_extended_id=False,
            data=bytes(message.data[: 7 if self.fault is Fault.SHORT else 8]),
        )
        return self._last


class FaultyDrives(Drives):
    """Drives that listen to FAULT_ID, too."""

    def __init__(self, motors: list[FaultyMotor]) -> None:
        super().__init__(motors)
        self._faulty = {motor.spec.motor_id: motor for motor in motors}

    @property
    def command_ids(self) -> list[int]:
        return [*super().command_ids, FAULT_ID]

    def receive(self, message: can.Message) -> None:
        if message.arbitration_id != FAULT_ID:
            super().receive(message)
            return
        motor_id, kind, argument = _FAULT.unpack(bytes(message.data[: _FAULT.size]))
        self._faulty[motor_id].order(Fault(kind), argument)

    def _is_silent(self, motor: Fake) -> bool:
        return isinstance(motor, FaultyMotor) and motor.silent


def main() -> None:
    interface, *names = sys.argv[1:]
    stopped = False

    def stop(_number: int, _frame: FrameType | None) -> None:
        nonlocal stopped
        stopped = True

    signal.signal(signal.SIGTERM, stop)
    drives = FaultyDrives([FaultyMotor(MotorSpec.parse(name)) for name in names])
    with can.Bus(interface="socketcan", channel=interface) as bus:
        runner = Runner(bus, drives)
        print("ready", flush=True)
        runner.run(lambda: stopped)


if __name__ == "__main__":
    main()
