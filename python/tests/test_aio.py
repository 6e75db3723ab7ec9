"""The asyncio client. One event loop holds it and a fake daemon, on one memq link."""

from __future__ import annotations

import asyncio
import contextlib
import functools
from collections.abc import AsyncIterator, Awaitable
from contextlib import asynccontextmanager
from typing import Callable

import pytest

import rc10
from fake_daemon import FakeDaemon, setpoints
from rc10 import aio
from rc10.lcm_types import (
    counter_t,
    request_t,
    response_t,
    robot_state_t,
    service_request_t,
    service_response_t,
    setpoint_t,
    signals_t,
)
from rc10.link import LcmLink
from rc10.services import fingerprint

# Long enough for any machine; nothing waits for it when all is well.
PATIENCE_S = 30.0


class ObedientDaemon(FakeDaemon):
    """Its wheel is where it is told to be."""

    follows = True

    def state(self) -> robot_state_t:
        message = super().state()
        wheel = message.motors[0]
        wheel.zeroed = True
        if self.commands:
            wheel.owner = self.commands[-1].client
            wheel.mode, wheel.target = setpoints(self.commands[-1]).get("wheel", (0, 0.0))
            wheel.total_angle_deg = wheel.target if self.follows else 0.0
        return message


@asynccontextmanager
async def publishing(daemon: FakeDaemon) -> AsyncIterator[None]:
    """Has the daemon publish its state over and over."""

    async def publish() -> None:
        while True:
            daemon.publish_state()
            await asyncio.sleep(0.002)

    task = asyncio.create_task(publish())
    try:
        yield
    finally:
        task.cancel()


def in_loop(
    test: Callable[[aio.Robot, ObedientDaemon], Awaitable[None]],
) -> Callable[[], None]:
    """Runs a test that is given a robot, and a daemon that publishes."""

    @functools.wraps(test)
    def run() -> None:
        async def main() -> None:
            link = LcmLink("memq://")
            daemon = ObedientDaemon("demo", link)
            async with aio.Robot("demo", link, client="tester") as robot, publishing(daemon):
                await asyncio.wait_for(test(robot, daemon), PATIENCE_S)

        asyncio.run(main())

    # Or pytest would take the test's arguments for fixtures.
    del run.__wrapped__
    return run


@in_loop
async def test_states_come_as_they_are_new(robot: aio.Robot, daemon: ObedientDaemon) -> None:
    ticks: list[int] = []
    async for state in robot.states():
        ticks.append(state.tick)
        if len(ticks) == 5:
            break
    assert ticks == sorted(set(ticks))
    assert robot.motor("wheel").velocity_rpm == 12.5
    assert daemon.tick >= 5


@in_loop
async def test_a_slow_reader_gets_the_newest_state(
    robot: aio.Robot, daemon: ObedientDaemon
) -> None:
    states = robot.states()
    await states.__anext__()
    while daemon.tick < 20:
        await asyncio.sleep(0.01)
    assert (await states.__anext__()).tick >= 19


@in_loop
async def test_a_loop_commands_and_leaving_is_a_timeout(
    robot: aio.Robot, daemon: ObedientDaemon
) -> None:
    await robot.enable("wheel")
    assert daemon.active == {"wheel"}
    async for t_s in robot.rate(200):
        robot.command(wheel=rc10.velocity_rpm(60), validity_ms=1000)
        if daemon.commands:
            break
        assert t_s < PATIENCE_S
    assert setpoints(daemon.commands[0]) == {"wheel": (setpoint_t.MODE_VELOCITY, 60)}
    # memq hands over when it is pumped: what close() sends would go with the link.
    link, close = robot.link, robot.link.close
    link.close = lambda: None  # type: ignore[method-assign]
    await robot.close()
    link.pump(0.0)
    close()
    assert daemon.operations() == ["enable wheel"]
    assert setpoints(daemon.commands[-1]) == {"wheel": (setpoint_t.MODE_VELOCITY, 60)}
    assert daemon.commands[-1].validity_ms == 1
    with pytest.raises(rc10.LinkError, match="closed"):
        await robot.wait_for_state()


@in_loop
async def test_a_lost_answer_is_asked_for_again(robot: aio.Robot, daemon: ObedientDaemon) -> None:
    daemon.lost_answers = 1
    await robot.enable("wheel", timeout_s=PATIENCE_S)
    assert daemon.operations() == ["enable wheel"]
    assert len(daemon.received) >= 2


@in_loop
async def test_requests_at_the_same_time_get_their_own_answers(
    robot: aio.Robot, daemon: ObedientDaemon
) -> None:
    daemon.verdicts["zero"] = (response_t.STATUS_FAILED, "yaw: no feedback")
    enabled, zeroed = await asyncio.gather(
        robot.enable("wheel", timeout_s=PATIENCE_S),
        robot.zero("yaw", timeout_s=PATIENCE_S),
        return_exceptions=True,
    )
    assert isinstance(enabled, rc10.Response)
    assert isinstance(zeroed, rc10.RequestFailed)
    assert str(zeroed) == "zero yaw: failed: yaw: no feedback"


def test_a_refused_enable_forgets_no_other_that_was_asked_for_at_the_same_time() -> None:
    class Choosy(ObedientDaemon):
        def _execute(self, request: request_t) -> response_t:
            refuses = request.operation == "enable" and request.target == "yaw"
            verdict = (response_t.STATUS_REFUSED, "not that one")
            self.verdicts = {"enable": verdict} if refuses else {}
            return super()._execute(request)

    async def main() -> None:
        link = LcmLink("memq://")
        daemon = Choosy("demo", link)
        async with aio.Robot("demo", link, client="tester", at_end="disable") as robot:
            outcomes = await asyncio.gather(
                robot.enable("yaw", timeout_s=PATIENCE_S),
                robot.enable("wheel", timeout_s=PATIENCE_S),
                return_exceptions=True,
            )
        assert [type(outcome) for outcome in outcomes] == [rc10.RequestRefused, rc10.Response]
        assert daemon.operations() == ["enable yaw", "enable wheel", "disable wheel"]

    asyncio.run(main())


@in_loop
async def test_gains_are_set_and_told(robot: aio.Robot, daemon: ObedientDaemon) -> None:
    daemon.verdicts["get_config"] = (response_t.STATUS_OK, "angle_pid: {kp_rpm_per_deg: 3}")
    daemon.values = {"angle_pid.kp_rpm_per_deg": 3.0}
    gains = await robot.set_gains("wheel", {"angle.kp": 3.0}, timeout_s=PATIENCE_S)
    assert daemon.operations()[-2:] == ["set_gains wheel", "get_config wheel"]
    assert gains == {"angle_pid.kp_rpm_per_deg": 3.0}
    assert gains.yaml == "angle_pid: {kp_rpm_per_deg: 3}"


@in_loop
async def test_silence_says_what_to_check(robot: aio.Robot, daemon: ObedientDaemon) -> None:
    daemon.deaf_to_requests = 1000
    with pytest.raises(rc10.Timeout, match="no answer to 'enable'"):
        await robot.enable("wheel", timeout_s=0.01)
    daemon.deaf_to_requests = 0


@in_loop
async def test_an_emergency_stop_waits_until_the_state_shows_it(
    robot: aio.Robot, daemon: ObedientDaemon
) -> None:
    await robot.estop(PATIENCE_S)
    assert robot.state.estopped
    daemon.estopped = daemon.shows_estop = False
    with pytest.raises(rc10.Timeout, match="use the hardware emergency stop"):
        await robot.estop(0.05)
    assert len(daemon.received) >= 2


@in_loop
async def test_an_emergency_stop_is_repeated_until_it_arrives(
    robot: aio.Robot, daemon: ObedientDaemon
) -> None:
    daemon.deaf_to_requests = 2
    await robot.estop(PATIENCE_S)
    assert robot.state.estopped
    assert daemon.deaf_to_requests == 0


@in_loop
async def test_events_come_once_each(robot: aio.Robot, daemon: ObedientDaemon) -> None:
    daemon.publish_event("first")
    events = robot.events()
    assert (await events.__anext__()).text == "first"
    asyncio.get_running_loop().call_later(0.01, lambda: daemon.publish_event("second"))
    assert (await events.__anext__()).text == "second"


@in_loop
async def test_a_move_is_awaited_and_its_target_held(
    robot: aio.Robot, daemon: ObedientDaemon
) -> None:
    await robot.wait_for_state()
    await robot.enable("wheel", timeout_s=PATIENCE_S)
    result = await robot.move_to("wheel", 720, timeout_s=PATIENCE_S)
    assert result, result.reason
    # It is sent on after that.
    sent = len(daemon.commands)
    while len(daemon.commands) < sent + 3:
        await robot.wait_for_state()
    assert setpoints(daemon.commands[-1])["wheel"] == (setpoint_t.MODE_TOTAL_ANGLE, 720)


@in_loop
async def test_a_move_that_is_cancelled_is_not_sent_any_more(
    robot: aio.Robot, daemon: ObedientDaemon
) -> None:
    await robot.wait_for_state()
    await robot.enable("wheel")
    task = asyncio.create_task(robot.move_to("wheel", 720, timeout_s=PATIENCE_S))
    while not daemon.commands:
        await robot.wait_for_state()
    task.cancel()
    with contextlib.suppress(asyncio.CancelledError):
        await task
    for _ in range(3):
        await robot.wait_for_state()
    assert daemon.commands[-1].validity_ms == 1, "its target ends now"


@pytest.mark.parametrize("stop", ["disable", "disable all", "request", "estop"])
def test_a_stop_in_vain_ends_a_move_all_the_same(stop: str) -> None:
    stops: dict[str, Callable[[aio.Robot], Awaitable[object]]] = {
        "disable": lambda robot: robot.disable("wheel", timeout_s=PATIENCE_S),
        "disable all": lambda robot: robot.disable(timeout_s=PATIENCE_S),
        "request": lambda robot: robot.request("disable", "wheel", timeout_s=PATIENCE_S),
        "estop": lambda robot: robot.estop(PATIENCE_S),
    }

    @in_loop
    async def run(robot: aio.Robot, daemon: ObedientDaemon) -> None:
        refused = (response_t.STATUS_REFUSED, "too many requests at once")
        daemon.verdicts.update(dict.fromkeys(("disable", "estop"), refused))
        await robot.wait_for_state()
        await robot.enable("wheel", timeout_s=PATIENCE_S)
        daemon.follows = False
        move = asyncio.create_task(robot.move_to("wheel", 720, timeout_s=PATIENCE_S))
        while not daemon.commands:
            await robot.wait_for_state()
        with pytest.raises(rc10.RequestRefused):
            await stops[stop](robot)
        assert (await move).reason == "the program has let go of wheel"
        sent = len(daemon.commands)
        for _ in range(100):
            await robot.wait_for_state()
        assert len(daemon.commands) == sent

    run()


@in_loop
async def test_recording_while_another_task_commands(
    robot: aio.Robot, daemon: ObedientDaemon
) -> None:
    await robot.wait_for_state()
    await robot.enable("wheel")
    task = asyncio.create_task(robot.record(1.0, ["wheel"]))
    async for _ in robot.rate(100):
        robot.command(wheel=rc10.velocity_rpm(60))
        if task.done():
            break
    recording = task.result()
    assert recording["wheel.target"][-1] == 60
    assert daemon.tick >= len(recording)


def test_a_service_refuses_what_came_while_the_event_loop_stood_still() -> None:
    class Clocked(LcmLink):
        ahead_s = 0.0

        def now(self) -> float:
            return super().now() + self.ahead_s

    async def main() -> None:
        link = Clocked("memq://")
        calls: list[int] = []

        def handle(request: counter_t) -> counter_t:
            calls.append(request.count)
            return request

        async with aio.Robot("demo", link, client="tester") as robot:
            server = rc10.ServiceServer(robot.link, "echo", counter_t, counter_t, handle)
            answers = rc10.Subscriber(link, "echo.response", service_response_t)

            async def answer_to(number: int, away_s: float) -> int:
                request = service_request_t()
                request.client, request.seq, request.timeout_ms = "tester", number, 30_000
                request.request_type = request.response_type = fingerprint(counter_t)
                message = counter_t()
                message.count = number
                request.payload = message.encode()
                request.size = len(request.payload)
                link.publish(f"{server.name}.request", request.encode())
                link.ahead_s += away_s
                while answers.latest is None or answers.latest.message.seq != number:
                    await asyncio.sleep(0)
                status: int = answers.latest.message.status
                return status

            assert await answer_to(1, 60.0) == service_response_t.STATUS_REFUSED
            assert await answer_to(2, 0.0) == service_response_t.STATUS_OK
            # On a link without any message the event loop still tells that it runs.
            link.ahead_s += 60.0
            seen_s = link.empty_s()
            while link.empty_s() == seen_s:
                await asyncio.sleep(0.001)
            assert await answer_to(3, 0.0) == service_response_t.STATUS_OK
            assert calls == [2, 3]

    asyncio.run(asyncio.wait_for(main(), PATIENCE_S))


def test_it_wants_to_be_entered() -> None:
    async def main() -> None:
        link = LcmLink("memq://")
        robot = aio.Robot("demo", link, client="tester")
        with pytest.raises(rc10.LinkError, match="async with"):
            await robot.wait_for_state()

    asyncio.run(main())


def test_a_cancelled_program_lets_go() -> None:
    link = LcmLink("memq://")
    daemon = ObedientDaemon("demo", link)

    async def program(entered: asyncio.Event) -> None:
        async with aio.Robot("demo", link, client="tester", at_end="coast") as robot:
            await robot.enable("wheel", timeout_s=PATIENCE_S)
            robot.command(wheel=rc10.velocity_rpm(60))
            entered.set()
            await asyncio.sleep(PATIENCE_S)

    async def main() -> None:
        entered = asyncio.Event()
        task = asyncio.create_task(program(entered))
        await entered.wait()
        task.cancel()
        await asyncio.wait([task])

    asyncio.run(main())
    assert daemon.operations() == ["enable wheel", "disable wheel"]
    assert setpoints(daemon.commands[-1]) == {"wheel": (setpoint_t.MODE_COAST, 0)}


@in_loop
async def test_a_module_is_sent_to_and_waited_for(robot: aio.Robot, daemon: ObedientDaemon) -> None:
    seen: list[signals_t] = []
    rc10.Subscriber(robot.link, "demo.v1.base", signals_t, seen.append)
    base = robot.module("base")
    assert base is robot.module("base")
    with pytest.raises(rc10.Timeout, match="nothing of module 'base' within 0 s"):
        await base.wait_for_state(0.0)
    base.send(vx_m_s=0.5)
    message = signals_t()
    message.count, message.names, message.values = 1, ["x_m"], [1.5]
    rc10.Publisher(robot.link, "demo.v1.base.state", signals_t).publish(message)
    state = await base.wait_for_state(PATIENCE_S)
    assert state["x_m"] == 1.5
    assert seen[0].names == ["vx_m_s"]
    assert daemon.commands == []
