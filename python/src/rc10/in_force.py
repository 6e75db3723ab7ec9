"""Remembers the targets that a program has sent, until they lapse."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Container, Mapping

    from rc10.setpoints import Setpoint


class InForce:
    """The last target of each motor, and when it lapses."""

    def __init__(self) -> None:
        self._targets: dict[str, tuple[Setpoint, float]] = {}

    def sent(self, orders: Mapping[str, Setpoint], until_s: float) -> None:
        """Notes what was sent; it lapses at `until_s`."""
        self._targets.update({name: (setpoint, until_s) for name, setpoint in orders.items()})

    def ended(self, motor: str) -> None:
        """Forgets the target of a motor that was stopped."""
        self._targets.pop(motor, None)

    def at(
        self, now_s: float, known: Container[str] | None, disabled: Container[str]
    ) -> dict[str, Setpoint]:
        """Targets that still act.

        Args:
            now_s: the present time.
            known: motors that the robot has; None: unknown, all count.
            disabled: motors that are not asked about.
        """
        return {
            name: setpoint
            for name, (setpoint, until_s) in self._targets.items()
            if now_s < until_s and name not in disabled and (known is None or name in known)
        }
