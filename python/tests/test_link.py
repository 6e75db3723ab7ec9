"""The client over LCM's real multicast, and what it says when that is not to be had."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import rc10
from fake_daemon import setpoints
from rc10.inbox import STATE_QUEUE
from threaded_daemon import ThreadedDaemon

EXAMPLE = Path(__file__).parent.parent / "examples" / "hello_motor.py"


@pytest.mark.netns(route=False)
def test_without_a_route_the_error_says_how_to_make_one() -> None:
    with pytest.raises(rc10.LinkError) as caught:
        rc10.connect("demo")
    text = str(caught.value)
    assert "sudo ip route add 239.255.76.67/32 dev lo src 127.0.0.1" in text
    assert "sudo ip link set lo multicast on" in text


def test_a_wrong_url_is_not_blamed_on_the_route() -> None:
    with pytest.raises(rc10.LinkError, match=r"could not start with 'bogus://'") as caught:
        rc10.connect("demo", url="bogus://")
    assert "route" not in str(caught.value)


@pytest.mark.parametrize("name", ["", "two words", "demo/1", "d" * 49, "d*"])
def test_a_name_that_makes_no_channel_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="is no robot's name"):
        rc10.connect(name, url="memq://")


def test_a_client_is_called_like_its_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["/opt/team/drive_home.py"])
    with rc10.connect("demo", url="memq://") as robot:
        assert robot.client == "drive_home"
        assert robot.name == "demo"


def test_a_program_with_a_long_name_is_called_as_much_of_it_as_there_is_room_for(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sys, "argv", ["/opt/team/measure_the_whole_arm_again_and_again.py"])
    with rc10.connect("demo", url="memq://") as robot:
        assert robot.client == "measure_the_whole_arm_again_and"
    monkeypatch.setattr(sys, "argv", ["/opt/" + "底盘" * 10 + ".py"])
    with rc10.connect("demo", url="memq://") as robot:
        assert len(robot.client.encode()) == 30
        assert robot.client == "底盘" * 5
    with pytest.raises(ValueError, match="is longer than 31 bytes: shorten it"):
        rc10.connect("demo", url="memq://", client="n" * 32)


@pytest.mark.netns
def test_a_session_runs_over_multicast() -> None:
    with ThreadedDaemon("demo") as daemon:
        daemon.deaf_to_requests = 2
        with rc10.connect("demo", client="tester", priority=3, at_end="coast") as robot:
            robot.wait_for_state()
            robot.enable("wheel")
            while robot.motor("wheel").status is not rc10.MotorStatus.ACTIVE:
                robot.wait_for_state()
            for _, _ in zip(robot.rate(200), range(20)):
                robot.command(wheel=rc10.velocity_rpm(120))
                assert robot.state.age_s < 1.0
            robot.estop()
            assert robot.state.estopped
    assert daemon.operations() == ["enable wheel", "estop", "disable wheel"]
    assert len(daemon.commands) == 21
    assert setpoints(daemon.commands[-1]) == {"wheel": (rc10.Mode.COAST, 0.0)}


@pytest.mark.netns
def test_a_long_pause_does_not_leave_old_states() -> None:
    # Far more than fit into the queue, of which LCM keeps the first.
    threaded = ThreadedDaemon("demo", state_hz=2000)
    with threaded as daemon, rc10.connect("demo") as robot:
        robot.wait_for_state()
        last = daemon.tick + 3 * STATE_QUEUE
        threaded.wait_for_tick(last)
        robot.spin()
        assert robot.state.tick >= last


@pytest.mark.netns
def test_ctrl_c_ends_a_wait_and_lets_go() -> None:
    program = (
        "import rc10\n"
        "with rc10.connect('demo', client='waiter', at_end='disable') as robot:\n"
        "    robot.wait_for_state()\n"
        "    robot.enable('wheel')\n"
        "    print('waiting', flush=True)\n"
        "    for _ in robot.rate(0.001): pass\n"
    )
    with ThreadedDaemon("demo") as daemon:
        process = subprocess.Popen(
            [sys.executable, "-X", "faulthandler", "-c", program],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert process.stdout is not None
        assert process.stdout.readline() == "waiting\n"
        os.kill(process.pid, signal.SIGINT)
        try:
            _, errors = process.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            process.send_signal(signal.SIGABRT)  # says where each of its threads is
            pytest.fail(f"it goes on: {process.communicate()[1]}")
    assert "KeyboardInterrupt" in errors
    assert process.returncode == -signal.SIGINT
    assert daemon.operations() == ["enable wheel", "disable wheel"]


@pytest.mark.netns
def test_the_example_turns_a_motor_and_lets_go() -> None:
    with ThreadedDaemon("demo") as daemon:
        result = subprocess.run(
            [sys.executable, str(EXAMPLE), "demo", "wheel", "--rpm", "90", "--seconds", "0.2"],
            capture_output=True,
            text=True,
            timeout=60,
            check=True,
        )
    assert len(re.findall(r"measured +12.5 rpm", result.stdout)) >= 2
    assert daemon.operations() == ["enable wheel", "disable wheel"]
    assert setpoints(daemon.commands[0]) == {"wheel": (rc10.Mode.VELOCITY, 90.0)}


@pytest.mark.netns(route=False)
def test_the_example_ends_with_a_sentence() -> None:
    result = subprocess.run(
        [sys.executable, str(EXAMPLE), "demo", "wheel"],
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert result.returncode == 1
    assert "hello_motor: LCM could not start" in result.stderr
    assert "Traceback" not in result.stderr
