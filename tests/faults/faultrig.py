"""The robot of the campaign, what happens to it, and the witness that reads both buses."""

from __future__ import annotations

import bisect
import contextlib
import itertools
import json
import os
import socket
import struct
import subprocess
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import lcm
import rig
from faulty_drives import FAULT_ID, Fault, fault
from guestlib import Candump, Frame, Proc, link_add, link_delete, run
from rig import BIN, MS, currents, wait_status

import rc10
from rc10.lcm_types import command_t, setpoint_t

if TYPE_CHECKING:
    from collections.abc import Iterator
    from contextlib import AbstractContextManager

HERE = Path(__file__).resolve().parent
CONFIG = HERE / "robot.yaml"
TICK_NS = MS
COMMAND = 0x200
FRONT, REAR = "vcan0", "vcan1"
WIRE = "wire0"  # of the front drives, where cangw stands between
# Names by bus and slot of the command frame, and the largest raw value that is configured.
SLOTS = {FRONT: ("left", "right", "arm", None), REAR: ("other", None, None, None)}
LIMIT_RAW = {"left": 8192, "right": 8192, "arm": 10000, "other": 16384}
BRAKES = {"arm": 0x203}  # by their fallback, and the frame that tells their speed; the others coast
# 5 % of the no-load speed of an M2006, of its rotor: beyond this a brake opposes the motion before
# long. Its loop turns its effort round in that time.
FAST_RPM = 0.05 * 500 * 36
OPPOSES_WITHIN_NS = 50 * MS
VALIDITY_MS = 40
COMMAND_PERIOD_MS = 10


@contextlib.contextmanager
def drives(*on_front: str) -> Iterator[None]:
    """Those of robot.yaml, or on the front bus others."""
    names = on_front or ("M3508:1", "M3508:2", "M2006:3")
    front = Proc(sys.executable, HERE / "faulty_drives.py", FRONT, *names)
    rear = Proc(sys.executable, HERE / "faulty_drives.py", REAR, "M3508:1")
    with front, rear:
        front.wait_line("^ready", 30.0)
        rear.wait_line("^ready", 30.0)
        yield


@contextlib.contextmanager
def drives_behind_gateway() -> Iterator[None]:
    """The same, but the front ones have a wire of their own, and cangw between them and rc10d."""
    link_add(WIRE)
    front = Proc(sys.executable, HERE / "faulty_drives.py", WIRE, "M3508:1", "M3508:2", "M2006:3")
    rear = Proc(sys.executable, HERE / "faulty_drives.py", REAR, "M3508:1")
    try:
        with front, rear:
            front.wait_line("^ready", 30.0)
            rear.wait_line("^ready", 30.0)
            run("cangw", "-A", "-s", FRONT, "-d", WIRE, "-e", "-f", f"{COMMAND:X}:7FF")
            for number in (0x201, 0x202, 0x203):
                run("cangw", *_from_drive(number))
            yield
    finally:
        run("cangw", "-F")
        link_delete(WIRE)


def _from_drive(number: int) -> list[str]:
    return ["-A", "-s", WIRE, "-d", FRONT, "-e", "-f", f"{number:X}:7FF"]


def corrupt(number: int, flipped: str) -> None:
    """From now on these bits of the drive's feedback arrive as their opposites."""
    passed = _from_drive(number)
    run("cangw", *passed, "-m", f"XOR:D:{number:X}.8.{flipped}")
    run("cangw", "-D", *passed[1:])


def daemon(config: Path = CONFIG) -> AbstractContextManager[Proc]:
    return rig.daemon(config)


def client(name: str = "test", priority: int = 0) -> AbstractContextManager[rc10.Robot]:
    return rig.client(name, priority, robot_name="faults")


def break_drive(motor_id: int, kind: Fault, argument: int = 0, interface: str = FRONT) -> None:
    run("cansend", interface, f"{FAULT_ID:03X}#{fault(motor_id, kind, argument).hex()}")


def ctl(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(BIN / "rc10ctl"), *words], capture_output=True, text=True, check=False, timeout=60
    )


@dataclass
class Witness:
    """candump of both buses, outside the daemon, and when each motor may have been driven."""

    dump: Candump
    allowed: dict[str, list[tuple[int, int]]] = field(default_factory=dict)
    speeds: dict[str, tuple[list[int], list[tuple[int, int] | None]]] = field(default_factory=dict)

    def driven(
        self, start_ns: int, end_ns: int, *names: str, validity_ms: int = VALIDITY_MS
    ) -> None:
        """Commands for these motors were valid from `start_ns`; the last was sent by `end_ns`."""
        for name in names:
            last = end_ns + validity_ms * MS + TICK_NS
            self.allowed.setdefault(name, []).append((start_ns, last))

    def frames(self, interface: str, after_ns: int = 0) -> list[Frame]:
        return [
            f
            for f in self.dump.frames()
            if f.iface == interface
            and f.id == COMMAND
            and not (f.error or f.rtr)
            and f.t_ns >= after_ns
        ]

    def last_torque_ns(self, name: str) -> int:
        """When the last frame left that gave this motor a current; 0: none did."""
        interface, slot = next((i, s.index(name)) for i, s in SLOTS.items() if name in s)
        return max((f.t_ns for f in self.frames(interface) if currents(f)[slot]), default=0)

    def check(self, *, other_bus: str | None = REAR) -> None:
        """The invariants of the campaign, over the whole log of the run."""
        self.speeds.clear()
        for interface, names in SLOTS.items():
            for frame in self.frames(interface):
                for name, value in zip(names, currents(frame), strict=True):
                    if name is None:
                        assert value == 0, f"an unused slot: {frame}"
                        continue
                    assert abs(value) <= LIMIT_RAW[name], f"{name} beyond its limit: {frame}"
                    if not value or self._may_be_driven(name, frame.t_ns):
                        continue
                    assert name in BRAKES, f"{name} without a lease: {frame}"
                    self._check_brake(name, value, frame)
        if other_bus is not None:
            times = [f.t_ns for f in self.frames(other_bus)]
            # As in tests/kernel/test_grid.py, once for each of two ticks.
            late = [b - a for a, b in itertools.pairwise(times) if abs(b - a - MS) > 8000]
            assert times, f"{other_bus} had no ticks"
            assert not late, f"{other_bus} missed ticks: {late[:5]}"

    def _check_brake(self, name: str, value: int, frame: Frame) -> None:
        """A fallback has something to brake once it was driven, and opposes a fast shaft."""
        ended_ns = [end for _, end in self.allowed.get(name, ()) if end < frame.t_ns]
        assert ended_ns, f"{name} before it was ever driven: {frame}"
        fast = self._fast_since(name, frame.t_ns)
        if fast is None:
            return
        since_ns, rpm = fast
        late = frame.t_ns - max(since_ns, *ended_ns) > OPPOSES_WITHIN_NS
        assert not late or value * rpm < 0, f"{name} is driven on at {rpm} rpm: {frame}"

    def _fast_since(self, name: str, t_ns: int) -> tuple[int, int] | None:
        """Since when its shaft turned fast one way without a break, as of then; and its speed."""
        if name not in self.speeds:
            self.speeds[name] = self._read_speeds(name)
        times, states = self.speeds[name]
        index = bisect.bisect_right(times, t_ns) - 1
        return states[index] if index >= 0 else None

    def _read_speeds(self, name: str) -> tuple[list[int], list[tuple[int, int] | None]]:
        times: list[int] = []
        states: list[tuple[int, int] | None] = []
        for frame in self.dump.frames():
            if frame.id != BRAKES[name] or frame.iface != FRONT or frame.error or frame.rtr:
                continue
            if len(frame.data) < 8:
                continue
            rpm = struct.unpack_from(">h", frame.data, 2)[0]
            last = states[-1] if states else None
            goes_on = last is not None and last[1] * rpm > 0
            since_ns = last[0] if last is not None and goes_on else frame.t_ns
            times.append(frame.t_ns)
            states.append((since_ns, rpm) if abs(rpm) > FAST_RPM else None)
        return times, states

    def _may_be_driven(self, name: str, t_ns: int) -> bool:
        return any(start <= t_ns <= end for start, end in self.allowed.get(name, ()))


@contextlib.contextmanager
def witness() -> Iterator[Witness]:
    with Candump(FRONT, REAR) as dump:
        yield Witness(dump)


@contextlib.contextmanager
def robot_under_test() -> Iterator[tuple[Proc, rc10.Robot, Witness]]:
    """Drives, witness, daemon, and a client that has enabled every motor."""
    with drives(), witness() as log, daemon() as process, client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        yield process, robot, log


@contextlib.contextmanager
def robot_with(
    tmp_path: Path, changes: dict[str, str] | None = None, more: str = ""
) -> Iterator[tuple[Proc, rc10.Robot, Witness]]:
    """The robot of the campaign with other text in its file, not yet enabled."""
    text = CONFIG.read_text()
    for old, new in (changes or {}).items():
        assert old in text
        text = text.replace(old, new)
    path = tmp_path / "robot.yaml"
    path.write_text(text + more)
    with drives(), witness() as log, daemon(path) as process, client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        yield process, robot, log


def drive(robot: rc10.Robot, log: Witness, seconds: float, **targets: rc10.Setpoint) -> int:
    """Commands at 100 Hz; returns when the last command was sent, in ns of the wall clock."""
    start_ns = time.time_ns()
    for t_s in robot.rate(1000 / COMMAND_PERIOD_MS):
        if t_s >= seconds:
            break
        robot.command(targets, validity_ms=VALIDITY_MS)
        last_ns = time.time_ns()
    log.driven(start_ns, last_ns, *targets)
    return last_ns


def proven(
    fault_words: str, reaction: str, since_ns: int | None, until_ns: int | None, within: int
) -> None:
    """One line of the table: the reaction took this many ticks, and no more were allowed.

    None for both times: the reaction is that nothing happens.
    """
    ticks = (
        None
        if since_ns is None or until_ns is None
        else max(0, -(-(until_ns - since_ns) // TICK_NS))
    )
    line = {"fault": fault_words, "reaction": reaction, "ticks": ticks, "within": within}
    with Path(os.environ["RC10_SCRATCH"], "records.jsonl").open("a") as out:
        out.write(json.dumps(line) + "\n")
    assert ticks is None or ticks <= within, line


def nothing(words: str, reaction: str) -> None:
    """A line of the table without a time."""
    proven(words, reaction, None, None, 0)


class Stranger:
    """Sends what no well-behaved client would, straight to LCM's group."""

    def __init__(self, client_name: str = "stranger") -> None:
        self._lcm = lcm.LCM("udpm://239.255.76.67:7667?ttl=0")
        self.name = client_name
        self.session = 77
        self.seq = 0

    def command(
        self,
        motor: str,
        mode: int,
        value: float,
        *,
        validity_ms: int = VALIDITY_MS,
        seq: int | None = None,
        priority: int = 0,
    ) -> None:
        message = command_t()
        message.client, message.session, message.priority = self.name, self.session, priority
        self.seq += 1
        message.seq = self.seq if seq is None else seq
        message.validity_ms = validity_ms
        setpoint = setpoint_t()
        setpoint.motor, setpoint.mode, setpoint.value = motor, mode, value
        message.setpoint_count, message.setpoints = 1, [setpoint]
        data = message.encode()
        self._lcm.publish("faults.v1.command", data)

    def bytes(self, data: bytes, channel: str = "faults.v1.command") -> None:
        self._lcm.publish(channel, data)


def datagram(data: bytes) -> None:
    """Sends one UDP datagram to LCM's group, as it is."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as udp:
        udp.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 0)
        udp.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, socket.inet_aton("127.0.0.1"))
        udp.sendto(data, ("239.255.76.67", 7667))
