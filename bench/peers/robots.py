"""The robots of the campaign, and what is measured of each in a counted guest."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import guest

PROGRAMS = ("rc10d", "rc10-guard", "rc10ctl")
SECONDS = 3


@dataclass(frozen=True)
class Robot:
    """Drives of one kind on vcan0 or on both interfaces."""

    name: str
    drives: str  # as fake_wire calls them
    buses: int

    def config(self, settings: str) -> str:
        keys = {
            "damiao": "model: DM4310, command_divider: 1, id: {0}, master_id: {1}",
            "dji": "model: M3508, zero: power_on, id: {0}",
        }[self.drives]
        lines = ["robot: bench", "realtime: preferred", "lcm: {enabled: false}", settings, "buses:"]
        for bus in range(self.buses):
            lines.append(f"  - {{name: b{bus}, type: socketcan, interface: vcan{bus}, motors: [")
            lines += [f"      {{name: m{bus}_{i}, {keys.format(i, 16 + i)}}}," for i in range(1, 5)]
            lines.append("    ]}")
        return "\n".join(lines) + "\n"


DAMIAO = Robot("4 DM4310", "damiao", 1)
DJI = Robot("2 x 4 M3508", "dji", 2)


@dataclass(frozen=True)
class Cost:
    """Thousands of instructions per millisecond, whole computer less the drives; and of threads."""

    busy_k: float
    threads_k: dict[str, float]
    lateness_us: dict[str, float]  # of the scheduler; a microsecond is a thousand instructions


# The peer or rc10d runs for a second before it is measured.
SCRIPT = """\
set -e
export RC10_RUN_DIR=/run/rc10
mkdir -p $RC10_RUN_DIR
/bin/fake_wire {drives} 4 {seconds} {hog} >alone
{command} >log 2>&1 & pid=$!
sleep 1
{ready}/bin/fake_wire {drives} 4 {seconds} {hog} $pid >with || {{ cat log; exit 1; }}
{stats}
[ ! -e refused ] || {{ cat enabled log; exit 1; }}
kill $pid || {{ cat log; exit 1; }}
wait $pid || true
cat alone with; if [ -e stats ]; then cat stats; else cat log; fi
"""


# fake_wire lets everything settle for three seconds.
READY = "(sleep 0.5; /bin/rc10ctl enable || touch refused) >enabled 2>&1 &\n"


def measure(
    kernel: guest.Kernel,
    robot: Robot,
    command: str,
    files: dict[str, Path],
    *,
    wire: Path,
    ready: str = "",
    hog_us: int = 0,
) -> Cost:
    rc10d = command.startswith("/bin/rc10d ")
    script = SCRIPT.format(
        drives=robot.drives,
        seconds=SECONDS,
        hog=f"--hog-us {hog_us}" if hog_us else "",
        command=command,
        ready=ready,
        stats="/bin/rc10ctl --json stats >stats" if rc10d else "",
    )
    lines = guest.run(kernel, script, {"/bin/fake_wire": wire, **files}).splitlines()
    alone, with_it, *rest = [json.loads(line) for line in lines if line.startswith("{")]
    return Cost(with_it["busy_k"] - alone["busy_k"], with_it["threads_k"], lateness_of(rest))


def lateness_of(told: list[dict[str, Any]]) -> dict[str, float]:
    """From what rc10d's statistics or a client of `clients/` say; others say nothing."""
    for figures in told:
        if "wake_latency_us" in figures:
            return dict(figures["wake_latency_us"])
        if "p50_us" in figures:
            return {"p50": figures["p50_us"], "p99": figures["p99_us"]}
    return {}


def measure_rc10d(
    kernel: guest.Kernel, robot: Robot, build: Path, *, settings: str = "", hog_us: int = 0
) -> Cost:
    config = build / "bench-peers.yaml"
    config.write_text(robot.config(settings))
    files = {f"/bin/{name}": build / "bin" / name for name in PROGRAMS}
    # A DM4310 answers more than these do before it is enabled; its frames are as many.
    ready = READY if robot.drives == "dji" else ""
    return measure(
        kernel,
        robot,
        "/bin/rc10d -c /robot.yaml",
        {**files, "/robot.yaml": config},
        wire=build / "bin" / "fake_wire",
        ready=ready,
        hog_us=hog_us,
    )
