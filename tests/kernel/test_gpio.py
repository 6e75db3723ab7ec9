"""The e-stop input and the heartbeat on the kernel's simulated GPIO chips."""

from __future__ import annotations

import contextlib
import itertools
import signal
import subprocess
import time
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from guestlib import Candump, Pin, Proc, wait_for
from rig import BIN, C6XX_COMMAND, CONFIG, MS, client, commands, daemon, drive, fakes, wait_status

import rc10

if TYPE_CHECKING:
    from collections.abc import Iterator

SIM = Path("/sys/kernel/config/gpio-sim")


def config_with(folder: Path, *sections: str) -> Path:
    file = folder / "robot.yaml"
    file.write_text("\n".join([CONFIG.read_text(), *sections, ""]))
    return file


def estop_on(chip: str | Path, bias: str = "external", level: str = "low") -> str:
    return f"estop_gpio: {{chip: {chip}, line: 0, bias: {bias}, closed_level: {level}}}"


def rc10ctl(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [BIN / "rc10ctl", *words], capture_output=True, text=True, timeout=60, check=False
    )


@contextlib.contextmanager
def enabled(config: Path) -> Iterator[tuple[Proc, rc10.Robot]]:
    with fakes(), daemon(config) as process, client() as robot:
        wait_status(robot, rc10.MotorStatus.READY)
        robot.enable()
        yield process, robot


@pytest.mark.parametrize("closed", ["low", "high"])
def test_opening_the_contact_ends_the_torque_within_a_tick(closed: str, tmp_path: Path) -> None:
    with Pin(high=closed == "high") as pin:
        config = config_with(tmp_path, estop_on(pin.chip, level=closed))
        with enabled(config) as (process, robot), Candump("vcan0") as bus:
            drive(robot, 0.5, left=rc10.velocity_rpm(100))
            assert any(commands(bus.frames(), C6XX_COMMAND)[-1].data)
            opened_ns = time.time_ns()
            pin.set(closed == "low")
            process.wait_line(f"{pin.chip}:0: e-stop: the input is open", 5.0)
            process.wait_line("robot: RUN -> ESTOP", 5.0)
            drive(robot, 0.1, left=rc10.velocity_rpm(100))
            bus.stop()
            later = [f for f in commands(bus.frames(), C6XX_COMMAND) if f.t_ns > opened_ns + 3 * MS]
            assert len(later) > 50
            assert not any(any(frame.data) for frame in later)


def test_clear_is_refused_until_the_contact_is_closed_again(tmp_path: Path) -> None:
    with Pin() as pin, enabled(config_with(tmp_path, estop_on(pin.chip))) as (process, robot):
        pin.set(True)
        process.wait_line("RUN -> ESTOP", 5.0)
        refused = rc10ctl("clear")
        assert refused.returncode != 0
        assert "the e-stop input is open: release the button" in refused.stderr
        pin.set(False)
        process.wait_line("closed again: `clear` ends the e-stop", 5.0)
        assert rc10ctl("enable").returncode != 0
        cleared = rc10ctl("clear")
        assert cleared.returncode == 0, cleared.stderr
        robot.enable()
        drive(robot, 0.5, left=rc10.velocity_rpm(100))
        assert abs(robot.motor("left").velocity_rpm - 100) < 5


def test_a_short_opening_is_not_missed(tmp_path: Path) -> None:
    with Pin() as pin, enabled(config_with(tmp_path, estop_on(pin.chip))) as (process, _):
        pin.set(True)
        time.sleep(0.003)  # User-Mode Linux has no interrupts for it: it is read every millisecond
        pin.set(False)
        process.wait_line("e-stop: the input is open", 5.0)
        process.wait_line("RUN -> ESTOP", 5.0)
        assert rc10ctl("clear").returncode == 0


def test_an_input_with_nothing_connected_is_an_estop_from_the_start(tmp_path: Path) -> None:
    # The pull-up that rc10d asks for makes the open wire read high.
    with (
        Pin(high=False) as pin,
        fakes(),
        daemon(config_with(tmp_path, estop_on(pin.chip, bias="internal"))) as process,
    ):
        process.wait_line("RUN -> ESTOP", 5.0)
        assert pin.high()
        with client() as robot:
            wait_status(robot, rc10.MotorStatus.READY)
            with pytest.raises(rc10.RequestFailed, match="ESTOP"):
                robot.enable()


def test_a_chip_that_vanishes_is_an_estop(tmp_path: Path) -> None:
    live = SIM / "rc10" / "live"
    with Pin() as pin:
        with enabled(config_with(tmp_path, estop_on(pin.chip))) as (process, robot):
            drive(robot, 0.2, left=rc10.velocity_rpm(100))
            live.write_text("0")
            process.wait_line("e-stop: the input cannot be read", 5.0)
            process.wait_line("RUN -> ESTOP", 5.0)
            assert "the e-stop input is open" in rc10ctl("clear").stderr
        live.write_text("1")


def test_a_chip_is_found_by_its_label(tmp_path: Path) -> None:
    with Pin() as pin:
        label = (SIM / "rc10" / "dev_name").read_text().strip() + "-node0"
        assert str(pin.chip) != label
        with daemon(config_with(tmp_path, estop_on(label))) as process:
            pin.set(True)
            process.wait_line(f"{label}:0: e-stop: the input is open", 5.0)


def start_refused(config: Path) -> str:
    with Proc(BIN / "rc10d", "-c", config) as process:
        assert process.wait(10.0) == 1
        return process.output()


def test_a_missing_chip_line_or_right_keeps_it_from_starting(tmp_path: Path) -> None:
    assert "`gpiodetect` lists the chips" in start_refused(
        config_with(tmp_path, estop_on("gpiochip9"))
    )
    with Pin() as pin:
        wrong_line = estop_on(pin.chip).replace("line: 0", "line: 5")
        assert "the chip has lines 0 to 0" in start_refused(config_with(tmp_path, wrong_line))
        with (
            daemon(config_with(tmp_path, estop_on(pin.chip))),
            Candump("vcan0") as bus,
        ):
            other = config_with(tmp_path, estop_on(pin.chip))
            other.write_text(
                other.read_text()
                .replace("robot: vcan_mixed", "robot: other")
                .replace("vcan0", "vcan1")
            )
            assert "`gpioinfo` says who" in start_refused(other)
            bus.stop()


def test_the_heartbeat_toggles_while_the_scheduler_ticks(tmp_path: Path) -> None:
    with Pin("beat") as pin:
        section = f"heartbeat_gpio: {{chip: {pin.chip}, line: 0, period_ms: 40}}"
        with daemon(config_with(tmp_path, section)) as process:
            time.sleep(0.1)
            levels = []
            for _ in range(200):
                levels.append(pin.high())
                time.sleep(0.001)
            runs = [len(list(same)) for _, same in itertools.groupby(levels)][1:-1]
            assert len(runs) >= 7
            assert all(18 <= run <= 22 for run in runs)

            process.signal(signal.SIGSTOP)
            time.sleep(0.05)
            frozen = set()
            for _ in range(100):
                frozen.add(pin.high())
                time.sleep(0.001)
            process.signal(signal.SIGCONT)
            assert len(frozen) == 1
            assert process.stop() == 0
        assert not pin.high()


def modules_on(switch: Path, valve: Path | str) -> str:
    return f"""modules:
  - name: switches
    type: gpio
    chip: {switch}
    inputs: [{{name: limit, line: 0, active_low: true, debounce_ms: 5}}]
  - name: valves
    type: gpio
    chip: {valve}
    outputs: [{{name: pump, line: 0}}]"""


def ask(robot: rc10.Robot, seconds: float, pump: float | None = None) -> None:
    """Commands the valve at 100 Hz, or, without a value, lets the time pass."""
    for t_s in robot.rate(100):
        if t_s >= seconds:
            return
        if pump is not None:
            robot.module("valves").send(pump=pump)


def limit(robot: rc10.Robot) -> float:
    robot.spin(0.01)
    with contextlib.suppress(rc10.NotReceived):
        return robot.module("switches").state["limit"]
    return -1


def test_a_switch_is_seen_and_a_valve_obeys_until_nobody_asks(tmp_path: Path) -> None:
    with Pin("switch", high=True) as switch, Pin("valve") as valve:
        with enabled(config_with(tmp_path, modules_on(switch.chip, valve.chip))) as (_, robot):
            wait_for(lambda: limit(robot) == 0, 5.0, "the open switch")
            switch.set(False)
            wait_for(lambda: limit(robot) == 1, 5.0, "the closed switch")

            ask(robot, 0.1, pump=0)  # a program says first that it knows where the valve is
            ask(robot, 0.1, pump=1)
            assert valve.high()
            ask(robot, 0.2)
            assert not valve.high(), "nobody asks any more"
            ask(robot, 0.1, pump=1)
            assert rc10ctl("estop").returncode == 0
            ask(robot, 0.1, pump=1)
            assert not valve.high(), "the e-stop"
            cleared = rc10ctl("clear")
            assert cleared.returncode == 0, cleared.stderr
            ask(robot, 0.2, pump=1)
            assert not valve.high(), "not again by itself"
            ask(robot, 1.2)  # it has let go after a second
            ask(robot, 0.1, pump=1)
            assert valve.high()
            robot.module("valves").send(pump=1, validity_ms=1000)
            ask(robot, 0.1)
            assert valve.high()
        assert not valve.high(), "rc10d has ended"


def test_a_program_that_commands_on_through_a_restart_of_rc10d_opens_no_valve(
    tmp_path: Path,
) -> None:
    with Pin("switch") as switch, Pin("valve") as valve:
        config = config_with(tmp_path, modules_on(switch.chip, valve.chip))
        with daemon(config) as process, client() as robot:
            ask(robot, 0.1, pump=0)
            ask(robot, 0.1, pump=1)
            assert valve.high()
            assert process.stop() == 0
            assert not valve.high()
            with daemon(config) as again:
                ask(robot, 3.0, pump=1)
                assert not valve.high(), "it knows nothing of the restart"
                assert "after a start, an e-stop or a loss" in again.output()
                ask(robot, 0.1, pump=0)
                ask(robot, 0.1, pump=1)
                assert valve.high()


def test_the_e_stop_keeps_its_line_whatever_name_a_module_has_for_the_chip(tmp_path: Path) -> None:
    with Pin() as pin, Pin("switch") as switch:
        label = (SIM / "rc10" / "dev_name").read_text().strip() + "-node0"
        config = config_with(tmp_path, estop_on(pin.chip), modules_on(switch.chip, label))
        with daemon(config) as process:
            process.wait_line(f"pump: {label}:0: .*`gpioinfo` says who", 5.0)
            pin.set(True)
            process.wait_line("e-stop: the input is open", 5.0)


def enabling_on(chip: str | Path) -> str:
    return estop_on(chip).replace("estop_gpio", "enabling_gpio")


@pytest.mark.parametrize("beside_a_button", [False, True])
def test_letting_the_enabling_switch_go_ends_the_torque_at_once(
    beside_a_button: bool, tmp_path: Path
) -> None:
    # Beside a button it is looked at every millisecond, after the wait for the button.
    most = (5 if beside_a_button else 3) * MS
    with Pin("hand") as hand, Pin("button") as button:
        sections = [enabling_on(hand.chip), estop_on(button.chip)][: 1 + beside_a_button]
        config = config_with(tmp_path, *sections)
        with enabled(config) as (process, robot), Candump("vcan0") as bus:
            drive(robot, 0.5, left=rc10.velocity_rpm(100))
            assert any(commands(bus.frames(), C6XX_COMMAND)[-1].data)
            let_go_ns = time.time_ns()
            hand.set(True)
            process.wait_line(f"{hand.chip}:0: e-stop: the enabling switch is released", 5.0)
            process.wait_line("robot: RUN -> ESTOP", 5.0)
            drive(robot, 0.1, left=rc10.velocity_rpm(100))
            bus.stop()
            later = [f for f in commands(bus.frames(), C6XX_COMMAND) if f.t_ns > let_go_ns + most]
            assert len(later) > 50
            assert not any(any(frame.data) for frame in later)


def test_holding_the_enabling_switch_again_starts_nothing(tmp_path: Path) -> None:
    with (
        Pin() as hand,
        enabled(config_with(tmp_path, enabling_on(hand.chip))) as (process, robot),
    ):
        drive(robot, 0.2, left=rc10.velocity_rpm(100))
        hand.set(True)
        process.wait_line("RUN -> ESTOP", 5.0)
        refused = rc10ctl("clear")
        assert refused.returncode != 0
        assert "with an enabling switch hold it in the middle" in refused.stderr
        with Candump("vcan0") as bus:
            hand.set(False)
            drive(robot, 0.3, left=rc10.velocity_rpm(100))
            bus.stop()
            sent = commands(bus.frames(), C6XX_COMMAND)
            assert len(sent) > 200
            assert not any(any(frame.data) for frame in sent)
        assert rc10ctl("enable").returncode != 0, "still an e-stop"
        drive(robot, 5.0, left=rc10.velocity_rpm(100))  # until it has run down
        cleared = rc10ctl("clear")
        assert cleared.returncode == 0, cleared.stderr
        assert robot.motor("left").status == rc10.MotorStatus.READY
        robot.enable()
        drive(robot, 0.5, left=rc10.velocity_rpm(100))
        assert abs(robot.motor("left").velocity_rpm - 100) < 5


def test_a_squeeze_for_an_instant_is_not_missed(tmp_path: Path) -> None:
    with Pin() as hand, enabled(config_with(tmp_path, enabling_on(hand.chip))) as (process, _):
        hand.set(True)
        time.sleep(0.003)
        hand.set(False)
        process.wait_line("the enabling switch is released or squeezed", 5.0)
        process.wait_line("RUN -> ESTOP", 5.0)


def test_an_enabling_switch_that_nobody_holds_or_reads_keeps_the_robot_stopped(
    tmp_path: Path,
) -> None:
    live = SIM / "rc10" / "live"
    with Pin(high=True) as hand:
        with fakes(), daemon(config_with(tmp_path, enabling_on(hand.chip))) as process:
            process.wait_line("RUN -> ESTOP", 5.0)
            with client() as robot:
                wait_status(robot, rc10.MotorStatus.READY)
                with pytest.raises(rc10.RequestFailed, match="ESTOP"):
                    robot.enable()
        hand.set(False)
        with enabled(config_with(tmp_path, enabling_on(hand.chip))) as (process, robot):
            drive(robot, 0.2, left=rc10.velocity_rpm(100))
            live.write_text("0")
            process.wait_line("e-stop: the input cannot be read", 5.0)
            process.wait_line("RUN -> ESTOP", 5.0)
            assert rc10ctl("clear").returncode != 0
        live.write_text("1")


def test_a_missing_chip_of_the_enabling_switch_keeps_it_from_starting(tmp_path: Path) -> None:
    refused = start_refused(config_with(tmp_path, enabling_on("gpiochip9")))
    assert "enabling_gpio: gpiochip9" in refused
    assert "`gpiodetect` lists the chips" in refused


def reduced_on(folder: Path, chip: str | Path) -> Path:
    """The wheels may turn at 30 rpm while the contact is open."""
    config = config_with(folder, estop_on(chip).replace("estop_gpio", "mode_gpio"))
    text = config.read_text()
    assert text.count("model: M3508") == 2
    config.write_text(
        text.replace("model: M3508", "model: M3508, reduced_velocity_rpm: 30, reduced_current_a: 5")
    )
    return config


def test_an_open_mode_input_slows_a_fast_shaft_and_closing_it_makes_no_jump(tmp_path: Path) -> None:
    with Pin("door") as door, enabled(reduced_on(tmp_path, door.chip)) as (process, robot):
        drive(robot, 1.0, left=rc10.velocity_rpm(200))
        assert abs(robot.motor("left").velocity_rpm - 200) < 5
        door.set(True)
        process.wait_line(f"{door.chip}:0: reduced speed and current: the mode input is open", 5.0)
        states = drive(robot, 1.5, left=rc10.velocity_rpm(200))
        assert states[-1].conditions & rc10.Condition.REDUCED
        assert all(state.status is rc10.RobotStatus.RUN for state in states)
        assert abs(robot.motor("left").velocity_rpm - 30) < 5
        assert "REDUCED SPEED" in rc10ctl("watch", "--once").stdout

        door.set(False)
        process.wait_line("the mode input is closed: full speed and current again", 5.0)
        speeds = [
            state.motors["left"].velocity_rpm
            for state in drive(robot, 2.0, left=rc10.velocity_rpm(200))
        ]
        # 450 rpm a second, and the state comes every 5 ms; drive() sees every second one.
        assert max(b - a for a, b in itertools.pairwise(speeds)) < 20
        assert abs(robot.motor("left").velocity_rpm - 200) < 5


def test_a_mode_input_that_cannot_be_read_reduces(tmp_path: Path) -> None:
    live = SIM / "door" / "live"
    with Pin("door") as door:
        with enabled(reduced_on(tmp_path, door.chip)) as (process, robot):
            drive(robot, 1.0, left=rc10.velocity_rpm(200))
            live.write_text("0")
            process.wait_line("reduced speed and current: the mode input cannot be read", 5.0)
            drive(robot, 1.5, left=rc10.velocity_rpm(200))
            assert abs(robot.motor("left").velocity_rpm - 30) < 5
        live.write_text("1")


def test_a_missing_chip_of_the_mode_input_keeps_it_from_starting(tmp_path: Path) -> None:
    refused = start_refused(reduced_on(tmp_path, "gpiochip9"))
    assert "mode_gpio: gpiochip9" in refused
