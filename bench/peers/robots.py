"""The robots of the campaign, and what is measured of each in a counted guest."""

from __future__ import annotations

import json
import re
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import guest

PROGRAMS = ("rc10d", "rc10-guard", "rc10ctl", "targets")
SECONDS = 3
# Targets a second for each motor, from a program of its own.
RATE_HZ = 100

Json = dict[str, Any]


@dataclass(frozen=True)
class Robot:
    """Drives of one kind on vcan0 or on both interfaces."""

    name: str
    drives: str  # as fake_wire calls them
    buses: int
    each: int  # on a bus
    mode: str  # of its targets

    def config(self, settings: str) -> str:
        keys = {
            "damiao": "model: DM4310, command_divider: 1, id: {0}, master_id: {1}",
            "dji": "model: M3508, zero: power_on, id: {0}",
        }[self.drives]
        lines = ["robot: bench", "realtime: preferred", "lcm: {enabled: false}", settings, "buses:"]
        for bus in range(self.buses):
            lines.append(f"  - {{name: b{bus}, type: socketcan, interface: vcan{bus}, motors: [")
            lines += [
                f"      {{name: m{bus}_{i}, {keys.format(i, 16 + i)}}},"
                for i in range(1, self.each + 1)
            ]
            lines.append("    ]}")
        return "\n".join(lines) + "\n"

    def follows(self, stats: Json, rate_hz: int, seconds: float) -> bool:
        """Every motor got frames with its targets, from a second before the measurement on."""
        got = stats["durations_us"]["command to frames"].get("count", 0)
        return bool(got >= self.buses * self.each * rate_hz * (seconds + 1))

    def ready(self, rate_hz: int) -> str:
        """Enables its motors and commands them, or leaves the file `refused`."""
        motors = " ".join(
            f"m{bus}_{i}" for bus in range(self.buses) for i in range(1, self.each + 1)
        )
        then = f"exec /bin/targets bench {rate_hz} {self.mode} {motors}" if rate_hz else ":"
        # fake_wire lets everything settle for three seconds.
        enable = f"sleep 0.5; if /bin/rc10ctl enable; then {then}; else touch refused; fi"
        return f"({enable}) >enabled 2>&1 &\n"


DAMIAO = Robot("4 DM4310", "damiao", 1, 4, "impedance")
DJI = Robot("2 x 4 M3508", "dji", 2, 4, "velocity")
# Seven frames of feedback and two of commands in each millisecond of a bus, 110 us each.
FULL = Robot("2 x 7 M3508", "dji", 2, 7, "velocity")


@dataclass(frozen=True)
class Cost:
    """Thousands of instructions per millisecond, whole computer less the drives; and of threads."""

    busy_k: float
    threads_k: dict[str, float]
    switches: dict[str, float]  # to these threads, per millisecond
    lateness_us: dict[str, float]  # of the scheduler; a microsecond is a thousand instructions
    stats: Json  # of rc10d


@dataclass(frozen=True)
class Calls:
    """System calls per millisecond of threads, and receive queues that ran over."""

    threads: dict[str, float]
    overflows: int


# The peer or rc10d runs for a second before it is measured.
START = """\
set -e
export RC10_RUN_DIR=/run/rc10
mkdir -p $RC10_RUN_DIR
{command} >log 2>&1 & pid=$!
sleep 1
"""
COUNT = """\
{ready}/bin/fake_wire {drives} {each} {seconds} {hog} $pid >with || {{ cat log; exit 1; }}
{ended}
[ ! -e refused ] || {{ cat enabled log; exit 1; }}
kill $pid || {{ cat log; exit 1; }}
wait $pid || true
/bin/fake_wire {drives} {each} {seconds} {hog} >alone
cat alone with; if [ -e stats ]; then cat stats; else cat log; fi
"""
# The kernel counts, which costs instructions: a run of its own.
TRACE = """\
mount -t tracefs t /sys/kernel/tracing
events=/sys/kernel/tracing/events
counted="raw_syscalls/sys_enter sock/sock_rcvqueue_full"
{ready}/bin/fake_wire {drives} {each} {seconds} >with & wire=$!
sleep 3
for event in $counted; do
    echo hist:keys=common_pid >$events/$event/trigger
done
sleep {traced_s}
for event in $counted; do
    echo "event $event"
    cat $events/$event/hist
done
for process in $pid $(cat /proc/$pid/task/*/children); do
    for task in /proc/$process/task/*; do
        echo "thread ${{task##*/}} $(cat $task/comm)"
    done
done
{ended}
[ ! -e refused ] || {{ cat enabled log; exit 1; }}
kill $wire $pid
"""
TRACED_S = 2
# At the end of either: what rc10d counted.
ASK_RC10D = "/bin/rc10ctl --json stats"


@dataclass(frozen=True)
class Program:
    """Drives a robot in a guest: its command line, its files, and what makes the drives turn."""

    robot: Robot
    command: str
    files: dict[str, Path]
    wire: Path
    ready: str = ""
    config: str = ""  # in the guest /robot.yaml
    rate_hz: int = 0  # of targets for each motor

    @property
    def is_rc10d(self) -> bool:
        return self.command.startswith("/bin/rc10d ")

    def run(self, kernel: guest.Kernel, rest: str, **values: object) -> list[str]:
        script = (START + rest).format(
            command=self.command,
            ready=self.ready,
            drives=self.robot.drives,
            each=self.robot.each,
            seconds=SECONDS,
            **values,
        )
        with tempfile.NamedTemporaryFile("w", suffix=".yaml") as config:
            config.write(self.config)
            config.flush()
            own = {"/bin/fake_wire": self.wire, "/robot.yaml": Path(config.name)}
            return guest.run(kernel, script, {**own, **self.files}).splitlines()

    def check(self, stats: Json, seconds: float) -> None:
        """Each motor of rc10d has followed its targets for so long."""
        if self.is_rc10d and not self.robot.follows(stats, self.rate_hz, seconds):
            raise guest.GuestError(f"{self.robot.name}: some motor does not follow its targets")

    def cost(self, kernel: guest.Kernel, *, hog_us: int = 0) -> Cost:
        lines = self.run(
            kernel,
            COUNT,
            hog=f"--hog-us {hog_us}" if hog_us else "",
            ended=f"{ASK_RC10D} >stats" if self.is_rc10d else "",
        )
        alone, with_it, *rest = [json.loads(line) for line in lines if line.startswith("{")]
        busy_k = with_it["busy_k"] - alone["busy_k"]
        stats = rest[0] if self.is_rc10d else {}
        self.check(stats, SECONDS)
        return Cost(busy_k, with_it["threads_k"], with_it["switches"], lateness_of(rest), stats)

    def calls(self, kernel: guest.Kernel) -> Calls:
        lines = self.run(kernel, TRACE, traced_s=TRACED_S, ended=ASK_RC10D if self.is_rc10d else "")
        counted: dict[str, dict[str, int]] = {}
        threads: dict[str, float] = {}
        event = ""
        for line in lines:
            if line.startswith("event "):
                event = line.split()[1]
                counted[event] = {}
            elif hit := re.search(r"common_pid: *(\d+) } hitcount: *(\d+)", line):
                counted[event][hit[1]] = int(hit[2])
            elif line.startswith("thread "):
                _, thread, name = line.split(maxsplit=2)
                calls = counted["raw_syscalls/sys_enter"].get(thread, 0)
                threads[name] = threads.get(name, 0) + calls / (1000 * TRACED_S)
            elif line.startswith("{"):
                self.check(json.loads(line), TRACED_S)
        return Calls(threads, sum(counted["sock/sock_rcvqueue_full"].values()))


def lateness_of(told: list[Json]) -> dict[str, float]:
    """From what rc10d's statistics or another program say; some say nothing."""
    for figures in told:
        if "wake_latency_us" in figures:
            return dict(figures["wake_latency_us"])
        if "p50_us" in figures:
            return {"p50": figures["p50_us"], "p99": figures["p99_us"]}
    return {}


def rc10d(robot: Robot, build: Path, *, settings: str = "", rate_hz: int = RATE_HZ) -> Program:
    """As built there, its motors commanded so often by a program."""
    files = {f"/bin/{name}": build / "bin" / name for name in PROGRAMS}
    return Program(
        robot,
        "/bin/rc10d -c /robot.yaml",
        files,
        build / "bin" / "fake_wire",
        robot.ready(rate_hz),
        robot.config(settings),
        rate_hz,
    )
