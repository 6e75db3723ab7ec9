"""The client for asyncio, of the same shape as rc10.Robot.

    async with rc10.aio.connect("demo") as robot:
        await robot.wait_for_state()
        await robot.enable("wheel")
        async for t_s in robot.rate(100):
            robot.command(wheel=rc10.velocity_rpm(120))
            print(robot.motor("wheel").velocity_rpm)

Messages are received whenever the event loop runs. A target that is not sent again expires, here
too: a program whose event loop hangs lets go of the motors.
"""

from __future__ import annotations

import asyncio
import logging
from typing import TYPE_CHECKING, TypeVar

from rc10.errors import LinkError, Rc10Error, Timeout
from rc10.gains import gains_in
from rc10.identity import client_name
from rc10.link import LcmLink, Link
from rc10.modules import Module
from rc10.rate import Grid
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
    from collections.abc import AsyncIterator, Mapping
    from types import TracebackType
    from typing import Callable

    from rc10.events import Event
    from rc10.gains import Gains
    from rc10.modules import ModuleParts, ModuleState
    from rc10.moves import MoveResult
    from rc10.recording import Recording
    from rc10.requests import Response
    from rc10.state import RobotState

_log = logging.getLogger("rc10")

T = TypeVar("T")

# Greatest age of a message that the event loop hands over, unless it stood still.
_PULSE_S = 0.05


def connect(
    robot: str,
    url: str | None = None,
    client: str | None = None,
    priority: int = 0,
    at_end: AtEnd = "timeout",
) -> Robot:
    """Opens the link to the robot named `robot`; use the result in an `async with` statement.

    Args and errors are those of rc10.connect().
    """
    return Robot(robot, LcmLink(url), client_name(client), priority, at_end)


class Rate(Grid):
    """Iterates on an absolute grid, as rc10.Rate does: `async for t_s in robot.rate(100)`."""

    def __aiter__(self) -> Rate:
        return self

    async def __anext__(self) -> float:
        due_s = self.advance()
        # Once in any case: a loop that is always late must not keep others from running.
        await asyncio.sleep(max(0.0, due_s - self._now()))
        return self.elapsed_s


class AsyncModule(Module):
    """A module of rc10.aio.Robot."""

    def __init__(self, parts: ModuleParts, robot: Robot) -> None:
        super().__init__(*parts)
        self._robot = robot

    async def wait_for_state(self, timeout_s: float = 5.0) -> ModuleState:
        """Waits until outputs arrive that are newer than those known, and returns them.

        Raises:
            Timeout: none came; the message says what to check.
        """
        known = self._subscriber.count
        with self._listening():
            state = await self._robot._until(lambda: self._newer(known), timeout_s)
        if state is None:
            raise self._nothing(timeout_s)
        return state


class Robot(RobotClient):
    """One robot, seen from one program. Belongs to the event loop that entered it.

    Leaving the `async with` statement, by an exception or a cancellation too, ends the commands:
    each motor does its `on_timeout`. Argument at_end of connect() says otherwise. The inputs given
    to modules end in any case.

    Args:
        name: the name of the robot.
        link: the transport; connect() makes one.
        client: who commands.
        priority: see rc10.connect().
        at_end: see rc10.connect().
    """

    def __init__(
        self,
        name: str,
        link: Link,
        client: str,
        priority: int = 0,
        at_end: AtEnd = "timeout",
    ) -> None:
        super().__init__(name, link, client, priority, at_end)
        self._modules: dict[str, AsyncModule] = {}
        self._loop: asyncio.AbstractEventLoop | None = None
        self._waiters: set[asyncio.Future[None]] = set()
        self._timer: asyncio.TimerHandle | None = None
        self._pulse: asyncio.TimerHandle | None = None

    # ---- entering and leaving ----------------------------------------------------------------

    async def __aenter__(self) -> Robot:
        self._check_open()
        self._loop = asyncio.get_running_loop()
        self._loop.add_reader(self._link.fileno(), self._receive)
        self._on_pulse()
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await self.close()

    async def close(self) -> None:
        """Ends what acts, as `at_end` says, and closes the link. Takes half a second at most.

        Does not raise for what the daemon says or fails to say; a release that was not
        confirmed is logged as a warning.
        """
        if self._closed:
            return
        try:
            target = self._let_go()
            if target is not None:
                await self.request("disable", target, AT_END, RELEASE_TIMEOUT_S)
        except Rc10Error as error:
            _log.warning("leaving %s: motors may still be enabled: %s", self._name, error)
        finally:
            self._closed = True
            for timer in (self._timer, self._pulse):
                if timer is not None:
                    timer.cancel()
            if self._loop is not None:
                self._loop.remove_reader(self._link.fileno())
            self._link.close()
            self._wake()

    # ---- receiving ---------------------------------------------------------------------------

    async def wait_for_state(self, timeout_s: float = 5.0) -> RobotState:
        """Waits until a state arrives that is newer than the one known, and returns it.

        Raises:
            Timeout: none came; the message says what to check.
        """
        known = self._inbox.state

        def newer() -> RobotState | None:
            state = self._inbox.state
            return None if state is known else state

        with self._hearing():
            state = await self._until(newer, timeout_s)
        if state is None:
            raise Timeout(self._no_state(timeout_s))
        return state

    def module(self, name: str) -> AsyncModule:
        """Returns the module `name`: a chassis, a gimbal, to send() to and to read the state of.

        Ask for it before receiving: its states are received from then on.
        """
        self._check_open()
        if name not in self._modules:
            self._modules[name] = AsyncModule(self._module_parts(name), self)
        return self._modules[name]

    async def states(self, timeout_s: float = 5.0) -> AsyncIterator[RobotState]:
        """Yields each new state. A loop that is slower than they come skips to the newest.

        Args:
            timeout_s: how long it may be silent.

        Raises:
            Timeout: no state for so long; the message says what to check.
        """
        while True:
            yield await self.wait_for_state(timeout_s)

    async def events(self) -> AsyncIterator[Event]:
        """Yields the events received, also those before the call; each once, whoever asks."""
        while True:
            waiting = self._inbox.events
            while waiting:
                yield waiting.popleft()
            await self._news()

    def rate(self, hz: float) -> Rate:
        """Returns an iterator for a control loop: `async for t_s in robot.rate(100)`."""
        return Rate(hz, self._link.now)

    async def record(self, seconds: float, motors: Names | None = None) -> Recording:
        """Waits for so long and returns every state of it as NumPy arrays.

        Other tasks may command motors meanwhile. Args and errors are those of
        rc10.Robot.record().
        """
        self._check_entered()
        if motors is not None and self._inbox.state is None:
            await self.wait_for_state()  # whose names are those of the motors
        with self.recorder(motors) as recorder:
            await asyncio.sleep(seconds)
            self._receive()  # messages that came while other tasks kept the loop
        if not recorder.count:
            raise Timeout(self._no_state(seconds))
        return recorder.recording()

    # ---- commanding --------------------------------------------------------------------------

    async def move_to(
        self,
        name: str,
        angle: float,
        *,
        tolerance_deg: float = 1.0,
        timeout_s: float = 5.0,
        shortest_way: bool = False,
    ) -> MoveResult:
        """Moves a motor to an angle and tells how that ended; asyncio.gather() moves several.

        The target is sent again from then on, after the move is done as well, until another
        target is given or the event loop hangs. Args and errors are those of
        rc10.Robot.move_to().
        """
        self._check_entered()
        move = self._begin_move(
            name, angle, tolerance_deg, timeout_s, shortest_way, _not_to_be_called
        )
        self._schedule()
        try:
            while not move.done():
                await self._news()
        except asyncio.CancelledError:
            self._abandon(move)
            raise
        return move.result()

    # ---- requests ----------------------------------------------------------------------------

    async def enable(self, names: Names | None = None, timeout_s: float = 2.0) -> Response:
        """Enables motors and waits until each is ACTIVE or has failed, and a state shows it.

        Args and errors are those of rc10.Robot.enable().
        """
        try:
            with self._enabling(names) as target:
                return await self.request("enable", target, timeout_s=timeout_s)
        finally:
            if self._unshown():
                await self._until(lambda: None if self._unshown() else True, SHOWN_S)

    async def disable(self, names: Names | None = None, timeout_s: float = 2.0) -> Response:
        """Disables motors: each does its `on_disable`, which may hold, damp or brake it.

        Their moves end before it is sent, as those of rc10.Robot.disable().
        """
        with self._disabling(names) as target:
            return await self.request("disable", target, timeout_s=timeout_s)

    async def clear(self, names: Names | None = None, timeout_s: float = 2.0) -> Response:
        """Clears latched faults, and without names a latched emergency stop. Enables nothing."""
        return await self.request("clear", self._target(names), timeout_s=timeout_s)

    async def zero(self, name: str, timeout_s: float = 2.0) -> Response:
        """Makes the present angle of one motor its zero; not while it is ACTIVE."""
        return await self.request("zero", self._target(name), timeout_s=timeout_s)

    async def gains(self, name: str, timeout_s: float = 2.0) -> Gains:
        """Returns the gains in force of a motor.

        Errors are those of rc10.Robot.gains().
        """
        return gains_in(await self.request("get_config", self._target(name), timeout_s=timeout_s))

    async def set_gains(
        self, name: str, gains: Mapping[str, float], timeout_s: float = 2.0
    ) -> Gains:
        """Changes gains of a motor, also while it is ACTIVE, and returns all of them after that.

        Args and errors are those of rc10.Robot.set_gains().
        """
        await self.request("set_gains", self._target(name), gains, timeout_s=timeout_s)
        return await self.gains(name, timeout_s=timeout_s)

    async def estop(self, timeout_s: float = 2.0) -> None:
        """Stops the whole robot; latched until clear(). All moves end, whatever comes of it.

        Repeated until the robot's state shows it. Errors are those of rc10.Robot.estop().
        """
        self._check_entered()
        with self._open("estop", "", {}) as request:
            request.publish()
            # A state from the queue was published before, and proves nothing.
            self._receive()
            known = self._inbox.state

            def stopped() -> bool | None:
                request.response()
                state = self._inbox.state
                shown = state is not None and state is not known and state.estopped
                return True if shown else None

            await self._repeat(request.publish, REPEAT_ESTOP_S, stopped, timeout_s)
            if stopped() is None:
                raise Timeout(self._no_estop(timeout_s))

    async def request(
        self,
        operation: str,
        target: str = "",
        values: Mapping[str, float] | None = None,
        timeout_s: float = 2.0,
    ) -> Response:
        """Sends any request and waits for its answer; several may wait at the same time.

        Args and errors are those of rc10.Robot.request().
        """
        self._check_entered()
        with self._open(operation, target, values or {}) as request:
            request.publish()
            await self._repeat(request.publish, REPEAT_REQUEST_S, request.response, timeout_s)
            response = request.response()
        if response is None:
            raise Timeout(self._no_answer(operation, timeout_s))
        return response

    # ---- within ------------------------------------------------------------------------------

    def _check_entered(self) -> None:
        self._check_open()
        if self._loop is None:
            raise LinkError("use the robot in an `async with` statement")

    def _receive(self) -> None:
        self._inbox.poll()
        self._advance_moves()
        self._wake()

    def _wake(self) -> None:
        for waiter in self._waiters:
            if not waiter.done():
                waiter.set_result(None)

    async def _news(self, timeout_s: float | None = None) -> None:
        """Waits until something was received, or for so long."""
        self._check_entered()
        assert self._loop is not None
        waiter: asyncio.Future[None] = self._loop.create_future()
        self._waiters.add(waiter)
        try:
            await asyncio.wait([waiter], timeout=timeout_s)
        finally:
            self._waiters.discard(waiter)
        self._check_open()

    async def _until(self, look: Callable[[], T | None], timeout_s: float) -> T | None:
        """Looks after each reception, until there is something or the time is over."""
        self._check_entered()
        end_s = self._link.now() + timeout_s
        while (found := look()) is None and (left_s := end_s - self._link.now()) > 0:
            await self._news(left_s)
        return found

    async def _repeat(
        self,
        act: Callable[[], None],
        period_s: float,
        look: Callable[[], object | None],
        timeout_s: float,
    ) -> None:
        """Acts again after each period, until there is something or the time is over."""
        end_s = self._link.now() + timeout_s
        while (left_s := end_s - self._link.now()) > 0:
            if await self._until(look, min(period_s, left_s)) is not None:
                return
            act()

    def _schedule(self) -> None:
        if self._loop is not None and self._timer is None and self._moves:
            self._timer = self._loop.call_later(RESEND_S, self._on_timer)

    def _on_pulse(self) -> None:
        """Receives also where nothing comes, so that the link knows since when."""
        assert self._loop is not None
        self._pulse = self._loop.call_later(_PULSE_S, self._on_pulse)
        self._receive()

    def _on_timer(self) -> None:
        self._timer = None
        self._advance_moves()
        self._wake()
        self._schedule()


def _not_to_be_called(_: float) -> object:
    raise RuntimeError("await robot.move_to()")
