from __future__ import annotations

import math
from typing import Callable

import can
import pytest

from rc10.fakes import FakeMotor, MotorSpec

DT_S = 0.001
RAW_PER_A = {"M3508": 819.2, "M2006": 1000.0, "GM6020": 16384 / 3}
CURRENT_MOTORS = ("M3508:1", "M2006:1", "GM6020:1")


def motor(text: str, **options: float) -> FakeMotor:
    return FakeMotor(MotorSpec.parse(text), **options)


def command_raw(fake: FakeMotor, raw: int) -> None:
    data = bytearray(8)
    slot = fake.address.slot
    data[2 * slot : 2 * slot + 2] = raw.to_bytes(2, "big", signed=True)
    message = can.Message(arbitration_id=fake.address.command_id, is_extended_id=False, data=data)
    assert fake.decode_command(message)


def command_a(fake: FakeMotor, ampere: float) -> None:
    command_raw(fake, round(ampere * RAW_PER_A[fake.spec.model.name]))


def run(fake: FakeMotor, seconds: float, each: Callable[[], object] = lambda: None) -> None:
    for _ in range(round(seconds / DT_S)):
        fake.step(DT_S)
        each()


@pytest.mark.parametrize("text", CURRENT_MOTORS)
@pytest.mark.parametrize("sign", [1, -1])
def test_a_constant_current_accelerates_as_newton_says(text: str, sign: int) -> None:
    fake = motor(text)
    model = fake.spec.model
    command_a(fake, sign * 1.0)
    run(fake, 0.01)
    expected = (model.kt_nm_per_a - model.coulomb_nm) / model.inertia_kg_m2 * 0.01
    assert fake.speed_rad_s * sign == pytest.approx(expected, rel=0.02)
    assert fake.current_a == pytest.approx(sign, rel=1e-3)


@pytest.mark.parametrize("text", CURRENT_MOTORS)
def test_friction_stops_it_and_it_stays(text: str) -> None:
    fake = motor(text)
    command_a(fake, 1.0)
    run(fake, 0.2)
    assert fake.velocity_rpm > 40
    command_a(fake, 0.0)
    run(fake, 60.0)
    assert fake.speed_rad_s == 0.0
    angle_deg = fake.angle_deg
    run(fake, 1.0)
    assert fake.angle_deg == angle_deg


@pytest.mark.parametrize("text", CURRENT_MOTORS)
def test_less_torque_than_friction_does_not_move_it(text: str) -> None:
    fake = motor(text)
    command_a(fake, 0.9 * fake.spec.model.coulomb_nm / fake.spec.model.kt_nm_per_a)
    run(fake, 1.0)
    assert fake.angle_deg == 0.0


@pytest.mark.parametrize("text", CURRENT_MOTORS)
@pytest.mark.parametrize("sign", [1, -1])
def test_the_supply_limits_the_speed(text: str, sign: int) -> None:
    fake = motor(text)
    command_raw(fake, sign * 32767)
    run(fake, 5.0)
    no_load_rpm = fake.spec.model.no_load_rpm
    assert 0.9 * no_load_rpm < fake.velocity_rpm * sign <= no_load_rpm


def test_the_rated_point_is_reached() -> None:
    # M3508: 3 N·m at 10 A and 469 rpm.
    fake = motor("M3508:1", load_nm=3.0)
    command_a(fake, 20.0)
    run(fake, 3.0)
    assert fake.velocity_rpm == pytest.approx(469.0, rel=0.02)
    assert fake.current_a == pytest.approx(10.0, rel=0.1)


def test_a_load_turns_it_backwards_and_a_current_holds_it() -> None:
    fake = motor("M3508:1", load_nm=0.6)
    run(fake, 0.1)
    assert fake.speed_rad_s < 0
    fake = motor("M3508:1", load_nm=0.6)
    command_a(fake, 2.0)
    run(fake, 1.0)
    assert fake.angle_deg == 0.0


def test_a_gm6020_on_a_voltage_runs_in_proportion_to_it() -> None:
    fake = motor("GM6020:1:voltage")
    command_raw(fake, 12500)
    run(fake, 3.0)
    # 13.33 rpm/V, less what friction takes.
    assert fake.velocity_rpm == pytest.approx(12.0 * 13.33, rel=0.05)
    command_raw(fake, 0)
    run(fake, 0.2)
    assert abs(fake.velocity_rpm) < 1.0, "short-circuited, it brakes"


def test_a_stalled_gm6020_on_a_voltage_draws_what_the_winding_lets_through() -> None:
    fake = motor("GM6020:1:voltage", load_nm=0.741 * 2.0)
    command_raw(fake, round(2.0 * 1.8 / 24.0 * 25000))
    run(fake, 1.0)
    assert fake.current_a == pytest.approx(2.0, rel=0.01)
    assert fake.feedback().data[4:6] == pytest.approx(
        round(2.0 / 3.0 * 16384).to_bytes(2, "big"), abs=20
    )


@pytest.mark.parametrize("text", CURRENT_MOTORS)
@pytest.mark.parametrize("sign", [1, -1])
def test_the_encoder_wraps_and_agrees_with_the_speed(text: str, sign: int) -> None:
    fake = motor(text)
    command_a(fake, sign * 1.0)
    counts: list[int] = []

    def look() -> None:
        data = fake.feedback().data
        counts.append(int.from_bytes(data[:2], "big"))

    look()
    run(fake, 0.5, look)
    assert all(0 <= count <= 8191 for count in counts)
    steps = [(b - a + 4096) % 8192 - 4096 for a, b in zip(counts, counts[1:])]
    assert sum(abs(b - a) > 4096 for a, b in zip(counts, counts[1:])) >= 1, "it wrapped"
    assert sum(steps) == pytest.approx(fake.rotor_turns * 8192, abs=1)
    rpm = int.from_bytes(fake.feedback().data[2:4], "big", signed=True)
    assert steps[-1] == pytest.approx(rpm / 60.0 * DT_S * 8192, abs=1.5)


def test_it_warms_up_and_an_m2006_does_not_tell() -> None:
    for text, tells in (("M3508:1", True), ("M2006:1", False), ("GM6020:1", True)):
        # A load that the current just holds: at full speed hardly any would flow.
        fake = motor(text, load_nm=2.0 * MotorSpec.parse(text).model.kt_nm_per_a)
        cold = fake.feedback().data[6]
        command_a(fake, 2.0)
        run(fake, 30.0)
        assert fake.temperature_c > 25.2
        warm = fake.feedback().data[6]
        assert (cold, warm) == ((25, round(fake.temperature_c)) if tells else (0, 0))


def test_without_commands_it_holds_the_last_current() -> None:
    fake = motor("M3508:1", load_nm=0.5)
    command_a(fake, 2.0)
    run(fake, 10.0)
    assert fake.current_a == pytest.approx(2.0, rel=1e-3)
    assert fake.velocity_rpm > 100


def test_with_a_watchdog_it_lets_go() -> None:
    fake = motor("M3508:1", command_timeout_s=0.1)
    command_a(fake, 2.0)
    run(fake, 0.099)
    assert fake.current_a == pytest.approx(2.0, rel=1e-3)
    run(fake, 0.002)
    assert fake.current_a == 0.0
    command_a(fake, 2.0)
    run(fake, 0.01)
    assert fake.current_a == pytest.approx(2.0, rel=1e-3)


@pytest.mark.parametrize("text", [*CURRENT_MOTORS, "GM6020:1:voltage"])
def test_a_long_step_is_as_good_as_short_ones(text: str) -> None:
    slow, quick = motor(text), motor(text)
    for fake in (slow, quick):
        command_raw(fake, 10000)
    slow.step(0.5)
    run(quick, 0.5)
    assert slow.speed_rad_s == pytest.approx(quick.speed_rad_s)
    assert slow.rotor_turns == pytest.approx(quick.rotor_turns)


@pytest.mark.parametrize("dt_s", [0.0, -0.001, math.nan])
def test_time_passes_forwards_only(dt_s: float) -> None:
    with pytest.raises(ValueError, match="dt_s"):
        motor("M3508:1").step(dt_s)


def test_a_simple_loop_reaches_its_target() -> None:
    # A host's speed loop with nothing but what is in the frames.
    fake = motor("M3508:1", load_nm=0.3)
    integral_a = 0.0
    for _ in range(3000):
        rotor_rpm = int.from_bytes(fake.feedback().data[2:4], "big", signed=True)
        error_rpm = 120.0 - rotor_rpm / (3591 / 187)
        integral_a += 0.5 * error_rpm * DT_S
        command_a(fake, max(-10.0, min(10.0, 0.05 * error_rpm + integral_a)))
        fake.step(DT_S)
    assert fake.velocity_rpm == pytest.approx(120.0, abs=0.5)


def test_it_stands_still_at_its_stops_and_leaves_them_the_other_way() -> None:
    fake = motor("M2006:1", initial_angle_deg=10.0)
    fake.stops_deg = (0.0, 20.0)
    command_a(fake, 2.0)
    run(fake, 0.5)
    assert fake.angle_deg == pytest.approx(20.0)
    assert fake.speed_rad_s == 0.0
    command_a(fake, -2.0)
    run(fake, 0.02)
    assert 0.0 < fake.angle_deg < 20.0
    run(fake, 0.5)
    assert fake.angle_deg == pytest.approx(0.0)
