"""A FakeDaemon that runs beside the test on real LCM."""

from __future__ import annotations

import threading

from fake_daemon import FakeDaemon
from rc10.link import LcmLink


class ThreadedDaemon:
    """Use it in a `with` statement, which gives the FakeDaemon."""

    def __init__(self, robot: str, state_hz: float = 200.0) -> None:
        self._period_s = 1.0 / state_hz
        # Not in the thread: once this returns, LCM listens.
        self._daemon = FakeDaemon(robot, LcmLink())
        self._ticked = threading.Condition()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def __enter__(self) -> FakeDaemon:
        self._thread.start()
        return self._daemon

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()

    def wait_for_tick(self, tick: int) -> None:
        """Waits until so many states have been published."""
        with self._ticked:
            assert self._ticked.wait_for(lambda: self._daemon.tick >= tick, timeout=30)

    def _run(self) -> None:
        link = self._daemon.link
        due_s = link.now()
        while not self._stop.is_set():
            due_s += self._period_s
            with self._ticked:
                self._daemon.publish_state()
                self._ticked.notify_all()
            while (left_s := due_s - link.now()) > 0:
                link.pump(left_s)
