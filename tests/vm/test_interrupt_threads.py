"""rc10-irq on PREEMPT_RT, where each controller's interrupt is served by a thread of the kernel.

The thread is made when the interface comes up, and ends when it goes down.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
from pathlib import Path

import pytest
from guestlib import Proc, link_down, link_up, run, wait_for
from link_setup import set_link
from patience import PATIENCE_S
from robot_file import write_robot

BIN = Path(os.environ["RC10_BUILD"]) / "bin" if "RC10_BUILD" in os.environ else Path()

KERNELS_OWN = (os.SCHED_FIFO, 50)


def threads(iface: str) -> dict[int, tuple[int, int]]:
    """Policy and priority of the interrupt threads of an interface, by their ids."""
    found = {}
    for process in Path("/proc").glob("[0-9]*"):
        try:
            name = (process / "comm").read_text().strip()
            if name.startswith("irq/") and name.endswith(f"-{iface}"):
                pid = int(process.name)
                found[pid] = os.sched_getscheduler(pid), os.sched_getparam(pid).sched_priority
        except OSError:  # it has just ended
            continue
    return found


def restart(iface: str) -> int:
    """Take a link down and up; the id of its new interrupt thread, as the kernel made it."""
    set_link(iface, "bitrate 1000000 restart-ms 0")
    wait_for(lambda: list(threads(iface).values()) == [KERNELS_OWN], PATIENCE_S, "a new thread")
    (pid,) = threads(iface)
    return pid


def await_lifted(watch: Proc, iface: str, *, other_than: int = 0) -> int:
    """Wait until an interface has one thread, lifted, and rc10-irq has said so; the thread's id."""

    def lifted() -> int | None:
        now = threads(iface)
        pids = [pid for pid, priority in now.items() if priority == (os.SCHED_FIFO, 70)]
        if len(now) != 1 or not pids or pids[0] == other_than:
            return None
        line = rf"^{iface} irq/\d+-{iface} \(pid {pids[0]}\): priority (50|not real-time) -> 70$"
        return pids[0] if re.search(line, watch.output(), re.MULTILINE) else None

    return wait_for(lifted, PATIENCE_S, f"a lifted thread of {iface}", poll_s=0.05)


def rc10_irq(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [BIN / "rc10-irq", *words], capture_output=True, text=True, timeout=PATIENCE_S, check=False
    )


# An SJA1000, and a CTU CAN FD.
@pytest.mark.parametrize("iface", ["can0", "can2"])
def test_the_new_thread_of_a_link_that_comes_up_again_is_lifted(iface: str) -> None:
    before = restart(iface)
    with Proc(BIN / "rc10-irq", "--watch", iface) as watch:
        assert await_lifted(watch, iface) == before
        link_down(iface)
        assert threads(iface) == {}
        link_up(iface)
        await_lifted(watch, iface, other_than=before)
        assert watch.stop() == 0


def test_what_rc10d_restarts_itself_is_lifted(tmp_path: Path) -> None:
    config = write_robot(
        tmp_path,
        """\
  - name: chassis
    interface: can0
    manage_link: true
    motors:
      - {name: left, model: M3508, id: 1, feedback_timeout_ms: 1000}
""",
    )
    with (
        Proc(BIN / "rc10d", "-c", config, env={"RC10_RUN_DIR": "/tmp/rc10"}) as daemon,
        Proc(BIN / "rc10-irq", "--watch") as watch,
    ):
        # It has restarted the link too, when it began.
        daemon.wait_line("robot 'vm' runs", PATIENCE_S)
        before = await_lifted(watch, "can0")
        run("ip", "link", "set", "can0", "down")
        daemon.wait_line("interface down: can0 taken down and up", PATIENCE_S)
        await_lifted(watch, "can0", other_than=before)


def test_once_for_all_interfaces_with_another_priority() -> None:
    pids = {iface: restart(iface) for iface in ("can0", "can1")}
    done = rc10_irq("--priority", "80")
    assert (done.returncode, done.stderr) == (0, "")
    for iface, pid in pids.items():
        assert f"-{iface} (pid {pid}): priority 50 -> 80\n" in done.stdout
        assert threads(iface) == {pid: (os.SCHED_FIFO, 80)}
    assert "can0" not in rc10_irq("--priority", "80").stdout


def test_of_one_that_is_down_it_says_that_the_thread_comes_later() -> None:
    link_down("can0")
    done = rc10_irq("can0")
    assert (done.returncode, done.stdout) == (
        0,
        "can0 is down: its interrupt thread is made when it comes up\n",
    )


def test_doctor_names_what_mends_it() -> None:
    restart("can0")
    finding = interrupt_finding()
    assert finding["status"] == "warn"
    assert "rc10-irq" in finding["fix"]
    assert rc10_irq().returncode == 0
    assert interrupt_finding()["status"] == "pass"


def interrupt_finding() -> dict[str, str]:
    done = subprocess.run(
        [BIN / "rc10ctl", "doctor", "--json", "--latency-seconds", "0"],
        capture_output=True,
        text=True,
        check=False,
    )
    findings = [json.loads(line) for line in done.stdout.splitlines()]
    (finding,) = (each for each in findings if each.get("check") == "can0 interrupt threads")
    return dict(finding)


@pytest.mark.parametrize("words", [[], ["--watch"]])
def test_without_the_right_to_do_it_it_says_how_to_get_it(words: list[str]) -> None:
    pid = restart("can0")
    command = ["setpriv", "--bounding-set=-sys_nice", "--inh-caps=-sys_nice"]
    with Proc(*command, BIN / "rc10-irq", *words) as process:
        assert process.wait(PATIENCE_S) == 1
        assert "CAP_SYS_NICE" in process.output()
        assert "sudo systemctl enable --now rc10-irq" in process.output()
    assert threads("can0") == {pid: KERNELS_OWN}


def test_it_needs_no_other_right_than_that_one() -> None:
    restart("can0")
    command = ["setpriv", "--reuid=65534", "--regid=65534", "--clear-groups"]
    command += ["--bounding-set=-all,+sys_nice", "--inh-caps=-all,+sys_nice"]
    command += ["--ambient-caps=-all,+sys_nice", "--no-new-privs"]
    with Proc(*command, BIN / "rc10-irq", "--watch") as watch:
        await_lifted(watch, "can0")
