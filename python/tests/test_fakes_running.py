"""Several motors on a bus, the clock that drives them, and the command line."""

from __future__ import annotations

import errno
import math
import signal
import subprocess
import sys
import uuid
from collections.abc import Iterator

import can
import pytest

from rc10.fakes import Drives, FakeMotor, MotorSpec, Runner


def drives(*texts: str, **options: object) -> Drives:
    motors = [FakeMotor(MotorSpec.parse(text)) for text in texts]
    return Drives(motors, **options)  # type: ignore[arg-type]


def ids(fakes: Drives) -> list[int]:
    return [message.arbitration_id for message in fakes.feedback()]


def frame(arbitration_id: int, data: str) -> can.Message:
    return can.Message(
        arbitration_id=arbitration_id, is_extended_id=False, data=bytes.fromhex(data)
    )


class Clock:
    """Passes only by sleeping; a test can make a sleep too long."""

    def __init__(self) -> None:
        self.ns = 5_000_000_000
        self.sleeps: list[float] = []
        self.too_long_ns: dict[int, int] = {}

    def now_ns(self) -> int:
        return self.ns

    def sleep(self, seconds: float) -> None:
        self.ns += round(seconds * 1e9) + self.too_long_ns.get(len(self.sleeps), 0)
        self.sleeps.append(seconds)


@pytest.fixture
def clock() -> Clock:
    return Clock()


@pytest.fixture
def buses() -> Iterator[tuple[can.BusABC, can.BusABC]]:
    """The drives' and the host's end of one bus."""
    channel = uuid.uuid4().hex
    pair = can.Bus(channel, "virtual"), can.Bus(channel, "virtual")
    yield pair
    for bus in pair:
        bus.shutdown()


def received(bus: can.BusABC) -> list[can.Message]:
    return list(iter(lambda: bus.recv(timeout=0), None))


def never() -> bool:
    return False


# ---- several motors ------------------------------------------------------------------------------


def test_a_group_frame_reaches_its_members_only() -> None:
    fakes = drives("M3508:1", "M2006:3", "M3508:5", "GM6020:5", "GM6020:6:voltage")
    assert fakes.command_ids == [0x1FF, 0x200, 0x2FE, 0x2FF]
    fakes.receive(frame(0x200, "20 00 20 00 09 C4 20 00"))
    assert [motor.command for motor in fakes.motors] == [10.0, 2.5, 0.0, 0.0, 0.0]
    fakes.receive(frame(0x2FE, "20 00 20 00 20 00 20 00"))
    assert [motor.command for motor in fakes.motors] == [10.0, 2.5, 0.0, 1.5, 0.0]


def test_feedback_does_not_wait_for_commands() -> None:
    fakes = drives("M3508:1", "M2006:6", "GM6020:7")
    for _ in range(3):
        fakes.step(0.001)
        assert ids(fakes) == [0x201, 0x206, 0x20B]
    assert fakes.sent == {"M3508:1": 3, "M2006:6": 3, "GM6020:7": 3}


def test_a_cut_cable_neither_sends_nor_hears_and_the_motor_goes_on() -> None:
    fakes = drives("M3508:1", "M3508:2", silent_after_s={"M3508:1": 0.5})
    fakes.receive(frame(0x200, "08 00 08 00 00 00 00 00"))
    fakes.step(0.499)
    assert ids(fakes) == [0x201, 0x202]
    fakes.step(0.001)
    assert ids(fakes) == [0x202]
    fakes.receive(frame(0x200, "00 00 00 00 00 00 00 00"))
    cut, whole = fakes.motors
    assert (cut.command, whole.command) == (2.5, 0.0)


def test_frames_are_lost_at_random_and_the_same_ones_with_the_same_seed() -> None:
    def lost(seed: int) -> list[bool]:
        fakes = drives("M3508:1", "M3508:2", drop={"M3508:1": 0.25}, seed=seed)
        pattern = [ids(fakes) == [0x202] for _ in range(2000)]
        assert fakes.dropped == {"M3508:1": sum(pattern), "M3508:2": 0}
        assert fakes.sent == {"M3508:1": 2000 - sum(pattern), "M3508:2": 2000}
        return pattern

    assert sum(lost(1)) == pytest.approx(500, abs=60)
    assert lost(1) == lost(1)
    assert lost(1) != lost(2)


@pytest.mark.parametrize(
    "options",
    [{"drop": {"M3508:2": 0.1}}, {"drop": {"M3508:1": 1.1}}, {"silent_after_s": {"M2006:1": 1}}],
)
def test_options_for_nobody_are_refused(options: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"^M\d+:\d: "):
        drives("M3508:1", **options)


# ---- the runner ----------------------------------------------------------------------------------


def test_it_answers_at_its_rate_on_an_absolute_grid(
    buses: tuple[can.BusABC, can.BusABC], clock: Clock
) -> None:
    bus, host = buses
    fakes = drives("M3508:1", "GM6020:7")
    Runner(bus, fakes, 500, now_ns=clock.now_ns, sleep=clock.sleep).run(never, duration_s=0.1)
    assert [m.arbitration_id for m in received(host)] == [0x201, 0x20B] * 50
    assert clock.sleeps == pytest.approx([0.002] * 50)
    assert clock.ns == 5_100_000_000


def test_a_command_acts_and_shows_in_the_next_feedback(
    buses: tuple[can.BusABC, can.BusABC], clock: Clock
) -> None:
    bus, host = buses
    host.send(frame(0x200, "10 00 00 00 00 00 00 00"))
    host.send(frame(0x200, "20 00 00 00 00 00 00 00"))
    host.send(frame(0x123, "FF FF 00 00 00 00 00 00"))
    runner = Runner(bus, drives("M3508:1"), now_ns=clock.now_ns, sleep=clock.sleep)
    runner.run(never, duration_s=0.001)
    (feedback,) = received(host)
    assert feedback.data[4:6] == bytes.fromhex("20 00")


def test_late_ticks_are_skipped_and_counted(
    buses: tuple[can.BusABC, can.BusABC], clock: Clock
) -> None:
    bus, host = buses
    clock.too_long_ns[3] = 4_300_000
    fakes = drives("M3508:1")
    fakes.receive(frame(0x200, "10 00 00 00 00 00 00 00"))
    runner = Runner(bus, fakes, now_ns=clock.now_ns, sleep=clock.sleep)
    runner.run(never, duration_s=0.02)
    assert runner.late_ticks == 4
    assert len(received(host)) == 16
    assert clock.sleeps[4] == pytest.approx(0.0007), "back on the grid"
    on_time = FakeMotor(MotorSpec.parse("M3508:1"))
    on_time.decode_command(frame(0x200, "10 00 00 00 00 00 00 00"))
    on_time.step(0.02)
    assert fakes.motors[0].speed_rad_s == pytest.approx(on_time.speed_rad_s), "no time was lost"


def test_a_flood_does_not_stop_it(buses: tuple[can.BusABC, can.BusABC], clock: Clock) -> None:
    bus, host = buses
    for _ in range(1000):
        host.send(frame(0x200, "00 00 00 00 00 00 00 00"))
    runner = Runner(bus, drives("M3508:1"), now_ns=clock.now_ns, sleep=clock.sleep)
    runner.run(never, duration_s=0.003)
    assert len(received(host)) == 3


class FailingBus:
    """Takes and gives nothing, with an error."""

    def __init__(self, code: int | None) -> None:
        self._code = code

    def set_filters(self, filters: object) -> None:
        pass

    def send(self, _: can.Message) -> None:
        raise can.CanOperationError("no", self._code)

    def recv(self, *, timeout: float) -> can.Message | None:  # noqa: ARG002
        raise can.CanOperationError("no", self._code)


@pytest.mark.parametrize("code", [None, errno.ENOBUFS, errno.ENETDOWN])
def test_a_busy_or_downed_interface_costs_frames_only(code: int | None, clock: Clock) -> None:
    bus = FailingBus(code)
    runner = Runner(bus, drives("M3508:1"), now_ns=clock.now_ns, sleep=clock.sleep)  # type: ignore[arg-type]
    runner.run(never, duration_s=0.01)
    assert runner.lost_frames == 10


def test_an_interface_that_is_gone_ends_it(clock: Clock) -> None:
    bus = FailingBus(errno.ENODEV)
    runner = Runner(bus, drives("M3508:1"), now_ns=clock.now_ns, sleep=clock.sleep)  # type: ignore[arg-type]
    with pytest.raises(can.CanOperationError):
        runner.run(never)


@pytest.mark.parametrize("rate_hz", [0, -1, 1e6, math.nan])
def test_an_impossible_rate_is_refused(
    buses: tuple[can.BusABC, can.BusABC], rate_hz: float
) -> None:
    with pytest.raises(ValueError, match="rate_hz"):
        Runner(buses[0], drives("M3508:1"), rate_hz)


# ---- the command line ----------------------------------------------------------------------------

COMMAND = [sys.executable, "-m", "rc10.fakes", "--interface", "virtual"]


def run_cli(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [*COMMAND, *arguments], capture_output=True, text=True, timeout=60, check=False
    )


def test_it_runs_for_a_while_and_sums_up() -> None:
    result = run_cli(
        *("--motor", "M3508:1", "--motor", "M2006:5", "--motor", "GM6020:7"),
        *("--motor", "GM6020:6:voltage", "--duration", "0.2", "--rate-hz", "100"),
        *("--load-nm", "M3508:1=0.2", "--drop", "M2006:5=1", "--silent-after", "GM6020:7:0.1"),
        *("--angle-deg", "GM6020:6=90", "--seed", "3", "--command-timeout-ms", "20"),
    )
    assert result.returncode == 0, result.stderr
    lines = result.stdout.splitlines()
    assert lines[0] == "ready: M3508:1 M2006:5 GM6020:7 GM6020:6 on virtual:vcan0"
    assert [line.split(":")[0] for line in lines[1:5]] == ["M3508", "M2006", "GM6020", "GM6020"]
    assert "velocity_rpm=-" in lines[1], "the load turned it"
    assert "feedback=0 " in lines[2]
    assert "angle_deg=90.00" in lines[4]
    assert lines[5].startswith("late_ticks=")


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_ends_it_in_order(number: signal.Signals) -> None:
    process = subprocess.Popen([*COMMAND, "--motor", "M3508:1"], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline().startswith("ready")
    process.send_signal(number)
    rest, _ = process.communicate(timeout=30)
    assert process.returncode == 0
    assert rest.startswith("M3508:1: commands=0 feedback=")


@pytest.mark.parametrize(
    ("arguments", "complaint"),
    [
        (["--motor", "M2006:5", "--motor", "GM6020:1"], "M2006:5 and GM6020:1 would both send"),
        (["--motor", "M2006:9"], "M2006 has the ids 1 to 8"),
        (["--motor", "M2006:1", "--load-nm", "M3508:1=1"], "M3508:1: no such motor here"),
        (["--motor", "M2006:1", "--drop", "M2006:1"], "give the name of a motor and a number"),
        (["--motor", "M2006:1", "--drop", "0.5"], "give the name of a motor and a number"),
        (["--motor", "M2006:1", "--rate-hz", "0"], "not within 0 to 10000"),
        ([], "--motor"),
    ],
)
def test_a_wrong_command_line_is_explained(arguments: list[str], complaint: str) -> None:
    result = run_cli(*arguments)
    assert result.returncode == 2
    assert complaint in result.stderr


def test_a_missing_interface_is_explained() -> None:
    result = run_cli("--interface", "socketcan", "--channel", "nocan9", "--motor", "M3508:1")
    assert result.returncode == 1
    assert "cannot open socketcan:nocan9" in result.stderr
    assert "ip link add nocan9 type vcan" in result.stderr
