"""Drives of every family: commanded by somebody else, taken for another, turned while off."""
# run-guest: --timeout 1200

from __future__ import annotations

import re
import time
from typing import TYPE_CHECKING

import pytest
from family_rig import motors, rc10ctl, setting, text_of, wait_status, write_config
from faultrig import ctl, proven
from faulty_families import Wrong
from guestlib import Candump, Frame, run, wait_for
from rig import MS
from test_families import FAMILIES, FD_BUS, Family
from test_family_faults import SUBJECTS, happens, moving, running

if TYPE_CHECKING:
    import contextlib
    from pathlib import Path

    from guestlib import Proc


# ---- Somebody else

NOT_ITS_SCALE, FOREIGN = 43, 9


def sendable(frame: Frame) -> str:
    """As cansend takes it."""
    number = f"{frame.id:08X}" if frame.ext else f"{frame.id:03X}"
    return f"{number}{'##1' if frame.fd else '#'}{frame.data.hex().upper()}"


@pytest.mark.parametrize(
    "family", [f for f in FAMILIES if f.name in SUBJECTS], ids=lambda family: family.name
)
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


def prove_stopped_for_its_scale(family: Family, bus: Candump, begun_ns: int, what: str) -> None:
    """The motor is in FAULT, and no frame of the next 300 ms moves it."""
    assert motors()[0]["fault"] == NOT_ITS_SCALE
    watched_ns = time.time_ns() + 300 * MS
    wait_for(lambda: bus.frames()[-1].t_ns >= watched_ns, 5.0, "rest for 300 ms", poll_s=0.02)
    told = moving(family, [f for f in bus.frames() if f.t_ns >= begun_ns])
    proven(what, "FAULT 43 in the first motion", begun_ns, max(f.t_ns for f in told), 1000)


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
        prove_stopped_for_its_scale(
            family, bus, begun_ns, f"{name}: speeds and torques on the scale of another model"
        )


def turning(name: str, rpm: int, seconds: float) -> Proc:
    """Motion in a mode whose answers have the speed as a share of a range."""
    if name == "MyActuator":
        more = (f"--velocity-ff={rpm}", "--stiffness=0", "--damping=4")
        return setting("motor", "impedance", 0, seconds, *more)
    return setting("motor", "velocity", rpm, seconds)


# From enabling on; Damiao drives say their scale before.
@pytest.mark.parametrize("name", ["Damiao", "MyActuator"])
def test_a_drive_whose_scale_is_another_after_enabling(name: str, tmp_path: Path) -> None:
    family = next(f for f in FAMILIES if f.name == name)
    config = write_config(tmp_path, f"name: motor, {family.keys}", bus=family.bus)
    with Candump("vcan0") as bus, running(config, family.fake):
        wait_status("READY")
        rc10ctl("enable")
        wait_status("ACTIVE")
        begun_ns = happens(Wrong.RESCALED, 150)
        with turning(name, 60, 30.0):
            wait_for(lambda: motors()[0]["status"] == "FAULT", 5.0, "FAULT", poll_s=0.05)
        prove_stopped_for_its_scale(
            family, bus, begun_ns, f"{name}: speeds on another scale since it was enabled"
        )


@pytest.mark.parametrize("name", ["Damiao", "MyActuator", "RobStride", "CubeMars in MIT mode"])
def test_a_drive_that_reports_its_speed_somewhat_wrong_goes_on(name: str, tmp_path: Path) -> None:
    family = next(f for f in FAMILIES if f.name == name)
    config = write_config(tmp_path, f"name: motor, {family.keys}", bus=family.bus)
    with running(config, family.fake):
        wait_status("READY")
        rc10ctl("enable")
        # There and back: an AK drive knows two turns in each direction.
        for rpm, percent in ((60, 115), (-60, 88)):
            happens(Wrong.RESCALED, percent)
            from_deg = motors()[0]["total_angle_deg"]
            with turning(name, rpm, 1.5) as hand:
                assert hand.wait(20.0) == 0, hand.output()
            moved_deg = abs(motors()[0]["total_angle_deg"] - from_deg)
            assert moved_deg > 180, "several windows of the check"
            assert motors()[0]["status"] == "ACTIVE"
            # Compared anew.
            rc10ctl("disable")
            rc10ctl("enable")
    proven(f"{name}: reported speed 12 % low or 15 % high", "no stop", None, None, 0)


def test_a_drive_that_says_it_has_another_scale_is_not_enabled(tmp_path: Path) -> None:
    family = next(f for f in FAMILIES if f.name == "Damiao")
    config = write_config(tmp_path, f"name: motor, {family.keys}", bus=family.bus)
    with Candump("vcan0") as bus, running(config, "DM4340:1"):
        wait_status("READY")
        assert ctl("--robot", "families", "enable").returncode == 1
        assert motors()[0]["status"] == "FAULT"
        # A command that moves it: enabling has none before the scale is known.
        assert not any(text_of(f).startswith("001#") for f in moving(family, bus.frames()))
    proven("Damiao: drive with the scale of another model", "not enabled", None, None, 0)


# ---- The turn at power-up

ABSOLUTE = {
    "Damiao": ("DM4310:1", "model: DM4310, id: 1, master_id: 17", ""),
    "MyActuator": ("RMD-X8-25:1", "model: RMD-X8-25, id: 1, absolute_encoder: true", ""),
    "LK-Tech": ("LK-MG5010E-i10:5", "model: LK-MG5010E-i10, id: 5", ""),
    "RobStride": ("RS00:127", "model: RS00, id: 127", ""),
    "CubeMars in servo mode": ("AK80-9:5", "model: AK80-9, id: 5, output_encoder: true", ""),
    "CubeMars in MIT mode": (
        "AK80-9:5:mit",
        "model: AK80-9, id: 5, protocol: mit, output_encoder: true",
        "",
    ),
    "moteus": (
        "moteus:1",
        "model: moteus, id: 1, motor_kv_rpm_per_v: 304, absolute: true",
        FD_BUS,
    ),
    "VESC": (
        "VESC:10:encoder",
        (
            "model: VESC, id: 10, pole_pairs: 7, feedback_hz: 100, velocity_limit_rpm: 600, "
            "angle: encoder"
        ),
        "",
    ),
}
PLACES_DEG = (-90, 0, 179, 181, 200, 215, -110)
GAP_DEG = 235  # the middle of what the travel leaves of a turn


@pytest.mark.parametrize("name", ABSOLUTE)
def test_a_power_cycle_at_each_place_of_the_travel_of_a_drive(name: str, tmp_path: Path) -> None:
    fake, keys, bus = ABSOLUTE[name]
    travel = "angle_min_deg: -90, angle_max_deg: 200"
    config = write_config(tmp_path, f"name: motor, {keys}, {travel}", bus=bus)
    with running(config, fake):
        for place in PLACES_DEG:
            # It knows its angle within a turn.
            _power_cycle(place)
            # Some drives have to be asked for it.
            wait_for(lambda: motors()[0]["zeroed"], 1.0, f"on its turn at {place}", 0.1)
            motor = motors()[0]
            assert abs(motor["total_angle_deg"] - place) < 1, (place, motor["total_angle_deg"])
            rc10ctl("enable")
            aim_deg = min(max(place, -89), 199)
            with setting("motor", "total_angle", aim_deg, 0.3) as hand:
                assert hand.wait(10.0) == 0, hand.output()
            moved_deg = motors()[0]["total_angle_deg"] - place
            assert abs(moved_deg) < 30, (place, moved_deg)
            rc10ctl("disable")
        _power_cycle(GAP_DEG)
        time.sleep(0.5)
        assert not motors()[0]["zeroed"]
        refused = ctl("--robot", "families", "enable")
        assert refused.returncode == 1
        assert "its turn is unclear" in refused.stderr
        assert motors()[0]["status"] == "READY"
    proven(
        f"{name}: power cycle at {len(PLACES_DEG)} places of -90 to 200 deg and beyond",
        "on its turn; no way round",
        None,
        None,
        0,
    )
    proven(
        f"{name}: power cycle in the middle of the gap of that travel", "not enabled", None, None, 0
    )


def _power_cycle(place_deg: int) -> None:
    happens(Wrong.PARKED, place_deg)
    wait_for(lambda: motors()[0]["status"] == "OFFLINE", 1.0, "OFFLINE", 0.2)
    wait_status("READY")
