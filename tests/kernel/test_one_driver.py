"""One rc10d on an interface: a second one is told who drives it, and the first does not notice."""

from __future__ import annotations

import itertools
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from guestlib import Candump, Proc, run
from rig import BIN, C6XX_COMMAND, COMMAND_IDS, CONFIG, MS, commands, daemon, fakes

if TYPE_CHECKING:
    from collections.abc import Callable

HOLD = Path(__file__).with_name("hold_velocity.py")


def other_robot(folder: Path) -> Path:
    file = folder / "other.yaml"
    file.write_text(CONFIG.read_text().replace("robot: vcan_mixed", "robot: other"))
    return file


def test_a_second_rc10d_refuses_the_interface_and_disturbs_nothing(tmp_path: Path) -> None:
    config = other_robot(tmp_path)
    with (
        fakes(),
        daemon() as first,
        Candump("vcan0") as bus,
        Proc(sys.executable, HOLD, "vcan_mixed", "left", "100", "40") as hold,
    ):
        hold.wait_line("holding", 10.0)
        time.sleep(0.3)
        begin_ns = time.time_ns()
        with Proc(BIN / "rc10d", "-c", config) as second:
            assert second.wait(10.0) == 1
            assert (
                f"vcan0 is driven by robot 'vcan_mixed' (rc10d, pid {first.pid}); stop it first"
                in second.output()
            )
        time.sleep(0.1)
        end_ns = time.time_ns()
        bus.stop()
        assert not Path("/run/rc10d/other/rest-frames").exists()
        assert not Path("/run/rc10d/other.sock").exists()
        frames = [frame for frame in bus.frames() if begin_ns < frame.t_ns < end_ns]
        # A frame of each command in every millisecond, no more; the motor was driven all the time.
        for number in COMMAND_IDS:
            stamps = [frame.t_ns for frame in commands(frames, number)]
            assert len(stamps) > 100
            assert all(abs(b - a - MS) < MS // 100 for a, b in itertools.pairwise(stamps))
        assert all(any(frame.data) for frame in commands(frames, C6XX_COMMAND))
        assert "error" not in first.output()


def test_the_interface_is_free_again_however_the_first_ended(tmp_path: Path) -> None:
    config = other_robot(tmp_path)
    ends: list[Callable[[Proc], object]] = [
        Proc.stop,
        lambda process: (run("kill", "-KILL", str(process.pid)), process.wait(5.0)),
    ]
    for end in ends:
        with daemon() as first:
            end(first)
            with daemon(config):
                pass


def test_an_interface_of_the_same_name_in_another_network_namespace_is_another_one(
    tmp_path: Path,
) -> None:
    inside = tmp_path / "inside.sh"
    inside.write_text(
        "ip link set lo up && ip link add vcan0 type vcan && ip link set vcan0 mtu 72 up"
        f" && exec {BIN / 'rc10d'} -c {other_robot(tmp_path)}\n"
    )
    with daemon(), Proc("unshare", "--net", "bash", inside) as second:
        second.wait_line("robot 'other' runs", 10.0)
