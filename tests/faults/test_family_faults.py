"""Drives of every family: silent, restarted, at fault, mistaken, commanded by somebody else."""
# run-guest: --timeout 900

from __future__ import annotations

import contextlib
import math
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
def powered(fake: str, angle_deg: float = 0.0) -> Iterator[None]:
    """The drive has power. With one encoder turn for all it knows, its shaft is at this angle."""
    with Proc(sys.executable, HERE / "faulty_families.py", "vcan0", fake, str(angle_deg)) as drive:
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


def happens(wrong: Wrong) -> int:
    """Orders it; returns when, in ns of the wall clock."""
    run("cansend", "vcan0", f"{FAULT_ID:03X}#{wrong:02X}")
    return time.time_ns()


def moving(family: Family, frames: list[Frame]) -> list[Frame]:
    """The frames that tell the drive something else than rest."""
    return [
        frame
        for frame in frames
        if re.fullmatch(family.commands, text_of(frame))
        and not any(re.fullmatch(rest, text_of(frame)) for rest in family.rest)
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


# ---- Somebody else

NOT_ITS_SCALE, FOREIGN = 43, 9


def sendable(frame: Frame) -> str:
    """As cansend takes it."""
    number = f"{frame.id:08X}" if frame.ext else f"{frame.id:03X}"
    return f"{number}{'##1' if frame.fd else '#'}{frame.data.hex().upper()}"


def test_somebody_else_commands_a_drive(family: Family, tmp_path: Path) -> None:
    config = write_config(tmp_path, f"name: motor, {family.keys}", bus=family.bus)
    target = next(t for t in family.targets if t.mode == "velocity")
    with Candump("vcan0") as bus, running(config, family.fake):
        wait_status("READY")
        rc10ctl("enable")
        wait_status("ACTIVE")

        def driven(value: float) -> contextlib.AbstractContextManager[Proc]:
            wait_for(lambda: not any(state["owner"] for state in motors()), 2.0, "a free motor")
            return setting("motor", target.mode, value, 30.0)

        # As another controller that follows the same protocol: with commands for another speed.
        with driven(target.value):
            time.sleep(0.5)
            theirs = moving(family, bus.frames())[-1]
        with driven(target.value / 2):
            time.sleep(0.5)
            foreign_ns = time.time_ns()
            for _ in range(3):
                run("cansend", "vcan0", sendable(theirs))
            wait_for(lambda: motors()[0]["status"] == "FAULT", 5.0, "FAULT", poll_s=0.05)
        assert motors()[0]["fault"] == FOREIGN
        time.sleep(0.3)
        seen = [f for f in bus.frames() if f.t_ns >= foreign_ns]
        ours = [f for f in moving(family, seen) if f.data != theirs.data]
        rested = [f for f in seen if any(re.fullmatch(r, text_of(f)) for r in family.rest)]
        assert rested[-1].t_ns > foreign_ns + 250 * MS, "rest goes on being sent"
        proven(
            f"{family.name}: three foreign commands within 100 ms",
            "FAULT 9; rest goes on being sent",
            foreign_ns,
            max((f.t_ns for f in ours), default=foreign_ns),
            25,
        )


# ---- Taken for another


@pytest.mark.parametrize(
    ("name", "fake"), [("RobStride", "RS05:127"), ("CubeMars in MIT mode", "AK80-6:5:mit")]
)
def test_a_drive_with_the_scale_of_another_model(name: str, fake: str, tmp_path: Path) -> None:
    family = next(f for f in FAMILIES if f.name == name)
    config = write_config(tmp_path, f"name: motor, {family.keys}", bus=family.bus)
    with Candump("vcan0") as bus, running(config, fake):
        wait_status("READY")
        rc10ctl("enable")
        wait_status("ACTIVE")
        begun_ns = time.time_ns()
        with setting("motor", "velocity", 60, 30.0):
            wait_for(lambda: motors()[0]["status"] == "FAULT", 5.0, "FAULT", poll_s=0.05)
        assert motors()[0]["fault"] == NOT_ITS_SCALE
        time.sleep(0.3)
        told = moving(family, [f for f in bus.frames() if f.t_ns >= begun_ns])
        proven(
            f"{name}: speeds and torques on the scale of another model",
            "FAULT 43 in the first motion",
            begun_ns,
            max(f.t_ns for f in told),
            1000,
        )


def test_a_drive_that_says_it_has_another_scale_is_not_enabled(tmp_path: Path) -> None:
    family = next(f for f in FAMILIES if f.name == "Damiao")
    config = write_config(tmp_path, f"name: motor, {family.keys}", bus=family.bus)
    with Candump("vcan0") as bus, running(config, "DM4340:1"):
        wait_status("READY")
        assert ctl("--robot", "families", "enable").returncode == 1
        assert motors()[0]["status"] == "FAULT"
        # Of what moves it: enabling has none before the scale is known.
        assert not any(text_of(f).startswith("001#") for f in moving(family, bus.frames()))
    proven("Damiao: drive with the scale of another model", "not enabled", None, None, 0)


# ---- The turn at power-up

ABSOLUTE = {
    "Damiao": ("DM4310:1", "model: DM4310, id: 1, master_id: 17"),
    "MyActuator": ("RMD-X8-25:1", "model: RMD-X8-25, id: 1, absolute_encoder: true"),
    "LK-Tech": ("LK-MG5010E-i10:5", "model: LK-MG5010E-i10, id: 5"),
}
PLACES_DEG = (-90, 0, 179, 181, 200, 215, -110)


@pytest.mark.parametrize("name", ABSOLUTE)
def test_a_power_cycle_at_each_place_of_the_travel_of_a_drive(name: str, tmp_path: Path) -> None:
    fake, keys = ABSOLUTE[name]
    travel = "angle_min_deg: -90, angle_max_deg: 200"
    config = write_config(tmp_path, f"name: motor, {keys}, {travel}")
    with rc10d(config):
        for place in PLACES_DEG:
            # Switched off, and turned by hand meanwhile: it knows its angle within a turn.
            with powered(fake, math.remainder(place, 360)):
                wait_status("READY")
                # Some drives have to be asked for it.
                wait_for(lambda: motors()[0]["zeroed"], 1.0, f"on its turn at {place}", 0.05)
                motor = motors()[0]
                assert abs(motor["total_angle_deg"] - place) < 1, (place, motor["total_angle_deg"])
                rc10ctl("enable")
                wait_status("ACTIVE")
                aim_deg = min(max(place, -89), 199)
                with setting("motor", "total_angle", aim_deg, 0.3) as hand:
                    hand.wait(10.0)
                moved_deg = motors()[0]["total_angle_deg"] - place
                assert abs(moved_deg) < 30, (place, moved_deg)
                rc10ctl("disable")
                wait_status("READY")
            time.sleep(1.0)  # no drive is off and on again sooner
            wait_status("OFFLINE")
    proven(
        f"{name}: power cycle at {len(PLACES_DEG)} places of -90 to 200 deg and beyond",
        "on its turn; no way round",
        None,
        None,
        0,
    )
