"""Motors obey who may command them, through rc10ctl and through LCM."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hostlib import Daemon, Motor, Program, eventually
from hostlib.daemon import ARM, motor_of

import rc10

CLIENT = Path(__file__).parent / "hostlib" / "lcm_client.py"


def without_torque(motor: Motor) -> bool:
    rest = {"mode": "coast", "command_value": 0, "owner": ""}
    return rest.items() <= motor.items()


def turning(rpm: float, within_rpm: float = 3.0) -> Callable[[Motor], bool]:
    return lambda motor: abs(float(motor["velocity_rpm"]) - rpm) < within_rpm


def lcm_client(daemon: Daemon, rpm: float) -> Program:
    """A separate process that enables the wheel and keeps it turning through LCM."""
    return Program(sys.executable, CLIENT, str(rpm), env=daemon.env)


def test_nothing_is_active_at_start(daemon: Daemon) -> None:
    state = daemon.state()
    assert state["state"] == "RUN"
    for motor in state["motors"]:
        assert motor["status"] == "READY"
        assert without_torque(motor)


def test_a_motor_that_is_not_enabled_does_not_obey(daemon: Daemon) -> None:
    done = daemon.ctl("set", "wheel", "velocity", 60, "--for", "100ms")
    assert done.returncode == 1
    assert "rc10ctl enable wheel" in done.stderr
    with rc10.connect("host") as robot:
        robot.wait_for_state()
        with pytest.raises(rc10.CommandRefused, match="wheel is READY: enable it first"):
            robot.command(wheel=rc10.velocity_rpm(60))
        # As a program in another language would.
        robot._publish_command({"wheel": rc10.velocity_rpm(60)}, validity_ms=0)
        tick = robot.wait_for_state().tick
        while robot.wait_for_state().tick < tick + 50:
            assert robot.motor("wheel").status is rc10.MotorStatus.READY
            assert robot.motor("wheel").command_value == 0


def test_rc10ctl_drives_and_lets_go(daemon: Daemon) -> None:
    daemon.must("enable", "wheel")
    with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s") as setting:
        wheel = daemon.wait_motor("wheel", turning(60), "turns at 60 rpm")
        assert wheel["status"] == "ACTIVE"
        assert wheel["mode"] == "velocity"
        assert wheel["target"] == 60
        assert wheel["owner"] == "rc10ctl"
        assert daemon.state()["motors"][1]["status"] == "READY"
        setting.signal(signal.SIGINT)
        assert setting.wait() == 0
    daemon.wait_motor("wheel", without_torque, "coasts")
    daemon.must("disable", "wheel")
    daemon.wait_motor("wheel", lambda m: m["status"] == "READY", "is READY again")


def test_the_age_of_commands_is_told_for_each_client(daemon: Daemon) -> None:
    def commands_of(client: str) -> int:
        ages = daemon.stats()["durations_us"].get(f"command of {client}", {"count": 0})
        return int(ages["count"])

    daemon.must("enable", "wheel")
    with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s"):
        eventually(lambda: commands_of("rc10ctl") > 10, "ten commands of rc10ctl")
    with rc10.connect("host", client="teleop") as robot:
        robot.wait_for_state()

        def commanded() -> bool:
            robot.command(wheel=rc10.velocity_rpm(60))
            return commands_of("teleop") > 3

        eventually(commanded, "commands of a Python program")
    shown = daemon.must("stats")
    assert "command of rc10ctl " in shown
    assert "command of teleop " in shown


def test_a_set_that_is_not_obeyed_fails_and_says_who_is_in_the_way(daemon: Daemon) -> None:
    daemon.must("enable", "wheel")
    with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s") as first:
        daemon.wait_motor("wheel", turning(60), "turns at 60 rpm")
        second = daemon.ctl("set", "wheel", "velocity", 30, "--for", "1s")
        # A busy computer held the first one up, until the motor was let go and the second had it.
        while second.returncode == 0 or "no valid command any more" in second.stdout:
            daemon.wait_motor("wheel", turning(60), "turns at 60 rpm again")
            second = daemon.ctl("set", "wheel", "velocity", 30, "--for", "1s")
        assert second.returncode == 1
        assert "motor 'wheel' obeys another rc10ctl" in second.stderr
        over = daemon.ctl("set", "wheel", "velocity", 30, "--for", "300ms", "--priority", 1)
        assert over.returncode == 0, over.stderr
        first.signal(signal.SIGINT)
        # The same, of the first.
        assert first.wait() == 0 or "no valid command any more" in first.output


@contextlib.contextmanager
def held_up(daemon: Daemon) -> Iterator[Program]:
    """An rc10ctl set that turned the wheel, and stands."""
    daemon.must("enable", "wheel")
    with daemon.drive("set", "wheel", "velocity", "60", "--for", "60s") as setting:
        daemon.wait_motor("wheel", turning(60), "turns at 60 rpm")
        setting.signal(signal.SIGSTOP)
        yield setting


def wait_ticks(daemon: Daemon, ticks: int) -> None:
    since = daemon.state()["tick"]
    daemon.wait_state(lambda state: state["tick"] > since + ticks, f"{ticks} ticks")


def test_a_set_that_its_computer_holds_up_goes_on(daemon: Daemon) -> None:
    with held_up(daemon) as setting:
        wait_ticks(daemon, 300)
        assert motor_of(daemon.state(), "wheel")["owner"] == ""
        setting.signal(signal.SIGCONT)
        daemon.wait_motor("wheel", turning(60), "turns again")
        assert setting.running
        setting.signal(signal.SIGINT)
        assert setting.wait() == 0


def test_a_set_that_was_paused_for_long_begins_nothing_anew(daemon: Daemon) -> None:
    with held_up(daemon) as setting:
        wait_ticks(daemon, 2500)
        setting.signal(signal.SIGCONT)
        assert setting.wait() == 1
        assert "held up for more than 2 s" in setting.output
    assert without_torque(motor_of(daemon.state(), "wheel"))


def test_a_set_does_not_go_on_with_a_motor_that_was_stopped_and_enabled_meanwhile(
    daemon: Daemon,
) -> None:
    with held_up(daemon) as setting:
        daemon.must("estop")
        daemon.wait_motor("wheel", turning(0, 1.0), "stands")
        daemon.must("clear")
        daemon.must("enable", "wheel")
        setting.signal(signal.SIGCONT)
        assert setting.wait() == 1
    after = daemon.state()
    assert motor_of(after, "wheel")["status"] == "ACTIVE"
    assert without_torque(motor_of(after, "wheel"))


def test_a_stop_whose_event_waits_behind_unread_states_ends_a_set() -> None:
    wheel = "      - {name: wheel, model: M3508, id: 1, zero: power_on, simulated: {}}\n"
    with Daemon(ARM.replace('ttl=0"', 'ttl=0", state_hz: 1000') + wheel) as robot:
        robot.wait_ready()
        with held_up(robot) as setting:
            # Its socket is full of states then.
            wait_ticks(robot, 500)
            robot.must("disable", "wheel")
            robot.must("enable", "wheel")
            wait_ticks(robot, 100)
            setting.signal(signal.SIGCONT)
            assert setting.wait() == 1
            assert "READY" in setting.output or "held up for more than 2 s" in setting.output
        assert without_torque(motor_of(robot.state(), "wheel"))


def test_one_set_after_another_disturbs_neither(daemon: Daemon) -> None:
    daemon.must("enable", "wheel")
    for rpm in (30, 60, 30):
        daemon.must("set", "wheel", "velocity", rpm, "--for", "250ms")


def test_a_target_that_needs_a_reference_fails_without_one() -> None:
    with Daemon(ARM + "      - {name: loose, model: M3508, id: 4}\n") as robot:
        robot.wait_ready()
        robot.must("enable", "loose")
        done = robot.ctl("set", "loose", "total_angle", 90, "--for", "300ms")
        assert done.returncode == 1
        assert "motor 'loose' did not take the total_angle target" in done.stderr
        assert "the angle has no reference; set it with `zero`" in done.stderr


KNEE = ARM + "      - {name: knee, model: DM4340, id: 6, master_id: 22, command_divider: 2}\n"


def test_gains_beyond_the_drive_are_refused_with_its_range() -> None:
    stiff = ("set", "knee", "impedance", 0, "--stiffness", 501, "--for", "1s")
    with Daemon(KNEE) as robot:
        robot.wait_ready()
        robot.must("enable", "knee")
        done = robot.ctl(*stiff)
        assert done.returncode == 1
        assert (
            "the drive of knee takes --stiffness 0 to 500 (Nm/rad) and --damping 0 to 5 (Nms/rad)"
            in done.stderr
        )
        # Another user may not read the file of the robot: rc10d's own refusal has it too.
        (robot.run_dir / "host.config").unlink()
        done = robot.ctl(*stiff)
        assert done.returncode == 1
        assert "motor 'knee' did not take the impedance target (command of" in done.stderr
        assert "0 to 500 Nm/rad, 0 to 5 Nms/rad)" in done.stderr


LIFT = ARM + "      - {name: lift, model: GM6020, id: 5, on_timeout: hold}\n"


@pytest.fixture
def lift() -> Iterator[Daemon]:
    """A robot whose one motor holds its place when nobody commands it."""
    with Daemon(LIFT) as daemon:
        daemon.wait_ready()
        daemon.must("enable", "lift")
        yield daemon


HELD = {"status": "ACTIVE", "acting": "hold", "stop_cause": "timeout", "owner": ""}


def test_a_load_is_held_when_its_program_has_ended(lift: Daemon) -> None:
    told = lift.must("set", "lift", "velocity", 20, "--for", "200ms")
    assert "lift holds its place (on_timeout)" in told
    lift.wait_motor("lift", lambda motor: HELD.items() <= motor.items(), "is held")
    with rc10.connect("host", client="lift-program") as robot:
        robot.wait_for_state()
        robot.command(lift=rc10.velocity_rpm(20), validity_ms=1000)
        obeyed = robot.wait_for_state()
        while obeyed.motor("lift").acting is not rc10.Acting.TARGET:
            obeyed = robot.wait_for_state()
    held = lift.wait_motor("lift", lambda motor: HELD.items() <= motor.items(), "is held")
    assert held["command_age_us"] == -1


def test_the_end_of_a_target_can_be_chosen(lift: Daemon) -> None:
    order = ("set", "lift", "velocity", 20, "--for", "100ms", "--then")
    assert "lift coasts" in lift.must(*order, "coast")
    lift.wait_motor("lift", lambda motor: motor["acting"] == "nothing", "coasts")
    lift.must(*order, "disable")
    ready = lift.wait_motor("lift", lambda motor: motor["status"] == "READY", "is READY")
    assert ready["stopped_by"] == "rc10ctl"


def test_a_motor_that_obeys_somebody_else_stays_enabled_at_the_end(daemon: Daemon) -> None:
    daemon.must("enable", "wheel")
    with rc10.connect("host", client="tester", priority=5) as robot:
        robot.wait_for_state()
        robot.command(wheel=rc10.velocity_rpm(20), validity_ms=1000)
        daemon.wait_motor("wheel", lambda motor: motor["owner"] == "tester", "is driven")
        with daemon.drive("set", "wheel", "velocity", "5", "--then", "disable") as refused:
            while refused.running:
                robot.command(wheel=rc10.velocity_rpm(20), validity_ms=1000)
                robot.spin(0.05)
            assert refused.wait() == 1
            assert "is held by" in refused.output
        wheel = daemon.wait_motor("wheel", lambda motor: motor["owner"] == "tester", "is driven")
        assert wheel["status"] == "ACTIVE"


def test_the_next_rc10ctl_gets_the_motor_at_once(daemon: Daemon) -> None:
    daemon.must("enable", "wheel")
    for rpm in (30, -30, 60):
        daemon.must("set", "wheel", "velocity", rpm, "--for", "100ms")
    wheel = daemon.wait_motor("wheel", without_torque, "coasts")
    assert wheel["owner"] == ""
    # Not "none": a pause of this machine may let a command expire on its way.
    assert "not owner" not in daemon.must("stats")


@pytest.mark.usefixtures("daemon")
def test_a_python_client_drives_through_lcm() -> None:
    with rc10.connect("host", client="tester") as robot:
        robot.wait_for_state()
        robot.enable("wheel")
        for t_s in robot.rate(100):
            robot.command(wheel=rc10.velocity_rpm(-90))
            wheel = robot.motor("wheel")
            if abs(wheel.velocity_rpm + 90) < 3:
                break
            assert t_s < 20, f"does not follow: {wheel}"
        assert wheel.mode is rc10.Mode.VELOCITY
        assert wheel.target == -90
        assert wheel.owner == "tester"
        robot.disable("wheel")
        eventually(
            lambda: robot.spin(0.1) and robot.motor("wheel").status is rc10.MotorStatus.READY,
            "disabled",
        )
        assert robot.motor("wheel").mode is rc10.Mode.COAST


def test_a_program_enables_a_motor_alone_through_lcm(daemon: Daemon) -> None:
    with rc10.connect("host") as robot:
        robot.wait_for_state()
        assert robot.request("enable_alone", "wheel").message == "enable_alone: 1 of 1 motors"
        refused = daemon.ctl("enable")
        assert refused.returncode == 1
        assert "enable: 1 of 3 motors (other, yaw: locked while wheel is enabled alone" in (
            refused.stderr
        )
        robot.disable("wheel")
        robot.enable()
        with pytest.raises(rc10.RequestFailed, match="`rc10ctl disable other yaw` first"):
            robot.request("enable_alone", "wheel")


def test_a_position_is_reached(daemon: Daemon) -> None:
    # Not a geared motor: a pause of some milliseconds of this machine would lose its reference,
    # as it should. tests/kernel does that one, in virtual time.
    daemon.must("enable", "yaw")
    with daemon.drive("set", "yaw", "angle", "90", "--for", "60s"):
        daemon.wait_motor("yaw", lambda m: abs(m["angle_deg"] - 90) < 2, "stands at 90 deg")


def test_a_client_that_is_killed_lets_go(daemon: Daemon) -> None:
    with lcm_client(daemon, 60) as client:
        daemon.wait_motor("wheel", turning(60), "turns at 60 rpm")
        client.signal(signal.SIGKILL)
        client.wait()
        wheel = daemon.wait_motor("wheel", without_torque, "has no target")
        # The lease has lapsed, the motor is still enabled.
        assert wheel["status"] == "ACTIVE"


def test_a_client_that_stops_sending_lets_go(daemon: Daemon) -> None:
    with lcm_client(daemon, 60) as client:
        daemon.wait_motor("wheel", turning(60), "turns at 60 rpm")
        client.signal(signal.SIGSTOP)
        daemon.wait_motor("wheel", without_torque, "has no target")
        client.signal(signal.SIGCONT)
        daemon.wait_motor("wheel", turning(60), "turns at 60 rpm again")


def test_the_gateway_is_started_again(daemon: Daemon) -> None:
    with lcm_client(daemon, 60):
        daemon.wait_motor("wheel", turning(60), "turns at 60 rpm")
        gateway = eventually(daemon.gateway_pid, "rc10-lcm runs")
        tick = daemon.state()["tick"]
        coasting = "wheel: no valid command any more: coasting"
        before = daemon.program.output.count(coasting)
        os.kill(gateway, signal.SIGKILL)
        # The next rc10-lcm is there before a slow machine shows the state in between.
        eventually(lambda: daemon.program.output.count(coasting) > before, "it coasts")
        eventually(lambda: daemon.gateway_pid() not in (0, gateway), "a new rc10-lcm")
        daemon.wait_motor("wheel", turning(60), "obeys again")
        assert daemon.state()["tick"] > tick
    assert "killed by signal 9" in daemon.program.output


@pytest.mark.parametrize("how", ["rc10ctl", "lcm"])
def test_an_emergency_stop_latches(daemon: Daemon, how: str) -> None:
    with lcm_client(daemon, 60):
        daemon.wait_motor("wheel", turning(60), "turns at 60 rpm")
        if how == "rc10ctl":
            daemon.must("estop")
        else:
            with rc10.connect("host", client="stopper") as robot:
                robot.estop()
        state = daemon.wait_state(
            lambda s: s["state"] == "ESTOP" and without_torque(s["motors"][0]), "stopped"
        )
        assert all(motor["status"] != "ACTIVE" for motor in state["motors"])
        daemon.wait_motor("wheel", lambda m: abs(m["velocity_rpm"]) < 0.5, "stands still")

        # The client goes on sending, and nobody can enable.
        refused = daemon.ctl("enable", "wheel")
        assert refused.returncode == 1
        assert "ESTOP" in refused.stderr
        assert daemon.state()["state"] == "ESTOP"

        daemon.must("clear")
        state = daemon.state()
        assert state["state"] == "RUN"
        assert all(motor["status"] == "READY" for motor in state["motors"])
        assert without_torque(state["motors"][0])
    daemon.must("enable", "wheel")
