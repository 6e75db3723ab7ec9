"""The gains of the loops that rc10d closes for a motor."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rc10.requests import Response


@dataclass(frozen=True, eq=False)
class Gains(Mapping[str, float]):
    """Gains by the keys of the configuration: `gains["velocity_pid.kp_a_per_rpm"]`."""

    values_by_key: Mapping[str, float]
    yaml: str
    """The lines for the motor in the robot's file, one for each loop."""

    def __getitem__(self, key: str) -> float:
        """Returns one of them."""
        return self.values_by_key[key]

    def __iter__(self) -> Iterator[str]:
        """Iterates over their keys."""
        return iter(self.values_by_key)

    def __len__(self) -> int:
        """Returns how many there are."""
        return len(self.values_by_key)


def gains_in(response: Response) -> Gains:
    """Returns what the answer to "get_config" says."""
    return Gains(response.values, response.message)
