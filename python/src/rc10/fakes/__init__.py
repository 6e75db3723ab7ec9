"""Fake DJI motors on a CAN bus, to test a host without hardware.

They speak the protocol of M3508 (C620), M2006 (C610) and GM6020 as their manuals describe it,
and are written from that description alone, so that they can be wrong only in other ways than
the host is. `python -m rc10.fakes --help` runs them; FakeMotor is one of them without a bus.
"""

from rc10.fakes.address import Address, CommandKind, MotorSpec, address_of, check_collisions
from rc10.fakes.drives import Drives
from rc10.fakes.models import GM6020, M2006, M3508, MODELS, MotorModel
from rc10.fakes.motor import FakeMotor
from rc10.fakes.runner import Runner

__all__ = [
    "GM6020",
    "M2006",
    "M3508",
    "MODELS",
    "Address",
    "CommandKind",
    "Drives",
    "FakeMotor",
    "MotorModel",
    "MotorSpec",
    "Runner",
    "address_of",
    "check_collisions",
]
