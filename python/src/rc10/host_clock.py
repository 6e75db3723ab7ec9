"""Tells how old a state is that carries the daemon's time."""

from __future__ import annotations

# Two crystals differ by less than this; without the allowance a slower host clock would make
# every later state look older than it is.
_DRIFT = 100e-6

# A host's clock that went back this far belongs to another boot or another host.
_RESTART_S = 1.0

# Lateness that no queue explains: without a gap, for so long, with nothing behind it.
_LATE_S = 0.5
_GAP_S = 0.5
_BELIEVED_S = 5.0


class HostClock:
    """Places the daemon's CLOCK_MONOTONIC on this program's clock.

    The time at which a message is handled says little about its age, since it may have waited
    in LCM's queue while the program was busy. The quickest message seen so far gives the
    distance between the two clocks, and then every message tells its own age. It makes no
    difference whether the daemon runs on this computer or on another. If the daemon's clock falls
    behind (its computer slept, or its time is corrected), the distance is taken anew after some
    seconds.
    """

    def __init__(self) -> None:
        self._distance_s: float | None = None
        self._last_host_s = 0.0
        self._last_local_s = 0.0
        # Since then every message has been late, without a gap; the least distance since.
        self._late_since_s: float | None = None
        self._least_s = 0.0

    def observe(self, host_s: float, local_s: float, *, last: bool = True) -> float:
        """Takes in a message stamped `host_s` and handled at `local_s`.

        Args:
            host_s: the daemon's time, in seconds.
            local_s: this program's time, in seconds.
            last: no other one waits behind it. Of one in a queue, how late it is says nothing
                about the clocks.

        Returns:
            The message's time on the local clock, in seconds.
        """
        distance_s = local_s - host_s
        restarted = host_s < self._last_host_s - _RESTART_S
        if self._distance_s is None or restarted:
            self._distance_s = distance_s
            self._late_since_s = None
        else:
            gap_s = local_s - self._last_local_s
            self._distance_s = min(distance_s, self._distance_s + _DRIFT * gap_s)
            if distance_s - self._distance_s < _LATE_S or gap_s > _GAP_S:
                self._late_since_s = None
            elif not last:
                pass  # it may have waited
            elif self._late_since_s is None:
                self._late_since_s, self._least_s = local_s, distance_s
            else:
                self._least_s = min(self._least_s, distance_s)
                if local_s - self._late_since_s >= _BELIEVED_S:
                    self._distance_s, self._late_since_s = self._least_s, None
        self._last_host_s = host_s
        self._last_local_s = local_s
        return host_s + self._distance_s
