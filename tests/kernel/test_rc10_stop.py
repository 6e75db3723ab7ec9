"""The daemon is killed while a motor turns: rc10-stop has the last word."""

from __future__ import annotations

import itertools
import signal
import struct
import subprocess
import sys
import time
from pathlib import Path

import pytest
from guestlib import Candump, Frame, Proc, netem, run, wait_for
from rig import BIN, C6XX_COMMAND, COMMAND_IDS, CONFIG, MS, ROBOT, commands, currents, daemon, fakes

HOLD = Path(__file__).with_name("hold_velocity.py")
LEFT_FEEDBACK = 0x201
REST = "0000000000000000"


def rc10_stop(*words: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [BIN / "rc10-stop", *words], capture_output=True, text=True, timeout=60, check=False
    )


def holder() -> Proc:
    return Proc(sys.executable, HOLD, "vcan_mixed", "left", "100", "40")


def rotor_rpm(frame: Frame) -> int:
    rpm: int = struct.unpack_from(">h", frame.data, 2)[0]
    return rpm


def after(frames: list[Frame], t_ns: int) -> list[Frame]:
    return [frame for frame in frames if frame.t_ns > t_ns]


@pytest.mark.parametrize(
    ("number", "words"), [(signal.SIGKILL, ["--all"]), (signal.SIGSEGV, [ROBOT])]
)
def test_the_motor_of_a_killed_rc10d_is_brought_to_rest(
    number: signal.Signals, words: list[str], tmp_path: Path
) -> None:
    unguarded = tmp_path / "robot.yaml"
    unguarded.write_text(CONFIG.read_text().replace("robot:", "guard: off\nrobot:", 1))
    with fakes(), daemon(unguarded) as process, Candump("vcan0") as bus, holder() as hold:
        hold.wait_line("holding", 10.0)
        time.sleep(0.5)
        process.signal(number)
        assert process.wait(5.0) == -number
        time.sleep(0.1)
        killed_ns = time.time_ns()
        time.sleep(0.3)
        # Like a real drive without a watchdog, it goes on with its last command.
        assert any(commands(bus.frames(), C6XX_COMMAND)[-1].data)
        assert abs(rotor_rpm(commands(bus.frames(), LEFT_FEEDBACK)[-1])) > 500
        assert not after(commands(bus.frames(), C6XX_COMMAND), killed_ns)
        done = rc10_stop(*words)
        assert (done.returncode, done.stderr) == (0, "")
        wait_for(
            lambda: rotor_rpm(commands(bus.frames(), LEFT_FEEDBACK)[-1]) == 0, 30.0, poll_s=0.2
        )
        bus.stop()
        for command in COMMAND_IDS:
            sent = after(commands(bus.frames(), command), killed_ns)
            assert [currents(frame) for frame in sent] == [(0, 0, 0, 0)] * 3


def test_it_refuses_while_rc10d_runs_unless_forced() -> None:
    with fakes(), daemon() as process, Candump("vcan0") as bus, holder() as hold:
        hold.wait_line("holding", 10.0)
        time.sleep(0.3)
        begin_ns = time.time_ns()
        refused = rc10_stop(ROBOT)
        assert refused.returncode == 1
        assert f"vcan0 is driven by robot '{ROBOT}' (rc10d, pid {process.pid})" in refused.stderr
        assert "rc10ctl estop" in refused.stderr
        assert rc10_stop("--all").returncode == 0
        time.sleep(0.1)
        stamps = [frame.t_ns for frame in after(commands(bus.frames(), C6XX_COMMAND), begin_ns)]
        assert len(stamps) > 50
        assert all(abs(b - a - MS) < MS // 100 for a, b in itertools.pairwise(stamps))

        forced_ns = time.time_ns()
        assert rc10_stop(ROBOT, "--force").returncode == 0
        bus.stop()
        frames = after(commands(bus.frames(), C6XX_COMMAND), forced_ns)
        assert sum(not any(frame.data) for frame in frames) == 3


def test_a_clean_end_leaves_the_file_for_execstoppost() -> None:
    with fakes(), daemon() as process:
        assert process.stop() == 0
        text = Path(f"/run/rc10d/{ROBOT}/rest-frames").read_text()
        assert text.splitlines()[2:] == [f"vcan0 200#{REST}", f"vcan0 2FE#{REST}"]
        with Candump("vcan0") as bus:
            assert rc10_stop("--all").returncode == 0
        assert len(commands(bus.frames(), C6XX_COMMAND)) == 3


def test_an_interface_that_is_gone_does_not_keep_the_others_from_their_rest(
    tmp_path: Path,
) -> None:
    file = tmp_path / "rest-frames"
    file.write_text(f"vcan9 200#{REST}\nvcan0 200#{REST}\nvcan1 00000901#00\nvcan1 123##1AABB\n")
    run("ip", "link", "set", "vcan1", "up")
    with Candump("vcan0", "vcan1") as bus:
        done = rc10_stop("--file", file)
    assert done.returncode == 1
    assert "vcan9" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    sent = [(frame.iface, frame.id, frame.ext, frame.data.hex()) for frame in bus.frames()]
    assert sorted(sent) == sorted(
        [
            ("vcan0", 0x200, False, REST),
            ("vcan1", 0x901, True, "00"),
            ("vcan1", 0x123, False, "aabb"),
        ]
        * 3
    )
    assert all(frame.fd == (frame.id == 0x123) for frame in bus.frames())


def test_an_interface_that_is_down_is_named(tmp_path: Path) -> None:
    file = tmp_path / "rest-frames"
    file.write_text(f"vcan0 200#{REST}\n")
    run("ip", "link", "set", "vcan0", "down")
    done = rc10_stop("--file", file)
    assert done.returncode == 1
    assert "vcan0" in done.stderr
    assert "down" in done.stderr


def test_a_bus_that_takes_nothing_is_given_up_after_a_fifth_of_a_second(tmp_path: Path) -> None:
    file = tmp_path / "rest-frames"
    file.write_text(f"vcan0 200#{REST}\nvcan0 1FF#{REST}\nvcan1 200#{REST}\n")
    netem("vcan0", "rate 1kbit limit 1")
    with Candump("vcan1") as bus:
        begin_ns = time.monotonic_ns()
        done = rc10_stop("--file", file)
        elapsed_ns = time.monotonic_ns() - begin_ns
    assert done.returncode == 1
    assert "vcan0" in done.stderr
    assert "queue is full" in done.stderr
    assert 190 * MS < elapsed_ns < 300 * MS
    assert len(bus.frames()) == 3


def test_an_interface_that_it_leaves_out_is_told_and_the_status_says_so(tmp_path: Path) -> None:
    other = tmp_path / "other.yaml"
    other.write_text(CONFIG.read_text().replace("robot: vcan_mixed", "guard: off\nrobot: other"))
    with fakes(), daemon(other) as dead:
        dead.signal(signal.SIGKILL)
        dead.wait(5.0)
        with daemon() as process, Candump("vcan0") as bus:
            # The dead one's frames would come between those of the living.
            time.sleep(0.1)
            done = rc10_stop("--all")
            assert done.returncode == 1
            words = f"vcan0 is driven by robot '{ROBOT}' (rc10d, pid {process.pid}), which runs"
            assert done.stderr.count(words) == 1
            time.sleep(0.1)
            bus.stop()
            stamps = [frame.t_ns for frame in commands(bus.frames(), C6XX_COMMAND)]
            assert all(abs(b - a - MS) < MS // 100 for a, b in itertools.pairwise(stamps))
        Path("/run/rc10d/other/rest-frames").unlink()


def test_the_identity_of_the_dead_decides_not_its_number(tmp_path: Path) -> None:
    text = Path(f"/run/rc10d/{ROBOT}/rest-frames")
    with fakes(), daemon() as process:
        assert text.read_text().startswith(f"# pid {process.pid}, start ")
        # Another process of its number, which began at another time: that one is dead.
        copy = tmp_path / "rest-frames"
        copy.write_text(f"# pid {process.pid}, start 1\nvcan1 200#{REST}\n")
        run("ip", "link", "set", "vcan1", "up")
        with Candump("vcan1") as bus:
            assert rc10_stop("--file", copy).returncode == 0
        assert len(bus.frames()) == 3
