"""One fake drive of any family that does wrong things when told so, by a frame that no robot uses.

FAULT_ID carries one byte, a Wrong, and for some an argument after it, signed 16 bit.
Arguments: the interface and the drive.
"""

from __future__ import annotations

import math
import signal
import sys
from enum import IntEnum
from typing import TYPE_CHECKING, Any

import can

from rc10.fakes.cli import _motor
from rc10.fakes.drives import Drives
from rc10.fakes.runner import Runner

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from types import FrameType

    from rc10.fakes.fake import Fake

FAULT_ID = 0x7F0


class Wrong(IntEnum):
    """Fault of the drive."""

    NOTHING = 0  # its cable is plugged in again
    SILENT = 1
    RESTARTED = 2
    FAULTED = 3
    PARKED = 4  # argument: deg; switched off, turned there by hand, switched on a second later
    RESCALED = 5  # argument: percent; of its speed that it reports


# The family's own code of a fault that it reports and that `clear` ends.
_CODES = {
    "damiao": 0xA,
    "lktech": 1,
    "moteus": 33,
    "myactuator": 4,
    "robstride": 1,
    "odrive": 0x200,
    "vesc": 4,
    "cubemars": 1,
}


# Silence of a restarted drive; the others are back at once, which is harder to notice.
_BOOT_S = {"lktech": 0.3}
# No drive is off and on again sooner.
_OFF_S = 1.0
# First byte and bits of the speed in the feedback of those that report a share of a range.
_SPEEDS = {"damiao": (3, 12), "myactuator": (3, 12), "robstride": (2, 16), "cubemars": (3, 12)}


class FaultyDrive(Drives):
    """One drive, which listens to FAULT_ID, too."""

    def __init__(self, make: Callable[[float], Fake]) -> None:
        super().__init__([make(0.0)])
        self._make = make
        self._motor: Any = self.motors[0]
        self._silent = False
        self._off_s = 0.0
        self._speed_ratio = 1.0

    @property
    def _family(self) -> str:
        return type(self._motor).__module__.rpartition(".")[2]

    def _park(self, angle_deg: int) -> None:
        # One turn of its encoder is all that it knows.
        self._motor = self._make(math.remainder(angle_deg, 360))
        self._off_s = _OFF_S
        super().__init__([self._motor])

    @property
    def command_ids(self) -> list[int]:
        return [*super().command_ids, FAULT_ID]

    def receive(self, message: can.Message) -> None:
        if message.arbitration_id == FAULT_ID and not message.is_extended_id:
            self._order(Wrong(message.data[0]), bytes(message.data[1:]))
        else:
            super().receive(message)

    def _order(self, wrong: Wrong, argument: bytes) -> None:
        self._silent = wrong is Wrong.SILENT
        family = self._family
        if wrong is Wrong.PARKED:
            self._park(int.from_bytes(argument, signed=True))
        elif wrong is Wrong.RESCALED:
            self._speed_ratio = int.from_bytes(argument, signed=True) / 100
        elif wrong is Wrong.RESTARTED:
            restart = getattr(self._motor, "restart", None) or self._motor.reboot
            restart()
            self._off_s = _BOOT_S.get(family, 0.0)
        elif wrong is Wrong.FAULTED:
            self._fail(_CODES[family])
        elif wrong is Wrong.NOTHING and family in ("lktech", "myactuator"):
            self._motor.fail(0)  # the cause is away; what is latched stays until it is cleared
        elif wrong is Wrong.NOTHING and family == "cubemars":
            self._motor.error = 0  # servo mode latches nothing

    def feedback(self) -> Iterator[can.Message]:
        for message in super().feedback():
            if self._speed_ratio != 1.0 and self._is_state(message):
                self._rescale(message)
            yield message

    def _is_state(self, message: can.Message) -> bool:
        """Those frames that the drives send while they obey."""
        return {
            "damiao": message.data[0] >> 4 == 1,
            "myactuator": message.arbitration_id >> 8 == 0x5,
            "robstride": message.arbitration_id >> 24 == 0x02,
        }.get(self._family, True)

    def _rescale(self, message: can.Message) -> None:
        byte, bits = _SPEEDS[self._family]
        word = int.from_bytes(message.data[byte : byte + 2])
        unused, middle = 16 - bits, ((1 << bits) - 1) / 2
        code = round(middle + self._speed_ratio * ((word >> unused) - middle))
        word = code << unused | word & ((1 << unused) - 1)
        message.data[byte : byte + 2] = word.to_bytes(2)

    def step(self, dt_s: float) -> None:
        self._off_s = max(0.0, self._off_s - dt_s)
        super().step(dt_s)

    def _fail(self, code: int) -> None:
        for name in ("fail", "inject_fault", "disarm"):
            if hasattr(self._motor, name):
                getattr(self._motor, name)(code)
                return
        self._motor.error = code

    def _is_silent(self, motor: Fake) -> bool:
        return self._silent or self._off_s > 0 or super()._is_silent(motor)


def main() -> None:
    interface, name = sys.argv[1:]
    stopped = False

    def stop(_number: int, _frame: FrameType | None) -> None:
        nonlocal stopped
        stopped = True

    signal.signal(signal.SIGTERM, stop)
    spec: Any = _motor(name)
    drive = FaultyDrive(lambda angle_deg: spec.make(initial_angle_deg=angle_deg, load_nm=0.0))
    with can.Bus(interface="socketcan", channel=interface, fd=drive.fd) as bus:
        runner = Runner(bus, drive)
        print("ready", flush=True)
        runner.run(lambda: stopped)


if __name__ == "__main__":
    main()
