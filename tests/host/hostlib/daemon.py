"""rc10d under test, and what it tells about itself."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from hostlib.program import PATIENCE_S, Program, eventually, processes_of

if TYPE_CHECKING:
    from collections.abc import Sequence

REPO = Path(__file__).parents[3]
BUILD = Path(os.environ.get("RC10_BUILD", REPO / "build" / "dev"))
BIN = BUILD / "bin"

Motor = dict[str, Any]
State = dict[str, Any]

# As the default robot of the tests, with what a test changes. A busy machine stops both cores
# for tens of milliseconds: no drive may seem lost by that.
CONFIG = """
robot: host
realtime: {realtime}
profiles:
  m3508: {{model: M3508, feedback_timeout_ms: 1000, zero: power_on}}
  gm6020: {{model: GM6020, feedback_timeout_ms: 1000}}
lcm: {{url: "udpm://239.255.76.67:7667?ttl=0", state_hz: 100}}
buses:
  - name: chassis
    type: sim
    motors:
      - {{name: wheel, profile: m3508, id: 1}}
      - {{name: other, profile: m3508, id: 2}}
  - name: gimbal
    type: sim
    motors:
      - {{name: yaw, profile: gm6020, id: 5}}
"""

# A robot of one simulated bus: its motors follow.
ARM = """
robot: host
realtime: preferred
lcm: {url: "udpm://239.255.76.67:7667?ttl=0"}
buses:
  - name: arm
    type: sim
    motors:
"""


def check_environment() -> str | None:
    """Reason why the tests cannot run, None when they can."""
    missing = [name for name in ("rc10d", "rc10-lcm", "rc10ctl") if not (BIN / name).exists()]
    if missing:
        return f"not in {BIN}: {', '.join(missing)}"
    route = subprocess.run(
        ["ip", "route", "get", "239.255.76.67"], capture_output=True, text=True, check=False
    )
    if "dev lo" not in route.stdout:
        return "LCM's multicast would leave this machine: use tests/host/run"
    return None


class Daemon:
    """One rc10d with a run folder of its own. Leaving the `with` statement ends it."""

    def __init__(
        self,
        config: str | None = None,
        realtime: str = "preferred",
        prefix: Sequence[str] = (),
        run_dir: Path | None = None,
        state_dir: str = "state",
    ) -> None:
        self._owned = run_dir is None
        # Short: the path of a socket has 108 bytes at most. In memory, as /run is.
        self.run_dir = run_dir or Path(tempfile.mkdtemp(prefix="rc10-host-", dir="/dev/shm"))
        self.state_dir = self.run_dir / state_dir
        self.state_dir.mkdir(exist_ok=True)
        self.env = {"RC10_RUN_DIR": str(self.run_dir), "RC10_STATE_DIR": str(self.state_dir)}
        self.config = self.run_dir / "robot.yaml"
        self.config.write_text(config or CONFIG.format(realtime=realtime))
        self._prefix = prefix
        self.start()

    def __enter__(self) -> Daemon:
        return self

    def __exit__(self, *_: object) -> None:
        self.program.stop()
        if self._owned:
            shutil.rmtree(self.run_dir)

    def start(self) -> None:
        """Starts it, without waiting."""
        self.program = Program(BIN / "rc10d", "-c", self.config, env=self.env, prefix=self._prefix)

    @property
    def pid(self) -> int:
        return self.program.pid

    def kill(self) -> None:
        """Ends it in the worst way."""
        self.program.signal(signal.SIGKILL)
        self.program.wait()

    # ---- through the link socket

    def ctl(self, *words: str | float | Path) -> subprocess.CompletedProcess[str]:
        """Runs rc10ctl and returns what it did; it may have failed."""
        return subprocess.run(
            [str(BIN / "rc10ctl"), *(str(word) for word in words)],
            env={**os.environ, **self.env},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=60,
            check=False,
        )

    def must(self, *words: str | float | Path) -> str:
        """Runs rc10ctl, which must succeed, and returns its output."""
        done = self.ctl(*words)
        assert done.returncode == 0, f"rc10ctl {words}: {done.stdout}{done.stderr}"
        return done.stdout

    def drive(self, *words: str | float) -> Program:
        """Starts an rc10ctl that runs on."""
        return Program(BIN / "rc10ctl", *(str(word) for word in words), env=self.env)

    def wait_up(self) -> None:
        """Waits until it serves its socket."""
        eventually(
            lambda: not self.program.running or self.ctl("list").returncode == 0, "rc10ctl list"
        )
        assert self.program.running, self.program.output

    def wait_ready(self) -> State:
        """Waits until it serves its socket and hears every drive."""
        self.wait_up()
        return self.wait_motors(lambda motor: motor["status"] == "READY")

    def state(self) -> State:
        """The present state."""
        return json.loads(self.must("watch", "--json", "--count", "1"))  # type: ignore[no-any-return]

    def stats(self) -> dict[str, Any]:
        """The newest diagnostics."""
        return json.loads(self.must("stats", "--json"))  # type: ignore[no-any-return]

    def wait_state(
        self, wanted: Callable[[State], bool], what: str, patience_s: float = PATIENCE_S
    ) -> State:
        """Reads the stream of states until one is as wanted."""
        deadline = time.monotonic() + patience_s
        with self.drive("watch", "--json", "--hz", "100") as watch:
            while True:
                state: State = json.loads(watch.wait_line(r"^\{.*\}$", patience_s)[0])
                if wanted(state):
                    return state
                assert time.monotonic() < deadline, (
                    f"not within {patience_s:g} s: {what}\nlast: {state}\n{self.program.output}"
                )

    def wait_motors(self, wanted: Callable[[Motor], bool], what: str = "every motor") -> State:
        """Waits until every motor is as wanted."""
        return self.wait_state(lambda state: all(wanted(motor) for motor in state["motors"]), what)

    def wait_motor(
        self,
        name: str,
        wanted: Callable[[Motor], bool],
        what: str,
        patience_s: float = PATIENCE_S,
    ) -> Motor:
        """Waits until one motor is as wanted."""
        state = self.wait_state(lambda s: wanted(motor_of(s, name)), f"{name}: {what}", patience_s)
        return motor_of(state, name)

    # ---- from outside

    def threads(self) -> dict[str, int]:
        """Thread ids by name."""
        return {
            task.joinpath("comm").read_text().strip(): int(task.name)
            for task in Path(f"/proc/{self.pid}/task").iterdir()
        }

    def gateway_pid(self) -> int:
        """The process id of its rc10-lcm, 0 without one."""
        found = subprocess.run(
            ["pgrep", "--parent", str(self.pid), "-x", "rc10-lcm"],
            capture_output=True,
            text=True,
            check=False,
        )
        return int(found.stdout or 0)

    def processes(self) -> dict[int, list[str]]:
        """Every process on this machine that was started for this run folder."""
        return processes_of(self.run_dir)


def motor_of(state: State, name: str) -> Motor:
    return next(motor for motor in state["motors"] if motor["name"] == name)
