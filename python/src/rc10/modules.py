"""Modules of the robot: chassis, gimbal, joint. They take inputs and give outputs."""

from __future__ import annotations

import logging
import math
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING, Callable

from rc10.errors import NotReceived, Timeout
from rc10.lcm_types.signals_t import signals_t
from rc10.spelling import did_you_mean
from rc10.topics import Publisher, Subscriber
from rc10.validity import ENDED_MS, check_validity, lapses_at

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rc10.identity import Identity
    from rc10.in_force import InForce
    from rc10.link import Link

_log = logging.getLogger("rc10")

_MAX_SIGNALS = 32


@dataclass(frozen=True)
class ModuleState:
    """The outputs of a module; NaN is what means nothing now."""

    outputs: Mapping[str, float]
    owner: str
    """The client that gives its inputs; empty: nobody."""
    received_s: float
    """On this program's clock."""
    _now: Callable[[], float] = field(repr=False, compare=False)

    @property
    def age_s(self) -> float:
        """Seconds since it was received."""
        return self._now() - self.received_s

    def __getitem__(self, name: str) -> float:
        """The output `name`.

        Raises:
            KeyError: the module has no such output; the message says what it has.
        """
        if name not in self.outputs:
            raise KeyError(
                f"no output {name!r}; there are {', '.join(self.outputs)}"
                f"{did_you_mean(name, self.outputs)}"
            )
        return self.outputs[name]


# The name of the robot and of the module, the transport, who sends, with which priority, whether
# the robot is heard, and what ends on leaving.
ModuleParts = tuple[str, str, "Link", "Identity", int, Callable[[], bool], "InForce"]

# A module's outputs come as often as the robot's state.
_SILENT_S = 1.0


class Module:
    """One module of a robot; Robot.module() makes it. Belongs to the robot's thread."""

    def __init__(
        self,
        robot: str,
        name: str,
        link: Link,
        identity: Identity,
        priority: int,
        robot_heard: Callable[[], bool],
        in_force: InForce,
    ) -> None:
        self.name = name
        self._robot_name = robot
        self._link = link
        self._heard: set[str] = set()
        self._identity = identity
        self._priority = priority
        self._robot_heard = robot_heard
        self._in_force = in_force
        self._sent_in_vain_s: float | None = None
        self._now = link.now
        self._publisher = Publisher(link, f"{robot}.v1.{name}", signals_t)
        self._subscriber = Subscriber(link, f"{robot}.v1.{name}.state", signals_t)

    def send(self, *, validity_ms: int = 0, priority: int | None = None, **inputs: float) -> None:
        """Gives the module these inputs; all others have no value.

        They hold for `validity_ms` only, and until the robot is left. Call this again before that,
        from your own loop.

        Args:
            validity_ms: how long they hold, from when the host receives them; 0: its default, 50.
            priority: against other clients of the module; None: that of the robot.
            inputs: by name: `base.send(vx_m_s=0.5, wz_deg_s=30)`.

        Raises:
            ValueError: no inputs, too many, one that is not finite, or a validity out of range;
                nothing was sent.
        """
        if not 0 < len(inputs) <= _MAX_SIGNALS:
            raise ValueError(f"a module takes 1 to {_MAX_SIGNALS} inputs, not {len(inputs)}")
        check_validity(validity_ms)
        for name, value in inputs.items():
            if not math.isfinite(value):
                raise ValueError(f"{name} = {value} is not finite: leave it out, or give a number")
        publish = partial(self._publish, inputs, self._priority if priority is None else priority)
        self._in_force.gave(
            self.name, partial(publish, ENDED_MS), lapses_at(self._now(), validity_ms)
        )
        publish(validity_ms)
        self._tell_if_missing()

    @property
    def state(self) -> ModuleState:
        """The newest outputs received; see age_s.

        Raises:
            NotReceived: none yet; there may be no module of this name.
        """
        latest = self._subscriber.latest
        if latest is None:
            raise NotReceived(
                f"nothing of module '{self.name}' yet: call wait_for_state() first; "
                "`rc10ctl modules` shows which there are"
            )
        message = latest.message
        outputs = dict(zip(message.names, message.values))
        return ModuleState(outputs, message.client, latest.received_s, self._now)

    def _publish(self, inputs: Mapping[str, float], priority: int, validity_ms: int) -> None:
        message = signals_t()
        self._identity.sign(message)
        message.priority = priority
        message.validity_ms = validity_ms
        message.count = len(inputs)
        message.names = list(inputs)
        message.values = [float(value) for value in inputs.values()]
        self._publisher.publish(message)

    def _tell_if_missing(self) -> None:
        """Logs once that a robot which is heard does not seem to have this module."""
        if self._subscriber.count or not self._robot_heard():
            self._sent_in_vain_s = None
        elif self._sent_in_vain_s is None:
            self._sent_in_vain_s = self._now()
        elif self._now() - self._sent_in_vain_s > _SILENT_S:
            self._sent_in_vain_s = math.inf
            _log.warning(
                "robot '%s' is heard, and nothing of module '%s' to which inputs are sent: "
                "`rc10ctl modules` shows which there are",
                self._robot_name,
                self.name,
            )

    def _newer(self, known: int) -> ModuleState | None:
        """The outputs, when more than `known` messages of them have come."""
        return self.state if self._subscriber.count > known else None

    @contextmanager
    def _listening(self) -> Iterator[None]:
        """Notes which modules there are, as long as nothing is known of this one."""
        if self._subscriber.count > 0:
            yield
            return
        with self._link.between(f"{self._robot_name}.v1.", ".state") as heard:
            self._heard = heard
            yield

    def _nothing(self, timeout_s: float) -> Timeout:
        what = f"nothing of module '{self.name}' within {timeout_s:g} s"
        if self._heard and self.name not in self._heard:
            heard = sorted(self._heard)
            return Timeout(
                f"{what}; heard of robot '{self._robot_name}': {', '.join(heard)}"
                f"{did_you_mean(self.name, heard)}"
            )
        return Timeout(f"{what}: `rc10ctl modules` shows which there are, and whether rc10d runs")


class WaitingModule(Module):
    """A module of rc10.Robot."""

    def __init__(self, parts: ModuleParts, spin: Callable[[float], int]) -> None:
        super().__init__(*parts)
        self._spin = spin

    def wait_for_state(self, timeout_s: float = 5.0) -> ModuleState:
        """Receives until outputs arrive that are newer than those known, and returns them.

        Raises:
            Timeout: none came; the message says what to check.
        """
        known = self._subscriber.count
        deadline_s = self._now() + timeout_s
        with self._listening():
            while True:
                left_s = deadline_s - self._now()
                self._spin(max(0.0, left_s))
                state = self._newer(known)
                if state is not None:
                    return state
                if left_s <= 0:
                    raise self._nothing(timeout_s)
