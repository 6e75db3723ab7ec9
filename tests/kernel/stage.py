"""The world around a robot under test, in this process: fake drives, the floor, serial devices.

A thread of its own lets all of it pass in steps of 1 ms. Tests read the truth from it, and set
what happens: a stop in the way of a shaft, a power cut, a remote that is switched off.
"""

from __future__ import annotations

import os
import threading
import time
from typing import TYPE_CHECKING, Protocol, Self

import can

from rc10.fakes import Drives, FakeMotor, MotorSpec
from rc10.fakes.port import open_port

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rc10.fakes.fake import Fake

STEP_S = 0.001


class Thing(Protocol):
    """Something that time passes for."""

    def step(self, dt_s: float) -> object: ...


class Stage:
    """Runs while `with` is entered.

    Public attributes may be set at any time:
        powered: whether the drives have power. Without it they neither hear nor send nor pull.
        things: what else time passes for, after the drives.

    Args:
        drives: by the name of the interface: the fake motors, or what speaks for them.
    """

    def __init__(self, drives: Mapping[str, Sequence[Fake] | Drives]) -> None:
        self.powered = True
        self.things: list[Thing] = []
        self._drives = {
            iface: motors if isinstance(motors, Drives) else Drives(motors)
            for iface, motors in drives.items()
        }
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="stage")
        self._failure: BaseException | None = None

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stopped.set()
        self._thread.join()
        if self._failure is not None:
            raise self._failure

    def _run(self) -> None:
        try:
            self._pass_time()
        except BaseException as failure:  # noqa: BLE001  raised again where the test is
            self._failure = failure

    def _pass_time(self) -> None:
        # A whole step is one event: else rc10d's receiver would run between any two frames.
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(80))
        buses = [can.Bus(interface="socketcan", channel=iface) for iface in self._drives]
        try:
            for bus, drives in zip(buses, self._drives.values(), strict=True):
                bus.set_filters(drives.filters)
            ends = list(zip(map(open_port, buses), self._drives.values(), strict=True))
            # In the middle between two ticks of rc10d, which are on whole milliseconds: it is known
            # which tick is the next.
            step_ns = round(STEP_S * 1e9)
            due_ns = time.monotonic_ns() // step_ns * step_ns + step_ns // 2
            while not self._stopped.is_set():
                due_ns += step_ns
                self._stopped.wait(max(0.0, (due_ns - time.monotonic_ns()) * 1e-9))
                for port, drives in ends:
                    while (message := port.receive()) is not None:
                        if self.powered:
                            drives.receive(message)
                    if not self.powered:
                        _cut_power(drives)
                    drives.step(STEP_S)
                for thing in self.things:
                    thing.step(STEP_S)
                if self.powered:
                    for port, drives in ends:
                        for message in drives.feedback():
                            port.send(message)
        finally:
            for bus in buses:
                bus.shutdown()


def _cut_power(drives: Drives) -> None:
    for motor in drives.motors:
        if motor.command != 0.0:
            # A drive's orders are gone with its power.
            rest = can.Message(
                arbitration_id=motor.command_ids[0], is_extended_id=False, data=bytes(8)
            )
            motor.decode_command(rest)


class Recorder:
    """A condition of every step, from now on."""

    def __init__(self, stage: Stage, **values: Callable[[], float]) -> None:
        self._values = values
        self.rows: list[dict[str, float]] = []
        self._stage = stage

    def __enter__(self) -> Self:
        self._stage.things.append(self)
        return self

    def __exit__(self, *_: object) -> None:
        self._stage.things.remove(self)

    def step(self, _dt_s: float) -> None:
        """Takes a row."""
        self.rows.append({name: value() for name, value in self._values.items()})

    def __getitem__(self, name: str) -> list[float]:
        return [row[name] for row in self.rows]


def motor(text: str, **options: float) -> FakeMotor:
    """A DJI motor by its name, M3508:1."""
    return FakeMotor(MotorSpec.parse(text), **options)
