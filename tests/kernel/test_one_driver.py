"""One rc10d on an interface: a second one is told who drives it, and the first does not notice."""

from __future__ import annotations

import itertools
import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING

from guestlib import Candump, Proc, link_add, link_delete, link_down, link_up, run
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


def rename(old: str, new: str) -> None:
    link_down(old)
    run("ip", "link", "set", old, "name", new)
    link_up(new)


def refused(config: Path, *, run_dir: Path | None = None) -> str:
    """Output of a second rc10d, which does not start."""
    env = {} if run_dir is None else {"RC10_RUN_DIR": str(run_dir)}
    with Proc(BIN / "rc10d", "-c", config, env=env) as second:
        assert second.wait(10.0) == 1
        return second.output()


def test_another_run_folder_is_no_way_around_the_first(tmp_path: Path) -> None:
    with daemon() as first:
        words = refused(other_robot(tmp_path), run_dir=tmp_path / "run")
        assert f"vcan0 is driven by robot 'vcan_mixed' (rc10d, pid {first.pid})" in words
        # The same robot, too: not even its rest frames are written.
        words = refused(CONFIG, run_dir=tmp_path / "run")
        assert f"vcan0 is driven by robot 'vcan_mixed' (rc10d, pid {first.pid})" in words
        assert not list((tmp_path / "run").rglob("rest-frames"))


def test_another_name_of_the_interface_is_no_way_around_the_first(tmp_path: Path) -> None:
    run("ip", "link", "property", "add", "dev", "vcan0", "altname", "front")
    config = other_robot(tmp_path)
    config.write_text(config.read_text().replace("vcan0", "front"))
    with daemon() as first:
        assert f"front is driven by robot 'vcan_mixed' (rc10d, pid {first.pid})" in refused(config)
        # Its rc10d makes the scan, and nobody beside it.
        scan = subprocess.run(
            [BIN / "rc10ctl", "--json", "scan", "front", "--seconds", "0.5"],
            capture_output=True,
            text=True,
            check=True,
        )
        assert json.loads(scan.stdout.splitlines()[-1])["robot"] == "vcan_mixed"
        # A new name does not free it either: its sockets are still the first one's.
        rename("vcan0", "rear")
        config.write_text(config.read_text().replace("front", "rear"))
        assert f"rear is driven by robot 'vcan_mixed' (rc10d, pid {first.pid})" in refused(config)
        rename("rear", "vcan0")


def test_one_file_cannot_name_an_interface_twice(tmp_path: Path) -> None:
    run("ip", "link", "property", "add", "dev", "vcan0", "altname", "front")
    file = tmp_path / "twice.yaml"
    file.write_text(
        """robot: twice
realtime: preferred
buses:
  - name: left
    type: socketcan
    interface: vcan0
    motors:
      - {name: one, model: M3508, id: 1}
  - name: right
    type: socketcan
    interface: front
    motors:
      - {name: two, model: M3508, id: 2}
"""
    )
    words = refused(file)
    assert "buses 'left' and 'right' are one: vcan0 and front are names of the same interface" in (
        words
    )


def test_an_interface_that_comes_back_is_locked_before_it_is_opened(tmp_path: Path) -> None:
    config = other_robot(tmp_path)
    with daemon() as first:
        link_delete("vcan0")
        first.wait_line("bus interface gone", 5.0)
        link_add("vcan0")
        time.sleep(0.2)
        assert f"vcan0 is driven by robot 'vcan_mixed' (rc10d, pid {first.pid})" in refused(config)
        # While it is away another rc10d may take what is plugged in, and the first leaves it alone.
        link_delete("vcan0")
        time.sleep(0.2)
        first.signal(signal.SIGSTOP)
        link_add("vcan0")
        with daemon(config) as second:
            first.signal(signal.SIGCONT)
            first.wait_line(f"vcan0 is driven by robot 'other' .rc10d, pid {second.pid}.", 5.0)
            assert second.stop() == 0
        time.sleep(0.2)
        assert f"vcan0 is driven by robot 'vcan_mixed' (rc10d, pid {first.pid})" in refused(config)
