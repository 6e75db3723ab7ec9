"""Every family of drives over real SocketCAN: enabled, driven and let go, byte by byte."""
# run-guest: --timeout 900

from __future__ import annotations

import re
import signal
import time
from collections import Counter
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest
from family_rig import (
    ROBOT,
    bus_stats,
    rc10ctl,
    reading_after,
    running,
    setting,
    text_of,
    wait_status,
    wire_seconds,
    write_config,
)
from guestlib import Candump, netem, netem_clear, wait_for
from rig import MS, client, drive

import rc10

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from guestlib import Frame


FD_BUS = "bitrate: 1000000\ndata_bitrate: 5000000"


class Target(NamedTuple):
    mode: str
    value: float
    frame: str  # that tells the drive so
    near: float  # tolerance of the reading
    seconds: float = 1.0
    reading: float | None = None  # if it is not the value


@dataclass(frozen=True)
class Family:
    """A drive, and the frames that the manuals make of what it is told.

    Frames are regular expressions of text_of(). They were computed by hand from the vendors'
    formulas, not taken from what rc10d sends.
    """

    name: str
    fake: str
    keys: str
    commands: str  # every frame that is more than a question
    enabling: tuple[str, ...]  # in this order, questions and answers too
    targets: tuple[Target, ...]  # angles first, while the shaft is in its first turn
    rest: tuple[str, ...]  # the frames that are sent in every tick of rest, in this order
    before_rest: tuple[str, ...] = ()  # sent beside them in the first, and at the end
    bus: str = ""


FAMILIES = (
    Family(
        name="DJI",
        fake="M3508:1",
        keys="model: M3508, id: 1, zero: power_on, soft_start_ms: 0",
        commands="200#.*",
        enabling=("201#.*", "200#0000000000000000"),
        targets=(
            # Loops of the host: the first slot has what they want, the others nobody has.
            Target("angle", 90, "200#(?!0000)....000000000000", near=3),
            Target("velocity", 60, "200#(?!0000)....000000000000", near=3),
            # Counts, of 16384 for 20 A.
            Target("current", 1, "200#0333000000000000", near=0.3, seconds=0.1),
        ),
        rest=("200#0000000000000000",),
    ),
    Family(
        name="VESC",
        fake="VESC:10",
        keys="model: VESC, id: 10, pole_pairs: 7, angle: none, feedback_hz: 100, "
        "command_divider: 10",
        commands="x0000(0[0-4A-D])0A#.*",
        # Its watchdog is asked for until it has tripped.
        enabling=(
            "x0000080A#FD003200200000",
            "x000008FD#0A01320020000001",
            "x0000010A#00000000",
        ),
        targets=(
            Target("velocity", 300, "x0000030A#00000834", near=5),
            Target("current", 1, "x0000010A#000003E8", near=0.3, seconds=0.1),
            # 24 V against a motor of 0.095 V for each rad/s.
            Target("duty", 0.2, "x0000000A#00004E20", near=5, reading=482),
        ),
        rest=("x0000010A#00000000",),
    ),
    Family(
        name="Damiao",
        fake="DM4310:1",
        keys="model: DM4310, id: 1, master_id: 17",
        commands="([0-3]01|7FF#....55)#.*",
        # Ranges are read, mode and watchdog (100 ms in steps of 50 us) are written.
        enabling=(
            "001#FFFFFFFFFFFFFFFD",
            "7FF#0100331500000000",
            "011#0100331500004841",
            "7FF#0100331600000000",
            "7FF#0100331700000000",
            "7FF#0100550A01000000",
            "7FF#01005509D0070000",
            "001#FFFFFFFFFFFFFFFC",
            "011#11.*",
        ),
        targets=(
            Target("angle", 45, "001#880A7FF0A33337FF", near=2),
            Target("velocity", 60, "001#....9AC0003337FF", near=3),
        ),
        rest=("001#FFFFFFFFFFFFFFFD",),
    ),
    Family(
        name="Damiao in velocity control",
        fake="DM4310:2",
        keys="model: DM4310, id: 2, master_id: 18, control: velocity",
        commands="([0-3]02|7FF#....55)#.*",
        enabling=("7FF#0200550A03000000", "202#FFFFFFFFFFFFFFFC", "012#12.*"),
        targets=(Target("velocity", 60, "202#DB0FC940(00000000)?", near=1),),
        rest=("202#FFFFFFFFFFFFFFFD",),
    ),
    Family(
        name="moteus",
        fake="moteus:1",
        keys="model: moteus, id: 1, motor_kv_rpm_per_v: 304, zero: power_on",
        bus=FD_BUS,
        commands="x00008001##0100.*",
        # Stop; map version and home state; position mode without gains; the watchdog.
        enabling=(
            "x00008001##0100001100.*",
            "x00008001##010000.*198202110C.*",
            "x00008001##01000A0F20.{24}02230000.*05276400.*",
            "x00008001##.*1527",
            "100##21000A.*",
        ),
        targets=(
            Target("angle", 90, "x00008001##01000A0F200000803E00000000.*05276400.*", near=1),
            Target("velocity", 60, "x00008001##01000A0F20.{8}0000803F.*05276400.*", near=1),
            Target(
                "current",
                0.5,
                "x00008001##01000A0F20.{8}00000000..DA5E3C.*02230000.*",
                near=0.2,
                seconds=0.1,
            ),
        ),
        rest=("x00008001##010000(1100.*)?",),
    ),
    Family(
        name="ODrive",
        fake="ODrive_S1:3",
        keys="model: ODrive_S1, id: 3, feedback_hz: 1000, telemetry_hz: 10, current_limit_a: 20, "
        "velocity_limit_rpm: 600, torque_constant_nm_per_a: 0.0551, zero: power_on",
        commands="0(62|67|6B|6C|6D|6E|6F|76|78)#.*",
        enabling=(
            "067#01000000",
            "06E#00000000",
            "06B#0100000001000000",
            "06F#000020410000A041",
            "067#08000000",
            "061#0000000008......",
        ),
        targets=(
            Target("angle", 90, "06C#0000803E00000000", near=1),
            Target("velocity", 120, "06D#0000004000000000", near=1),
            Target("current", 1, "06E#8AB0613D", near=0.1, seconds=0.2),
        ),
        rest=("06E#00000000", "067#01000000"),
    ),
    Family(
        name="MyActuator",
        fake="RMD-X8-25:1",
        keys="model: RMD-X8-25, id: 1, velocity_limit_rpm: 60, command_divider: 2, zero: power_on",
        commands="(141#(A[1-8]|8[01]|7[678])|401#).*",
        enabling=(
            "141#9A00000000000000",
            "241#9A.*",
            "141#B100000000000000",
            "241#B1000000.*",
            "141#A100000000000000",
            "241#A1.*",
        ),
        targets=(
            Target("angle", 90, "141#A400680128230000", near=1),
            Target("velocity", 30, "141#A200000050460000", near=1),
            Target("current", 1, "141#A100000064000000", near=0.2, seconds=0.1),
        ),
        rest=("141#8000000000000000",),
    ),
    Family(
        name="LK-Tech",
        fake="LK-MG5010E-i10:5",
        keys="model: LK-MG5010E-i10, id: 5, velocity_limit_rpm: 150, current_limit_a: 4",
        # An answer has the same id, and the temperature in its second byte.
        commands="145#(A[0-8]|8[0189]|9B)00.*|145#A[24]00.*",
        enabling=(
            "145#9A00000000000000",
            "145#9A19.*",
            "145#9200000000000000",
            "145#A100000000000000",
            "145#A119.*",
        ),
        targets=(
            # The rotor's, ten times as much: 0.01 deg, with 9000 deg/s.
            Target("angle", 90, "145#A4002823905F0100", near=1),
            Target("velocity", 60, "145#A200F800407E0500", near=1),
            Target("current", 1, "145#A10000003E000000", near=0.2, seconds=0.1),
        ),
        rest=("145#A100000000000000",),
    ),
    Family(
        name="LK-Tech in the frame of the group",
        fake="LK-MF9025:2",
        keys="model: LK-MF9025, id: 2, group: true, current_limit_a: 8, overspeed_rpm: 450,"
        " soft_start_ms: 0",
        commands="280#.*|142#(A[0-8]|8[0189]|9B)00.*",
        enabling=("142#9A00000000000000", "142#9A19.*", "280#0000000000000000", "142#A119.*"),
        targets=(Target("current", 1, "280#00007C0000000000", near=0.2, seconds=0.1),),
        rest=("280#0000000000000000",),
    ),
    Family(
        name="RobStride",
        fake="RS00:127",
        keys="model: RS00, id: 127",
        commands="x(01....|0[346]00FD|1200FD)7F#.*",
        # Operation mode and a watchdog of 200 ms in steps of 50 us, each read back.
        enabling=(
            "x0400FD7F#0000000000000000",
            "x1200FD7F#0570000000000000",
            "x11007FFD#0570000000000000",
            "x1200FD7F#28700000A00F0000",
            "x11007FFD#28700000A00F0000",
            "x0300FD7F#0000000000000000",
            "x02807FFD#.*",
        ),
        targets=(
            Target("angle", 45, "x017FFF7F#87FE7FFF0E55322C", near=1),
            Target("velocity", 60, "x017FFF7F#....985E00008F5B", near=1),
        ),
        rest=("x0400FD7F#0000000000000000",),
    ),
    Family(
        name="CubeMars in servo mode",
        fake="AK80-9:5",
        keys="model: AK80-9, id: 5, zero: power_on",
        commands="x0000(0[0-8])05#.*",
        enabling=("x00002905#.*", "x00000105#00000000"),
        targets=(
            Target("angle", 90, "x00000405#000DBBA0", near=1),
            Target("velocity", 60, "x00000305#00002C4C", near=1),
            Target("current", 1, "x00000105#000003E8", near=0.2, seconds=0.1),
        ),
        rest=("x00000105#00000000",),
    ),
    Family(
        name="CubeMars in MIT mode",
        fake="AK80-9:5:mit",
        keys="model: AK80-9, id: 5, protocol: mit, zero: power_on",
        commands="005#.*",
        enabling=(
            "005#FFFFFFFFFFFFFFFD",
            "000#05.*",
            "005#FFFFFFFFFFFFFFFC",
            "005#7FFF7FF0000007FF",
            "000#05.*",
        ),
        targets=(
            Target("angle", 90, "005#901[45]7FF0F53337FF", near=1),
            Target("velocity", 60, "005#....9000006667FF", near=3),
        ),
        rest=("005#FFFFFFFFFFFFFFFD",),
        before_rest=("005#7FFF7FF0000007FF",),
    ),
    Family(
        name="CubeMars V3 in MIT mode",
        fake="AK80-8-V3:5:mit_v3",
        keys="model: AK80-8-V3, id: 5, protocol: mit_v3, zero: power_on",
        commands="x0000(0[0-8])05#.*",
        enabling=("x00002905#.*", "x00000805#000000.*", "x00000105#00000000"),
        targets=(
            Target("angle", 90, "x00000805#0F533390157FF7FF", near=2),
            Target("velocity", 60, "x00000805#000666....9567FF", near=5),
        ),
        rest=("x00000805#000000....7FF7FF", "x00000105#00000000"),
    ),
)


# Each has command ids that do not leave while it is driven, or not while it rests.
STALLING = ("VESC:10", "moteus:1", "ODrive_S1:3", "LK-MF9025:2", "RS00:127", "AK80-9:5")


def find_in_order(wanted: Iterable[str], texts: list[str]) -> list[str]:
    """The wanted frames that do not come one after the other, whatever is between them."""
    rest = iter(texts)
    return [pattern for pattern in wanted if not any(re.fullmatch(pattern, text) for text in rest)]


def without_cut_round(family: Family, texts: list[str]) -> list[str]:
    """The recorder may have been stopped amid a round of rest frames: that round left out."""
    begun = [re.fullmatch(pattern, texts[-1]) is not None for pattern in family.rest]
    return texts[: len(texts) - 1 - begun.index(True)] if any(begun[:-1]) else texts


def assert_rest(family: Family, texts: list[str]) -> None:
    """Nothing but rest, and whole rounds of it at the end."""
    assert texts
    for text in texts:
        assert any(re.fullmatch(pattern, text) for pattern in family.rest + family.before_rest), (
            text
        )
    last = texts[-len(family.rest) :]
    assert all(map(re.fullmatch, family.rest, last)), last


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.name)
def test_it_is_enabled_follows_its_targets_and_is_left_at_rest(
    family: Family, tmp_path: Path
) -> None:
    def told(frames: list[Frame]) -> list[str]:
        return [text for text in map(text_of, frames) if re.fullmatch(family.commands, text)]

    config = write_config(tmp_path, f"name: motor, {family.keys}", bus=family.bus)
    with Candump("vcan0") as bus, running(config, family.fake) as daemon:
        rc10ctl("enable")
        wait_status("ACTIVE")
        # The recorder may write down a frame later than rc10d acts on it.
        wait_for(
            lambda: find_in_order(family.enabling, [text_of(f) for f in bus.frames()]) == [],
            5.0,
            f"in order {family.enabling}",
        )

        for target in family.targets:
            seen = len(bus.frames())
            reading = reading_after("motor", target.mode, target.value, target.seconds)
            wanted = target.value if target.reading is None else target.reading
            assert reading == pytest.approx(wanted, abs=target.near), target
            texts = told(bus.frames()[seen:])
            count = sum(re.fullmatch(target.frame, text) is not None for text in texts)
            assert count >= 3, (target, Counter(texts).most_common(5))

        rc10ctl("disable")
        released_ns = time.time_ns()
        bus.wait_frame(lambda frame: frame.t_ns > released_ns + 100 * MS)
        resting = told([frame for frame in bus.frames() if frame.t_ns > released_ns])
        assert_rest(family, without_cut_round(family, resting))

        rc10ctl("enable")
        wait_status("ACTIVE")
        with setting("motor", family.targets[-1].mode, family.targets[-1].value, 10.0):
            driven = family.targets[-1].frame
            since_ns = time.time_ns()
            bus.wait_frame(
                lambda frame: (
                    frame.t_ns > since_ns and re.fullmatch(driven, text_of(frame)) is not None
                )
            )
            assert daemon.stop(signal.SIGTERM) == 0
        bus.stop()
        texts = told(bus.frames())
        assert_rest(family, texts[-3 * len(family.rest) :])


@pytest.mark.parametrize(
    "family",
    [family for family in FAMILIES if family.fake in STALLING],
    ids=lambda family: family.name,
)
def test_a_stalled_bus_is_seen_and_comes_back_with_rest(family: Family, tmp_path: Path) -> None:
    config = write_config(tmp_path, f"name: motor, {family.keys}", bus=family.bus)
    target = family.targets[-1]
    with running(config, family.fake) as daemon:
        rc10ctl("enable")
        wait_status("ACTIVE")
        with setting("motor", target.mode, target.value, 10.0) as hand:
            hand.wait_line("measured")
            netem("vcan0", "loss 100%")
            daemon.wait_line("wire: bus stalled", 5.0)
        with Candump("vcan0") as bus:
            netem_clear("vcan0")
            daemon.wait_line("wire: bus active", 5.0)
            wait_status("READY")
            bus.stop()
        texts = [text_of(frame) for frame in bus.frames()]
        sent = [text for text in texts if re.fullmatch(family.commands, text)]
        assert_rest(family, without_cut_round(family, sent))


def assert_loads_agree(stats: dict[str, Any], load: float) -> None:
    """Bus load by candump, as predicted and as measured, within 5 points."""
    assert load == pytest.approx(stats["predicted_load"], abs=0.05)
    assert stats["measured_load"] == pytest.approx(load, abs=0.05)
    assert stats["measured_load"] == pytest.approx(stats["predicted_load"], abs=0.05)


def test_the_load_of_an_fd_bus_is_as_predicted(tmp_path: Path) -> None:
    motors = [f"name: m{i}, model: moteus, id: {i}, motor_kv_rpm_per_v: 304" for i in (1, 2, 3)]
    config = write_config(tmp_path, *motors, bus=FD_BUS)
    with running(config, "moteus:1", "moteus:2", "moteus:3"), Candump("vcan0") as bus:
        rc10ctl("enable")
        since_ns = time.time_ns()
        # Three seconds of answers: more than the second over which the load is measured.
        enough = bus_stats()["rx_frames"] + 3 * 3000
        wait_for(lambda: bus_stats()["rx_frames"] >= enough, 10.0, "3 s of answers", poll_s=0.1)
        stats = bus_stats()
        until_ns = time.time_ns()
        bus.stop()
    frames = [frame for frame in bus.frames() if since_ns <= frame.t_ns < until_ns]
    assert all(frame.fd for frame in frames)
    assert_loads_agree(stats, wire_seconds(frames) * 1e9 / (until_ns - since_ns))
    assert stats["rx_unmatched"] == stats["rx_malformed"] == stats["rx_foreign"] == 0


def test_five_families_share_a_bus_and_the_load_is_as_predicted(tmp_path: Path) -> None:
    config = write_config(
        tmp_path,
        "name: dji, model: M3508, id: 1",
        "name: vesc, model: VESC, id: 10, pole_pairs: 7, angle: none, feedback_hz: 100, "
        "command_divider: 10",
        "name: damiao, model: DM4310, id: 12, master_id: 28, command_divider: 5",
        "name: robstride, model: RS00, id: 127, command_divider: 5",
        "name: odrive, model: ODrive_S1, id: 3, feedback_hz: 1000, telemetry_hz: 10, "
        "current_limit_a: 20, velocity_limit_rpm: 600, torque_constant_nm_per_a: 0.0551, "
        "command_divider: 4",
    )
    drives = ("M3508:1", "VESC:10", "DM4310:12", "RS00:127", "ODrive_S1:3")
    targets_rpm = {"dji": 100, "vesc": 300, "damiao": 60, "robstride": 60, "odrive": 120}
    targets = {name: rc10.velocity_rpm(rpm) for name, rpm in targets_rpm.items()}
    seconds = 5
    with running(config, *drives), client(robot_name=ROBOT) as robot, Candump("vcan0") as bus:
        robot.enable()
        drive(robot, 1.0, **targets)
        since_ns = time.time_ns()
        state = drive(robot, seconds, **targets)[-1]
        stats = bus_stats()
        until_ns = since_ns + seconds * 1000 * MS
        bus.stop()
    for name, rpm in targets_rpm.items():
        assert state.motors[name].status is rc10.MotorStatus.ACTIVE
        assert state.motors[name].velocity_rpm == pytest.approx(rpm, abs=3), name
    for trouble in ("rx_malformed", "rx_unmatched", "rx_foreign", "rx_dropped", "tx_dropped"):
        assert stats[trouble] == 0, trouble
    frames = [frame for frame in bus.frames() if since_ns <= frame.t_ns < until_ns]
    assert_loads_agree(stats, wire_seconds(frames) / seconds)


@pytest.mark.parametrize(
    ("vesc_id", "brake_frame", "alias"),
    [(1, "x00000201#00002710", "201#.*"), (0, "x00000200#00002710", "200#.*")],
)
def test_an_extended_id_is_not_the_standard_id_of_the_same_number(
    vesc_id: int, brake_frame: str, alias: str, tmp_path: Path
) -> None:
    # Braking with 10 A, command 2: for VESC 1 the number of an M3508's feedback, for VESC 0 that
    # of its command.
    config = write_config(
        tmp_path,
        "name: dji, model: M3508, id: 1",
        f"name: vesc, model: VESC, id: {vesc_id}, pole_pairs: 7, angle: none, feedback_hz: 100",
    )
    drives = ("M3508:1", f"VESC:{vesc_id}")
    with running(config, *drives), client(robot_name=ROBOT) as robot, Candump("vcan0") as bus:
        robot.enable()
        drive(robot, 1.0, dji=rc10.velocity_rpm(100), vesc=rc10.velocity_rpm(300))
        assert robot.motor("vesc").velocity_rpm == pytest.approx(300, abs=5)
        states = drive(robot, 1.0, dji=rc10.velocity_rpm(100), vesc=rc10.brake())
        stats = bus_stats()
        bus.stop()
    texts = [text_of(frame) for frame in bus.frames()]
    assert texts.count(brake_frame) > 900
    assert sum(re.fullmatch(alias, text) is not None for text in texts) > 1900
    assert states[-1].motors["vesc"].velocity_rpm == pytest.approx(0, abs=1)
    assert states[-1].motors["vesc"].status is rc10.MotorStatus.ACTIVE
    for state in states:
        assert state.motors["dji"].velocity_rpm == pytest.approx(100, abs=2)
    assert stats["rx_unmatched"] == stats["rx_malformed"] == stats["rx_foreign"] == 0
