"""Readers of a drive's name, for the families besides DJI."""

from __future__ import annotations

from typing import TYPE_CHECKING, Callable

from rc10.fakes.cubemars import CubeMarsSpec
from rc10.fakes.damiao import DamiaoSpec
from rc10.fakes.lktech import LKTechSpec
from rc10.fakes.moteus import MoteusSpec
from rc10.fakes.myactuator import MyActuatorSpec
from rc10.fakes.odrive import OdriveSpec
from rc10.fakes.robstride import RobStrideSpec
from rc10.fakes.vesc import VescSpec

if TYPE_CHECKING:
    from rc10.fakes.fake import FamilySpec

# By what the names of a family's models begin with.
FAMILIES: dict[str, Callable[[str], FamilySpec]] = {
    "DM": DamiaoSpec.parse,
    "ODrive_": OdriveSpec.parse,
    "VESC": VescSpec.parse,
    "LK-": LKTechSpec.parse,
    "RMD-": MyActuatorSpec.parse,
    "moteus": MoteusSpec.parse,
    "RS": RobStrideSpec.parse,
    "EL05": RobStrideSpec.parse,
    "CyberGear": RobStrideSpec.parse,
    "AK": CubeMarsSpec.parse,
}


def family_spec(text: str) -> FamilySpec | None:
    """Returns the drive that `text` asks for; None if its family is not among these.

    Raises:
        ValueError: the family has no such drive.
    """
    for prefix, parse in FAMILIES.items():
        if text.startswith(prefix):
            return parse(text)
    return None
