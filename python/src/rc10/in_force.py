"""Remembers the targets and inputs that a program has sent, until they lapse."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rc10.moves import is_enabled, leaves_active

if TYPE_CHECKING:
    from collections.abc import Container, Mapping
    from typing import Callable

    from rc10.events import Event
    from rc10.setpoints import Setpoint


class InForce:
    """The last target of each motor, the last inputs of each module, and when they lapse."""

    def __init__(self) -> None:
        self._targets: dict[str, tuple[Setpoint, float]] = {}
        self._inputs: dict[str, tuple[Callable[[], None], float]] = {}

    def sent(self, orders: Mapping[str, Setpoint], until_s: float) -> None:
        """Notes targets that were sent; they lapse at `until_s`."""
        self._targets.update({name: (setpoint, until_s) for name, setpoint in orders.items()})

    def gave(self, module: str, end: Callable[[], None], until_s: float) -> None:
        """Notes that a module was given inputs, which lapse at `until_s`; `end` ends them now."""
        self._inputs[module] = (end, until_s)

    def on_event(self, event: Event) -> None:
        """Forgets what would act anew if it were said again."""
        if leaves_active(event):  # its last target would end what holds it now
            self._targets.pop(event.source, None)
        if is_enabled(event):  # inputs from before do not move it, whichever module's it is
            self._inputs.clear()

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

    def end_inputs(self, now_s: float) -> None:
        """Has the inputs end that still act."""
        for end, until_s in self._inputs.values():
            if now_s < until_s:
                end()
        self._inputs.clear()
