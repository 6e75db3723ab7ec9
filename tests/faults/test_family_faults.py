"""Drives of every family that fall silent, restart, report a fault, or have another id."""
# run-guest: --timeout 1200

from __future__ import annotations

import contextlib
import re
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from family_rig import motors, rc10ctl, setting, text_of, wait_status, write_config
from faultrig import TICK_NS, ctl, proven
from faulty_families import FAULT_ID, Wrong
from guestlib import Candump, Frame, Proc, run, wait_for
from rig import BIN, MS
from test_families import FAMILIES, Family

if TYPE_CHECKING:
    from collections.abc import Iterator

# One of each mechanism: unasked, asked, with an enabled state of its own and without.
SUBJECTS = {
    "VESC": 150,
    "Damiao": 60,
    "RobStride": 60,
    "moteus": 60,
    "ODrive": 60,
    "MyActuator": 60,
    "LK-Tech": 60,
    "CubeMars in servo mode": 60,
}
# In ticks. The faults of VESC, MyActuator and LK-Tech have to be asked for, now and then.
WITHIN_FAULT = 600
WORDS = {
    Wrong.SILENT: "falls silent",
    Wrong.RESTARTED: "restarts in motion",
    Wrong.FAULTED: "reports a fault",
}
HERE = Path(__file__).resolve().parent


@pytest.fixture(params=[f for f in FAMILIES if f.name in SUBJECTS], ids=lambda family: family.name)
def family(request: pytest.FixtureRequest) -> Family:
    subject: Family = request.param
    return subject


@contextlib.contextmanager
def powered(fake: str) -> Iterator[None]:
    """The drive has power."""
    with Proc(sys.executable, HERE / "faulty_families.py", "vcan0", fake) as drive:
        drive.wait_line("^ready", 30.0)
        yield


@contextlib.contextmanager
def running(config: Path, fake: str) -> Iterator[None]:
    with powered(fake), rc10d(config):
        yield


@contextlib.contextmanager
def rc10d(config: Path) -> Iterator[None]:
    with Proc(BIN / "rc10d", "-c", config) as daemon:
        daemon.wait_line("robot '.*' runs", 10.0)
        yield


def happens(wrong: Wrong, argument: int = 0) -> int:
    """Orders it; returns when, in ns of the wall clock."""
    run("cansend", "vcan0", f"{FAULT_ID:03X}#{wrong:02X}{argument.to_bytes(2, signed=True).hex()}")
    return time.time_ns()


def moving(family: Family, frames: list[Frame]) -> list[Frame]:
    """The frames that tell the drive something else than rest."""
    return [
        frame
        for frame in frames
        if re.fullmatch(family.commands, text_of(frame))
        and not any(re.fullmatch(rest, text_of(frame)) for rest in family.rest + family.before_rest)
    ]


@pytest.mark.parametrize(
    ("family", "wrong"),
    [
        pytest.param(family, wrong, id=f"{family.name}-{wrong.name.lower()}")
        for family in FAMILIES
        for wrong in WORDS
        # An AK drive in servo mode: a restart is known by its silence, which is a case of its own.
        if family.name in SUBJECTS
        and not (wrong is Wrong.RESTARTED and family.name.startswith("CubeMars"))
    ],
)
def test_a_drive_that_breaks_in_motion_is_noticed(
    family: Family, wrong: Wrong, tmp_path: Path
) -> None:
    config = write_config(tmp_path, f"name: motor, {family.keys}", bus=family.bus)
    target = next(t for t in family.targets if t.mode == "velocity")
    with Candump("vcan0") as bus, running(config, family.fake):
        wait_status("READY")
        rc10ctl("enable")
        wait_status("ACTIVE")
        with setting("motor", target.mode, target.value, 30.0):
            since_ns = time.time_ns() + 300 * MS
            bus.wait_frame(
                lambda f: f.t_ns > since_ns and re.fullmatch(target.frame, text_of(f)) is not None
            )
            broken_ns = happens(wrong)
            wait_for(
                lambda: motors()[0]["status"] != "ACTIVE", 5.0, "no longer ACTIVE", poll_s=0.05
            )
        time.sleep(0.3)
        happens(Wrong.NOTHING)
        time.sleep(1.0)
        assert motors()[0]["status"] != "ACTIVE", "it has enabled itself"
        told = moving(family, [f for f in bus.frames() if f.t_ns >= broken_ns])
        last_ns = max((f.t_ns for f in told), default=broken_ns)
        within = SUBJECTS[family.name] if wrong is Wrong.SILENT else WITHIN_FAULT
        proven(
            f"{family.name}: drive {WORDS[wrong]}",
            "rest; never ACTIVE by itself; clear and enable bring it back",
            broken_ns,
            last_ns,
            within,
        )

        # Some faults end a moment after the clear that was meant for them.
        def back() -> bool:
            ctl("clear")
            return bool(motors()[0]["status"] == "READY")

        wait_for(back, 10.0, "READY again", poll_s=0.5)
        time.sleep(0.5)
        rc10ctl("enable")
        wait_status("ACTIVE")


def test_a_drive_with_another_id_is_offline(family: Family, tmp_path: Path) -> None:
    config = write_config(tmp_path, f"name: motor, {family.keys}", bus=family.bus)
    other = re.sub(r":(\d+)", lambda found: f":{int(found[1]) % 31 + 1}", family.fake, count=1)
    with Candump("vcan0") as bus, running(config, other):
        time.sleep(1.0)
        done = ctl("--robot", "families", "enable")
        assert done.returncode == 1
        assert "offline" in done.stderr
        time.sleep(0.5)
        assert [motor["status"] for motor in motors()] == ["OFFLINE"]
        assert moving(family, bus.frames()) == []
        assert any(f.id != FAULT_ID for f in bus.frames()), TICK_NS
    proven(f"{family.name}: drive has another id", "OFFLINE; not enabled; rest", None, None, 0)
