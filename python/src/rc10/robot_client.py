"""Common part of the client and the asyncio client of a robot: all that does not wait."""

from __future__ import annotations

import math
import re
from contextlib import contextmanager
from typing import TYPE_CHECKING, Literal, Union, get_args
from weakref import WeakSet

from rc10.catch_up import PAUSE_S, CatchUp
from rc10.decoder import Decoder
from rc10.errors import (
    CommandRefused,
    LinkError,
    NotReceived,
    RequestFailed,
    RequestRefused,
    UnknownMotor,
)
from rc10.identity import Identity
from rc10.in_force import InForce
from rc10.inbox import Inbox
from rc10.lcm_types.command_t import command_t
from rc10.lcm_types.setpoint_t import setpoint_t
from rc10.link import MULTICAST_GROUP, ROUTE_COMMAND, Link
from rc10.moves import Move
from rc10.orders import hindered, obstacle
from rc10.recorder import Recorder
from rc10.refusals import Refusals
from rc10.requests import Request, Requests
from rc10.setpoints import Mode, Setpoint, angle_deg, coast, total_angle_deg
from rc10.spelling import did_you_mean, meant
from rc10.state import MotorStatus, RobotStatus
from rc10.validity import ENDED_MS, check_validity, lapses_at

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Set
    from contextlib import AbstractContextManager
    from typing import Callable

    from rc10.diagnostics import Diagnostics
    from rc10.events import Event, EventListener
    from rc10.joints import Joints
    from rc10.modules import ModuleParts
    from rc10.state import MotorState, RobotState

Names = Union[str, "Iterable[str]"]
AtEnd = Literal["timeout", "disable", "coast"]
"""The fate of the motors when a program leaves its robot in good order."""

# A request or its answer can be lost: LCM is UDP. The daemon knows a repeated one again.
REPEAT_REQUEST_S = 0.1
# An emergency stop is worth the traffic.
REPEAT_ESTOP_S = 0.02
# Time that leaving may take: the lease of a client that is gone lapses by itself.
RELEASE_TIMEOUT_S = 0.5
# Value of a disable request that nobody asked for: what an e-stop holds stays held.
AT_END: Mapping[str, float] = {"at_end": 1.0}
# Time for a state to show what an answer says: the slowest state_hz is one a second.
SHOWN_S = 2.0
# Period and validity of a move's target while the program receives.
RESEND_S = 0.02
_MOVE_VALIDITY_MS = 100
# Resolution of a state's stamp.
_STAMP_S = 1e-6
# A state younger than this proves that the daemon runs and is heard.
_LIVE_S = 1.0

# Requests after which nothing is sent again to their motors.
_STOPPING = ("disable", "estop")

# Among names of motors; no motor's name is empty.
_ALL = ""

# LCM allows 63 characters for a channel, and ".v1.diagnostics" takes 15 of them.
_MAX_NAME = 48


class RobotClient:
    """One robot, seen from one client program. Nothing in here waits.

    Args:
        name: the name of the robot.
        link: the transport.
        client: who commands.
        priority: a client with a higher one takes motors over from a lower one.
        at_end: what leaving does, see rc10.connect().
    """

    def __init__(
        self,
        name: str,
        link: Link,
        client: str,
        priority: int = 0,
        at_end: AtEnd = "timeout",
    ) -> None:
        if at_end not in get_args(AtEnd):
            raise ValueError(f"at_end={at_end!r}: use {', '.join(get_args(AtEnd))}")
        self._at_end = at_end
        if not re.fullmatch(rf"[\w.-]{{1,{_MAX_NAME}}}", name, re.ASCII):
            raise ValueError(
                f"{name!r} is no robot's name: that has letters, digits, '_', '-' and '.', "
                f"{_MAX_NAME} at most"
            )
        self._name = name
        self._link = link
        self._priority = priority
        self._identity = Identity(client)
        self._decoder = Decoder()
        self._inbox = Inbox(name, link, self._decoder)
        self._requests = Requests(name, link, self._decoder, self._identity)
        self._command_channel = f"{name}.v1.command"
        self._closed = False
        self._moves: dict[str, Move] = {}
        self._resend_s = 0.0
        self._catch_up = CatchUp(0.0)
        self._judged: RobotState | None = None
        self._inbox.on_event = self._on_event
        # To be undone on leaving.
        self._commanded: set[str] = set()
        self._enabled: set[str] = set()
        # When the enabling of a motor was answered last: states from before say nothing about it.
        self._answered: dict[str, float] = {}
        self._was_active: set[str] = set()
        self._refusals = Refusals(client)
        # Robots that were heard while the first state was waited for.
        self._heard: set[str] = set()
        self._in_force = InForce()
        self._event_listeners: WeakSet[EventListener] = WeakSet()

    # ---- what is known -----------------------------------------------------------------------

    @property
    def name(self) -> str:
        """The name of the robot."""
        return self._name

    def listen_to_events(self, listener: EventListener) -> list[Event]:
        """Tells `listener` of each event while it lives; returns those not taken yet."""
        self._event_listeners.add(listener)
        return list(self._inbox.events)

    @property
    def link(self) -> Link:
        """The link, for publishers, subscribers and services of the program's own."""
        return self._link

    @property
    def client(self) -> str:
        """The name under which this program commands."""
        return self._identity.client

    @property
    def state(self) -> RobotState:
        """The newest state received; see its age_s.

        Raises:
            NotReceived: none yet.
        """
        if self._inbox.state is None:
            raise NotReceived("no state yet: call wait_for_state() first")
        return self._inbox.state

    def motor(self, name: str) -> MotorState:
        """Returns the motor `name` of the newest state.

        Raises:
            NotReceived: no state yet.
            UnknownMotor: the robot has none of this name.
        """
        return self.state.motor(name)

    @property
    def diagnostics(self) -> Diagnostics:
        """The newest diagnostics received; the daemon sends them twice a second.

        Raises:
            NotReceived: none yet.
        """
        if self._inbox.diagnostics is None:
            raise NotReceived("no diagnostics yet: they come twice a second; call spin()")
        return self._inbox.diagnostics

    def recorder(self, motors: Names | None = None) -> Recorder:
        """Returns a recorder of every state, for a `with` statement around your own loop.

        Args:
            motors: one name or several; None for all.
        """
        return Recorder(self._name, self._inbox, _listed(motors))

    @contextmanager
    def states_to(self, listener: Callable[[RobotState], None]) -> Iterator[None]:
        """Has each state given to `listener`, not only the newest, in a `with` block.

        It is called while the program receives. Receive at least twice a second: LCM queues
        about half a second of states.
        """
        self._inbox.on_state.append(listener)
        try:
            yield
        finally:
            self._inbox.on_state.remove(listener)

    # ---- commanding --------------------------------------------------------------------------

    def command(
        self,
        setpoints: Mapping[str, Setpoint] | None = None,
        /,
        *,
        validity_ms: int = 0,
        **by_name: Setpoint,
    ) -> None:
        """Sends one message with a setpoint for each motor; they act in the same tick.

        `robot.command(wheel=rc10.velocity_rpm(120))`, or with a mapping for names that are not
        Python identifiers: `robot.command({"wheel-1": rc10.velocity_rpm(120)})`.

        The setpoints act for `validity_ms` only. Call this again before that, from your own
        loop: nothing repeats it for you, so that a program that hangs lets go of the motors.

        Args:
            setpoints: setpoints by name of motor.
            validity_ms: how long they act, from when the host receives them; 0: its default, 50.
            by_name: more setpoints by name of motor.

        Raises:
            UnknownMotor: a state is known, and it has no such motor; nothing was sent.
            CommandRefused: a motor that has not been ACTIVE yet cannot act on it, or rc10d has
                refused the same mode, or gains beyond its drive's, for it; nothing was sent. A
                motor that stops later, in a loop that holds others, raises nothing: its state and
                an event tell.
            TypeError: a value is not a setpoint; nothing was sent.
            ValueError: no setpoints, a motor twice, or a validity out of range; nothing was sent.
        """
        self._check_open()
        orders = dict(setpoints or {})
        twice = orders.keys() & by_name.keys()
        if twice:
            raise ValueError(f"two setpoints for {', '.join(sorted(twice))}")
        orders.update(by_name)
        if not orders:
            raise ValueError("a command needs at least one setpoint")
        check_validity(validity_ms)
        for name, setpoint in orders.items():
            if not isinstance(setpoint, Setpoint):
                raise TypeError(
                    f"{name}: {setpoint!r} is not a setpoint: say what it is, "
                    f"for example rc10.velocity_rpm({setpoint!r})"
                )
        self._check_known(orders)
        self._check_obeyed(orders)
        for name in orders.keys() & self._moves.keys():
            self._moves.pop(name).fail(f"{name} was given another target")
        self._commanded.update(orders)
        self._publish_command(orders, validity_ms)

    def joints(self, names: Names | None = None) -> Joints:
        """Returns motors as NumPy arrays in radians: `.q`, `.dq`, `.tau`, `.command(q=...)`.

        Args:
            names: one name, or several in the order of the arrays; None for all that the state has.

        Raises:
            MissingPackage: NumPy is not installed.
            NotReceived: no state yet, and no names.
            UnknownMotor: a state is known, and it has no such motor.
        """
        from rc10.joints import Joints

        chosen = list(self.state.motors if names is None else _listed(names) or ())
        self._check_known(chosen)
        return Joints(self, chosen)

    # ---- for the clients ---------------------------------------------------------------------

    def _begin_move(
        self,
        name: str,
        angle: float,
        tolerance_deg: float,
        timeout_s: float,
        shortest_way: bool,
        spin: Callable[[float], object],
    ) -> Move:
        setpoint = angle_deg(angle) if shortest_way else total_angle_deg(angle)
        state = self.state
        move = Move(name, setpoint, tolerance_deg, timeout_s, self.client, self._link.now, spin)
        move.shown_us = state.mono_us
        motor = state.motor(name)
        runs = state.status is RobotStatus.RUN
        just_enabled = runs and self._is_older(state, name)
        if not just_enabled and (hindrance := hindered(state, motor)):
            move.fail(hindrance)
            return move
        self.command({name: setpoint}, validity_ms=_MOVE_VALIDITY_MS)
        if not self._moves:
            self._catch_up = CatchUp(self._link.now(), RESEND_S + PAUSE_S)
            self._resend_s = self._link.now() + RESEND_S
        self._moves[name] = move
        return move

    @contextmanager
    def _enabling(self, names: Names | None) -> Iterator[str]:
        """Gives the target of an enable request, and notes what has to be undone on leaving."""
        chosen = self._choose(names)
        # Motors of this request alone: another may be answered meanwhile.
        noted = set(chosen or [_ALL]) - self._enabled
        # Noted before it is known to have worked: on leaving, one motor too many to disable
        # does no harm, and one too few does.
        self._enabled |= noted
        try:
            yield ",".join(chosen)
        except RequestRefused:
            self._enabled -= noted
            raise
        except RequestFailed:  # some of them may be enabled
            self._note_answer(chosen)
            raise
        self._was_active.update(self._note_answer(chosen))

    def _note_answer(self, chosen: list[str]) -> list[str]:
        """Notes that enabling was answered now, and returns the motors."""
        state = self._inbox.state
        motors = chosen or ([] if state is None else list(state.motors))
        self._answered.update(dict.fromkeys(motors, self._link.now()))
        return motors

    def _is_older(self, state: RobotState, name: str) -> bool:
        """Whether a state may be from before the last enabling of the motor was answered."""
        return state.taken_at_s <= self._answered.get(name, -math.inf) + _STAMP_S

    def _unshown(self) -> bool:
        """Whether a state is still to come that shows what enabling has done."""
        state = self._inbox.state
        return state is not None and any(
            motor.status is not MotorStatus.ACTIVE and self._is_older(state, name)
            for name, motor in state.motors.items()
        )

    @contextmanager
    def _disabling(self, names: Names | None) -> Iterator[str]:
        """Gives the target of a disable request, and notes that it was carried out."""
        names = None if names is None else list(_listed(names) or ())
        self._end_moves(names)  # first: also those of a request that is never sent
        chosen = self._choose(names)
        for name in chosen or list(self._answered):
            self._answered.pop(name, None)
        yield ",".join(chosen)
        if chosen:
            self._enabled.difference_update(chosen)
        else:
            self._enabled.clear()

    def _target(self, names: Names | None) -> str:
        return ",".join(self._choose(names))

    def _open(
        self, operation: str, target: str, values: Mapping[str, float]
    ) -> AbstractContextManager[Request]:
        """Opens a request. One that stops motors ends their moves, whatever its answer is."""
        if operation in _STOPPING:
            one_by_one = target and operation == "disable"
            self._end_moves(target.split(",") if one_by_one else None)
        return self._requests.open(operation, target, values)

    def _end_moves(self, names: Iterable[str] | None) -> None:
        """Has the targets of these moves, or of all, lapse: they are not sent again."""
        for name in self._moves.keys() & set(self._moves if names is None else names):
            self._moves.pop(name).fail(f"the program has let go of {name}")

    def _let_go(self) -> str | None:
        """Ends what acts, as `at_end` says, and returns the target of a disable request, if any."""
        # A motor that was stopped meanwhile is known by an event that may wait.
        self._inbox.hear()
        for move in self._moves.values():
            move.fail("the program has let go of the robot")
        self._moves.clear()
        self._in_force.end_inputs(self._link.now())
        if self._at_end == "timeout":
            self._lapse(disabled=set())
            return None
        # The daemon refuses a whole message for one motor that it no longer has.
        state = self._inbox.state
        gone = set() if state is None else (self._commanded | self._enabled) - {*state.motors, _ALL}
        if self._at_end == "coast":  # torque first: that needs no answer
            for motor in sorted(self._commanded - gone):  # each by itself: see _lapse()
                self._publish_command({motor: coast()}, validity_ms=0)
        if _ALL in self._enabled:
            return ""
        if self._at_end == "disable":
            self._lapse(disabled=self._enabled)
        return ",".join(sorted(self._enabled - gone)) or None

    def _lapse(self, disabled: Set[str]) -> None:
        """Has the targets in force end now, not at the end of their validity.

        The same targets, and not COAST: after that the daemon would have nothing to do in their
        stead. Motors that are disabled do their on_disable instead. Each by itself: a message is
        refused whole for one that another client has taken.
        """
        known = None if self._inbox.state is None else self._inbox.state.motors
        last = self._in_force.at(self._link.now(), known, disabled)
        for name, setpoint in last.items():
            self._publish_command({name: setpoint}, ENDED_MS)

    @contextmanager
    def _hearing(self) -> Iterator[None]:
        """Notes which robots there are, as long as nothing is known of this one."""
        if self._inbox.state is not None:
            yield
            return
        with self._link.between("", ".v1.state") as heard:
            self._heard = heard
            yield

    def _no_state(self, timeout_s: float) -> str:
        what = f"no state of robot '{self._name}' within {timeout_s:g} s. "
        heard = sorted(self._heard)
        if heard and self._name not in heard:
            return what + f"Robots heard here: {', '.join(heard)}; {meant(self._name, heard)}"
        return what + self._what_to_check()

    def _no_answer(self, operation: str, timeout_s: float) -> str:
        return (
            f"no answer to '{operation}' from robot '{self._name}' within {timeout_s:g} s. "
            f"{self._what_to_check()}"
        )

    def _no_estop(self, timeout_s: float) -> str:
        return (
            f"the state of robot '{self._name}' does not show ESTOP after {timeout_s:g} s:"
            f" use the hardware emergency stop. {self._what_to_check()}"
        )

    # ---- within ------------------------------------------------------------------------------

    def _on_event(self, event: Event) -> None:
        self._refusals.on_event(event)
        self._in_force.on_event(event)
        for listener in (*self._moves.values(), *self._event_listeners):
            listener.on_event(event)

    def _abandon(self, move: Move) -> None:
        """Has the target of a move end now: nobody waits for it any more."""
        if self._moves.get(move.motor) is move:
            self._moves.pop(move.motor)
            # One that has lapsed would let go of what holds the motor since.
            if move.motor in self._in_force.at(self._link.now(), None, ()):
                self._publish_command({move.motor: move.setpoint}, ENDED_MS)
        move.fail("cancelled")

    def _advance_moves(self) -> None:
        state = self._inbox.state
        fresh = state is not self._judged
        self._judged = state
        for name, move in list(self._moves.items()):
            if fresh and state is not None:
                move.on_state(state)
                # Also after it is done: a held target never comes back to life by itself.
                motor = state.motors.get(name)
                taken = motor is not None and motor.owner not in ("", self.client)
                # One from before the move says nothing about it.
                news = state.taken_at_s >= move.started_s
                lost = motor is None or (news and hindered(state, motor))
                if lost or (move.done() and taken):
                    self._moves.pop(name)
                    move.fail(f"{name} cannot be moved any more")
                    continue
            move.on_time()
            if move.dropped:
                self._moves.pop(name)
        now_s = self._link.now()
        if self._moves and now_s >= self._resend_s:
            self._resend_s = now_s + RESEND_S
            if not self._catch_up.done(now_s, state):
                return
            for name, move in self._moves.items():
                self._publish_command({name: move.setpoint}, _MOVE_VALIDITY_MS)

    def _publish_command(self, orders: Mapping[str, Setpoint], validity_ms: int) -> None:
        message = command_t()
        self._identity.sign(message)
        message.priority = self._priority
        message.validity_ms = validity_ms
        message.setpoint_count = len(orders)
        self._in_force.sent(orders, lapses_at(self._link.now(), validity_ms))
        for name, order in orders.items():
            setpoint = setpoint_t()
            setpoint.motor = name
            setpoint.mode = order.mode
            setpoint.value = order.value
            setpoint.velocity_ff_rpm = order.velocity_ff_rpm
            setpoint.torque_ff_nm = order.torque_ff_nm
            setpoint.stiffness_nm_per_rad = order.stiffness_nm_per_rad
            setpoint.damping_nms_per_rad = order.damping_nms_per_rad
            message.setpoints.append(setpoint)
        self._link.publish(self._command_channel, message.encode())

    def _choose(self, names: Names | None) -> list[str]:
        """Returns the names for a request; an empty list means all, and only None does."""
        if names is None:
            return []
        chosen = [names] if isinstance(names, str) else list(names)
        if not chosen:
            raise ValueError("no motors named: give at least one name, or None for all")
        for name in chosen:
            # An empty name would be understood as "all", a comma as two names.
            if not name or "," in name:
                raise ValueError(f"{name!r} is no motor's name; several are given as a list")
        self._check_known(chosen)
        return chosen

    def _check_known(self, names: Iterable[str]) -> None:
        state = self._inbox.state
        unknown = [name for name in names if state is not None and name not in state.motors]
        if state is not None and unknown:
            raise UnknownMotor(
                f"robot '{self._name}' has no motor {', '.join(map(repr, unknown))}; "
                f"it has: {', '.join(state.motors) or 'none'}"
                f"{did_you_mean(unknown[0], state.motors)}"
            )

    def _check_obeyed(self, orders: Mapping[str, Setpoint]) -> None:
        """Refuses what would do nothing, and would say so nowhere near the caller's line."""
        for name, setpoint in orders.items():
            if said := self._refusals.of(name, setpoint):
                raise CommandRefused(said)
        new = [
            name
            for name, setpoint in orders.items()
            if name not in self._was_active and setpoint.mode is not Mode.COAST
        ]
        if new and self._why_not(new):
            # It may have been enabled since.
            self._inbox.poll()
            if why := self._why_not(new):
                raise CommandRefused(why)

    def _why_not(self, names: Iterable[str]) -> str:
        state = self._inbox.state
        if state is None or state.age_s > _LIVE_S:
            return ""
        for name in names:
            if why := obstacle(state, state.motor(name)):
                return why
            self._was_active.add(name)
        return ""

    def _module_parts(self, module: str) -> ModuleParts:
        def heard() -> bool:
            state = self._inbox.state
            return state is not None and state.age_s < _LIVE_S

        identity, priority = self._identity, self._priority
        return self._name, module, self._link, identity, priority, heard, self._in_force

    def _check_open(self) -> None:
        if self._closed:
            raise LinkError(f"the link to robot '{self._name}' is closed")

    def _what_to_check(self) -> str:
        if self._decoder.foreign:
            return (
                f"Messages with other definitions arrive on {', '.join(self._decoder.foreign)}: "
                "install the rc10 package that belongs to this rc10d."
            )
        state = self._inbox.state
        if state is not None and state.age_s < _LIVE_S:
            return "Its state arrives, so rc10d runs and is heard: see rc10d's log for the reason."
        return (
            "Check: is rc10d running? Is its robot called "
            f"'{self._name}' (robot: in its configuration)? Does multicast stay on this computer:"
            f" 'ip route get {MULTICAST_GROUP}' must say 'dev lo', else run: {ROUTE_COMMAND}"
        )


def _listed(names: Names | None) -> Iterable[str] | None:
    """A name alone is a list of one, not of its letters."""
    return [names] if isinstance(names, str) else names
