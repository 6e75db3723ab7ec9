"""Common part of all fake drives, whatever the family."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    import can


EXTENDED = 0x80000000
"""Marks an extended id in a number, as linux/can.h does."""


class Place(Protocol):
    """A drive's place on the bus."""

    @property
    def feedback_id(self) -> int:
        """The id of its usual feedback; no two drives of one bus share it."""


class Spec(Protocol):
    """A drive as it is asked for, MODEL:ID."""

    @property
    def name(self) -> str:
        """Model and id."""

    @property
    def address(self) -> Place:
        """Its place on the bus."""


class FamilySpec(Spec, Protocol):
    """The same, of a family whose drives are made from nothing else."""

    def make(self, *, initial_angle_deg: float, load_nm: float) -> Fake:
        """Returns the drive."""


class Fake(Protocol):
    """One drive: frames in, physics, frames out. Knows no bus and no clock.

    A drive may also have
        fd: whether it speaks CAN FD.
        command_filters: pairs of an id and a mask, when too many ids are its own for a list. It
            listens to the ids that equal the first in the bits of the second.
    """

    speed_rad_s: float
    current_a: float
    temperature_c: float
    commands: int

    @property
    def spec(self) -> Spec:
        """Its settings."""

    @property
    def name(self) -> str:
        """Model and id."""

    @property
    def command_ids(self) -> Sequence[int]:
        """The ids that it listens to, extended ones with EXTENDED added."""

    @property
    def command(self) -> float:
        """The last target, in the unit of its mode."""

    @property
    def velocity_rpm(self) -> float:
        """Velocity of the output shaft."""

    @property
    def angle_deg(self) -> float:
        """Multi-turn, of the output shaft."""

    def decode_command(self, message: can.Message) -> bool:
        """Takes a frame; returns whether it was for this drive."""

    def step(self, dt_s: float) -> None:
        """Lets time pass."""

    def frames(self) -> Iterable[can.Message]:
        """Yields what it sends now; each is to be sent before the next."""
