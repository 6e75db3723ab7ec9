"""rc10d's refusals of this client's targets and inputs: told once, and not asked for again."""

from __future__ import annotations

import logging
import re
from typing import TYPE_CHECKING

from rc10.printable import printable
from rc10.setpoints import Mode

if TYPE_CHECKING:
    from rc10.events import Event
    from rc10.setpoints import Setpoint

_log = logging.getLogger("rc10")

# Events of targets and inputs that another client's stand in the way of, and of messages that rc10d
# refused: docs/lcm.md.
_REFUSED = (104, 202)
_UNSUPPORTED = re.compile(
    r"refused: (?P<motor>[^ :]+): (?P<mode>\w+): the motor's drive does not support the mode"
)
_GAINS_BEYOND = re.compile(
    r"refused: (?P<motor>[^ :]+): impedance: .*: "
    r"0 to (?P<stiffness>\S+) Nm/rad, 0 to (?P<damping>\S+) Nms/rad"
)


class Refusals:
    """Modes that drives do not have, gains beyond theirs, and all words that were logged.

    Args:
        client: whose targets they are.
    """

    def __init__(self, client: str) -> None:
        self._client = client
        self._unsupported: dict[tuple[str, str], str] = {}
        # The largest stiffness and damping, and the words.
        self._most_gains: dict[str, tuple[float, float, str]] = {}
        self._told: set[str] = set()

    def on_event(self, event: Event) -> None:
        """Keeps what rc10d says about this client's targets, and logs each text once."""
        if event.client != self._client or event.code not in _REFUSED:
            return
        if found := _UNSUPPORTED.search(event.text):
            self._unsupported[found["motor"], found["mode"]] = event.text
        elif found := _GAINS_BEYOND.search(event.text):
            most = float(found["stiffness"]), float(found["damping"])
            self._most_gains[found["motor"]] = (*most, event.text)
        if event.text not in self._told:
            self._told.add(event.text)
            _log.warning("rc10d says: %s", printable(f"{event.source}: {event.text}"))

    def of(self, name: str, setpoint: Setpoint) -> str:
        """Words in which rc10d has refused this motor's mode or gains; empty: it has not."""
        if said := self._unsupported.get((name, setpoint.mode.name.lower())):
            return said
        if setpoint.mode is not Mode.IMPEDANCE or name not in self._most_gains:
            return ""
        most_stiffness, most_damping, said = self._most_gains[name]
        beyond = (
            setpoint.stiffness_nm_per_rad > most_stiffness
            or setpoint.damping_nms_per_rad > most_damping
        )
        return said if beyond else ""
