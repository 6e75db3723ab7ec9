"""The client of rc10d: commands motors and reads them through LCM."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

from rc10.errors import Rc10Error, Timeout
from rc10.gains import gains_in
from rc10.identity import client_name
from rc10.link import LcmLink, Link
from rc10.modules import WaitingModule
from rc10.rate import Rate
from rc10.robot_client import (
    AT_END,
    RELEASE_TIMEOUT_S,
    REPEAT_ESTOP_S,
    REPEAT_REQUEST_S,
    RESEND_S,
    SHOWN_S,
    AtEnd,
    Names,
    RobotClient,
)

if TYPE_CHECKING:
    from collections.abc import Mapping
    from types import TracebackType

    from rc10.events import Event
    from rc10.gains import Gains
    from rc10.moves import Move
    from rc10.recording import Recording
    from rc10.requests import Response
    from rc10.state import RobotState

_log = logging.getLogger("rc10")


def connect(
    robot: str,
    url: str | None = None,
    client: str | None = None,
    priority: int = 0,
    at_end: AtEnd = "timeout",
) -> Robot:
    """Opens the link to the robot named `robot`; use the result in a `with` statement.

    Does not wait for the daemon; wait_for_state() does.

    Args:
        robot: the name of the robot in the daemon's configuration.
        url: an LCM provider; None for $LCM_DEFAULT_URL or LCM's default.
        client: who commands, shown as the owner of a motor; None for the program's name.
        priority: a client with a higher one takes motors over from a lower one.
        at_end: what leaving the `with` statement does. "timeout": the commands end, and each motor
            does its `on_timeout`, as when the program dies; it stays ACTIVE. "disable": motors that
            this program enabled are disabled, and do their `on_disable`. "coast": those that it
            commanded lose their torque, and are disabled.

    Raises:
        LinkError: LCM could not start, usually for want of a multicast route.
        ValueError: a name that no robot or client can have.
    """
    return Robot(robot, LcmLink(url), client_name(client), priority, at_end)


class Robot(RobotClient):
    """One robot, seen from one client program. Use it from one thread.

    Nothing happens in the background. Messages are received while spin(), wait_for_state(),
    rate() or a request waits, and meanwhile the targets of move_to() are sent again. Other
    commands are sent by command() alone, and each acts only for its validity: a program that
    hangs or dies lets go of the motors.

    Leaving the `with` statement, by an exception too, ends the commands: each motor does its
    `on_timeout`, as when the program dies. Argument at_end of connect() says otherwise. The inputs
    given to modules end in any case.

    Args:
        name: the name of the robot.
        link: the transport; connect() makes one.
        client: who commands.
        priority: see connect().
        at_end: see connect().
    """

    # ---- leaving -----------------------------------------------------------------------------

    def __init__(
        self,
        name: str,
        link: Link,
        client: str,
        priority: int = 0,
        at_end: AtEnd = "timeout",
    ) -> None:
        super().__init__(name, link, client, priority, at_end)
        self._modules: dict[str, WaitingModule] = {}

    def __enter__(self) -> Robot:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def close(self) -> None:
        """Ends what acts, as `at_end` says, and closes the link. Takes half a second at most.

        Does not raise for what the daemon says or fails to say, so that it cannot hide the
        exception that led here; a release that was not confirmed is logged as a warning.
        """
        if self._closed:
            return
        try:
            target = self._let_go()
            if target is not None:
                self.request("disable", target, AT_END, RELEASE_TIMEOUT_S)
        except Rc10Error as error:
            _log.warning("leaving %s: motors may still be enabled: %s", self._name, error)
        finally:
            self._closed = True
            self._link.close()

    # ---- receiving ---------------------------------------------------------------------------

    def spin(self, timeout_s: float = 0.0) -> int:
        """Receives: waits at most `timeout_s` for a message, then takes all that wait.

        Only after an absence that overflowed LCM's queue (half a second at 200 states a second)
        it takes up to half a second more, to return with a state that is not old.

        Returns:
            How many messages were received; 0 after `timeout_s` without any.
        """
        self._check_open()
        if not self._moves:
            return self._inbox.pump(timeout_s)
        deadline_s = self._link.now() + timeout_s
        while True:
            left_s = max(0.0, deadline_s - self._link.now())
            count = self._inbox.pump(min(left_s, RESEND_S))
            self._advance_moves()
            if count or left_s <= 0.0:
                return count

    def wait_for_state(self, timeout_s: float = 5.0) -> RobotState:
        """Receives until a state arrives that is newer than the one known, and returns it.

        Raises:
            Timeout: none came; the message says what to check.
        """
        known = self._inbox.state
        deadline_s = self._link.now() + timeout_s
        with self._hearing():
            while True:
                left_s = deadline_s - self._link.now()
                self.spin(max(0.0, left_s))
                state = self._inbox.state
                if state is not None and state is not known:
                    return state
                if left_s <= 0:
                    raise Timeout(self._no_state(timeout_s))

    def rate(self, hz: float) -> Rate:
        """Returns an iterator for a control loop, which receives while it waits.

        `for t_s in robot.rate(100): ...` runs the body 100 times a second with the seconds
        since the first time. See Rate for what happens when the body takes too long.
        """
        return Rate(hz, self._link.now, self.spin)

    def module(self, name: str) -> WaitingModule:
        """Returns the module `name`: a chassis, a gimbal, to send() to and to read the state of.

        Ask for it before receiving: its states are received from then on.
        """
        self._check_open()
        if name not in self._modules:
            self._modules[name] = WaitingModule(self._module_parts(name), self.spin)
        return self._modules[name]

    def record(self, seconds: float, motors: Names | None = None) -> Recording:
        """Receives for so long and returns every state of it as NumPy arrays.

        To command motors meanwhile, write a loop of your own in a `with robot.recorder()`.

        Args:
            seconds: how long.
            motors: one name or several; None for all.

        Raises:
            MissingPackage: NumPy is not installed.
            Timeout: no state came; the message says what to check.
            UnknownMotor: the robot has no such motor.
        """
        with self.recorder(motors) as recorder:
            end_s = self._link.now() + seconds
            while (left_s := end_s - self._link.now()) > 0:
                self.spin(left_s)
        if not recorder.count:
            raise Timeout(self._no_state(seconds))
        return recorder.recording()

    def events(self) -> list[Event]:
        """Returns the events received since the last call, oldest first, 1000 at most."""
        events = list(self._inbox.events)
        self._inbox.events.clear()
        return events

    # ---- commanding --------------------------------------------------------------------------

    def move_to(
        self,
        name: str,
        angle: float,
        *,
        tolerance_deg: float = 1.0,
        timeout_s: float = 5.0,
        shortest_way: bool = False,
    ) -> Move:
        """Begins to move a motor to an angle; `robot.move_to("lift", 720).result()` waits for it.

        While the program receives (spin(), rate(), result()) the target is sent again, and after
        the move is done as well, until another target is given: a program that hangs lets go.
        It is done when the motor has stood within the tolerance for 60 ms.

        Args:
            name: of the motor.
            angle: in degrees; multi-turn.
            tolerance_deg: how near is near enough.
            timeout_s: how long it may take.
            shortest_way: the angle is one on the circle, reached the shortest way round.

        Raises:
            UnknownMotor: the robot has no such motor.
            NotReceived: no state yet.
        """
        return self._begin_move(name, angle, tolerance_deg, timeout_s, shortest_way, self.spin)

    # ---- requests ----------------------------------------------------------------------------

    def enable(self, names: Names | None = None, timeout_s: float = 2.0) -> Response:
        """Enables motors and waits until each is ACTIVE or has failed, and a state shows it.

        For that state it waits 2 s at most beyond the answer: the slowest `state_hz` is 1.

        Args:
            names: one name or several; None for all.
            timeout_s: how long to wait for the answer.

        Raises:
            RequestRefused: not allowed now, in the daemon's words.
            RequestFailed: with the reason for each motor; the others may be enabled.
            Timeout: no answer; the message says what to check.
            UnknownMotor: a state is known, and it has no such motor; nothing was sent.
        """
        try:
            with self._enabling(names) as target:
                return self.request("enable", target, timeout_s=timeout_s)
        finally:
            self._wait_until_shown()

    def disable(self, names: Names | None = None, timeout_s: float = 2.0) -> Response:
        """Disables motors: each does its `on_disable`, which may hold, damp or brake it.

        Their moves end before it is sent: also when it is refused, or not answered, their targets
        are not sent again. Args and errors are those of enable().
        """
        with self._disabling(names) as target:
            return self.request("disable", target, timeout_s=timeout_s)

    def clear(self, names: Names | None = None, timeout_s: float = 2.0) -> Response:
        """Clears latched faults, and without names a latched emergency stop. Enables nothing.

        Args and errors are those of enable().
        """
        return self.request("clear", self._target(names), timeout_s=timeout_s)

    def zero(self, name: str, timeout_s: float = 2.0) -> Response:
        """Makes the present angle of one motor its zero; not while it is ACTIVE.

        Errors are those of enable().
        """
        return self.request("zero", self._target(name), timeout_s=timeout_s)

    def gains(self, name: str, timeout_s: float = 2.0) -> Gains:
        """Returns the gains in force of the loops that rc10d closes for a motor.

        Raises:
            RequestRefused: no such motor, or its drive closes its loops with its own gains.
            Timeout: no answer; the message says what to check.
        """
        return gains_in(self.request("get_config", self._target(name), timeout_s=timeout_s))

    def set_gains(self, name: str, gains: Mapping[str, float], timeout_s: float = 2.0) -> Gains:
        """Changes gains of a motor, also while it is ACTIVE, without a bump; all or none of them.

        They are lost when rc10d restarts: the `yaml` of what is returned is for the robot's file.

        Args:
            name: of the motor.
            gains: by the keys of the configuration ("velocity_pid.kp_a_per_rpm") or in brief
                ("velocity.kp").
            timeout_s: how long to wait for the answer.

        Returns:
            All its gains after that.

        Raises:
            RequestRefused: an unknown gain or one out of its range, in the daemon's words.
            Timeout: no answer; the message says what to check.
        """
        self.request("set_gains", self._target(name), gains, timeout_s=timeout_s)
        return self.gains(name, timeout_s=timeout_s)

    def estop(self, timeout_s: float = 2.0) -> None:
        """Stops the whole robot; latched until clear(). All moves end, whatever comes of it.

        Repeated until the robot's state shows it, so that lost messages do not matter.

        Raises:
            Timeout: the state did not show it in time: use the hardware emergency stop.
            RequestRefused, RequestFailed: in the daemon's words.
        """
        self._check_open()
        with self._open("estop", "", {}) as request:
            deadline_s = self._link.now() + timeout_s
            request.publish()
            # A state from the queue was published before, and proves nothing.
            self.spin(0.0)
            known = self._inbox.state
            while True:
                repeat_s = min(self._link.now() + REPEAT_ESTOP_S, deadline_s)
                while (left_s := repeat_s - self._link.now()) > 0:
                    self.spin(left_s)
                    state = self._inbox.state
                    if state is not None and state is not known and state.estopped:
                        return
                    request.response()
                if self._link.now() >= deadline_s:
                    raise Timeout(self._no_estop(timeout_s))
                request.publish()

    def request(
        self,
        operation: str,
        target: str = "",
        values: Mapping[str, float] | None = None,
        timeout_s: float = 2.0,
    ) -> Response:
        """Sends any request and waits for its answer; the methods above are the usual ones.

        Repeated under the same number until it is answered; the daemon carries it out once.

        Args:
            operation: what to do, for example "set_gains".
            target: names of motors, separated by commas; empty for all.
            values: arguments, named with their units.
            timeout_s: how long to wait for the answer.

        Raises:
            RequestRefused, RequestFailed: in the daemon's words.
            Timeout: no answer; the message says what to check.
        """
        self._check_open()
        with self._open(operation, target, values or {}) as request:
            deadline_s = self._link.now() + timeout_s
            while self._link.now() < deadline_s:
                request.publish()
                repeat_s = min(self._link.now() + REPEAT_REQUEST_S, deadline_s)
                while (left_s := repeat_s - self._link.now()) > 0:
                    self.spin(left_s)
                    response = request.response()
                    if response is not None:
                        return response
        raise Timeout(self._no_answer(operation, timeout_s))

    def _wait_until_shown(self) -> None:
        deadline_s = self._link.now() + SHOWN_S
        while self._unshown() and (left_s := deadline_s - self._link.now()) > 0:
            self.spin(left_s)
