"""Out of file descriptors, a program does its work or says what is wrong with a non-zero exit."""

from __future__ import annotations

import contextlib
import http.client
import os
import re
import signal
import socket
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon
from hostlib.daemon import BIN
from hostlib.program import Program, eventually

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hostlib.daemon import State

# From what a loader needs to what every program has enough of.
LIMITS = range(3, 24)


def limited(limit: int, *command: str | Path, env: dict[str, str]) -> tuple[int, str, str]:
    """Exit status and output of a program that may have so many descriptors."""
    done = subprocess.run(
        ["prlimit", f"--nofile={limit}", "--", *map(str, command)],
        env={**os.environ, **env},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    return done.returncode, done.stdout, done.stderr


def stopped_since(count: int) -> Callable[[State], bool]:
    return lambda state: bool(state["estop_count"] > count)


def ends_or_says(program: Program, words: str) -> Callable[[], bool]:
    return lambda: not program.running or words in program.output


def catches_sigterm(pid: int) -> bool:
    """False before its main(): what the dynamic loader says begins with the program's name, too."""
    with contextlib.suppress(OSError):
        status = Path(f"/proc/{pid}/status").read_text()
        caught = re.search(r"^SigCgt:\s*(\w+)$", status, re.MULTILINE)
        return caught is not None and bool(int(caught[1], 16) >> (signal.SIGTERM - 1) & 1)
    return False


def judge(limit: int, outcome: tuple[int, str, str], expected: str) -> bool:
    """Whether it did its work; if not, it has said why."""
    status, output, errors = outcome
    assert status >= 0, f"{limit} descriptors: killed by {signal.Signals(-status).name}: {errors}"
    if status == 0:
        assert expected in output + errors, (
            f"{limit} descriptors: no work and no complaint: {output}"
        )
        return True
    assert errors.strip(), f"{limit} descriptors: status {status} without a word"
    return False


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("list",), "wheel"),
        (("watch", "--once"), "wheel"),
        (("stats",), "wake-up"),
        (("enable", "wheel"), "enable: 1 of 1"),
        (("gains", "wheel"), "velocity_pid"),
        (("set", "wheel", "velocity", "10", "--for", "20ms"), ""),
        (("check", "/dev/null"), ""),
    ],
    ids=lambda value: value[0] if isinstance(value, tuple) else "",
)
def test_rc10ctl_does_it_or_says_why_not(
    daemon: Daemon, words: tuple[str, ...], expected: str
) -> None:
    daemon.must("enable", "wheel")
    done = [
        judge(limit, limited(limit, BIN / "rc10ctl", *words, env=daemon.env), expected)
        for limit in LIMITS
    ]
    assert not done[0], "three are stdin, stdout and stderr"
    assert done[-1] or words[0] == "check"


def test_an_estop_with_few_descriptors_is_one_or_fails_loudly() -> None:
    with Daemon() as daemon:
        daemon.wait_ready()
        for limit in LIMITS:
            count = daemon.state()["estop_count"]
            status, _, errors = limited(limit, BIN / "rc10ctl", "estop", env=daemon.env)
            assert status >= 0
            if status == 0:
                daemon.wait_state(stopped_since(count), "stopped")
                daemon.must("clear")
            else:
                assert errors.strip()
        assert status == 0


CLIENT = """
import sys, rc10
with rc10.connect("host", client="few") as robot:
    print(robot.wait_for_state(10.0).status.name)
"""


def test_a_python_program_sees_the_state_or_an_error_with_the_cause(daemon: Daemon) -> None:
    seen = [
        judge(limit, limited(limit, sys.executable, "-c", CLIENT, env=daemon.env), "RUN")
        for limit in (6, 7, 8, 9, 10, 12, 16, 24)
    ]
    assert seen[-1]


def test_a_cpp_program_moves_the_motor_or_says_why_not(daemon: Daemon) -> None:
    def moves(limit: int) -> bool:
        hello = (BIN / "hello_motor", "host", "yaw", "20")
        return judge(limit, limited(limit, *hello, env=daemon.env), "yaw stands")

    assert not moves(3), "three are stdin, stdout and stderr"
    for limit in (4, 5, 6, 8):
        moves(limit)
    # A busy computer may be late with its targets, and says so.
    eventually(lambda: moves(24), "it has enough of them")


def test_rc10d_with_few_descriptors_runs_or_names_the_remedy() -> None:
    remedy = "(LimitNOFILE= of the unit, `ulimit -n`)"
    ended = []
    for limit in range(6, 24):
        with Daemon(prefix=("prlimit", f"--nofile={limit}", "--")) as limited_daemon:
            program = limited_daemon.program
            socket_path = limited_daemon.run_dir / "host.sock"
            up = eventually(
                partial(lambda one, path: not one.running or path.exists(), program, socket_path),
                f"{limit} descriptors: it listens or ends",
            )
            assert up
            if program.running:
                program.signal(signal.SIGTERM)
            if program.wait() != 0:
                ended.append(limit)
                assert remedy in program.output, f"{limit} descriptors: {program.output}"
    assert ended


def test_a_gateway_without_descriptors_says_so_and_ends_or_tries_again(daemon: Daemon) -> None:
    for limit in range(3, 12):
        with Program(
            BIN / "rc10-lcm", "--url", "udpm://239.255.76.67:7668?ttl=0",
            env=daemon.env, prefix=("prlimit", f"--nofile={limit}", "--"),
        ) as gateway:  # fmt: skip
            ended = eventually(
                lambda: (
                    not gateway.running
                    or ("rc10-lcm: " in gateway.output and catches_sigterm(gateway.pid))
                ),
                f"{limit} descriptors: it works, complains or ends",
            )
            assert ended
            if gateway.running:
                gateway.signal(signal.SIGTERM)
                # Above 0: it was about to end after its complaint.
                assert gateway.wait() >= 0
            else:
                assert gateway.wait() > 0
                assert gateway.output
    assert "LCM on 239.255.76.67:7668" in gateway.output


def test_rc10_web_without_descriptors_says_so_at_its_start(daemon: Daemon, tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text("page")
    for limit in LIMITS:
        with Program(
            BIN / "rc10-web", "--port", "0", "--page", tmp_path,
            env=daemon.env, prefix=("prlimit", f"--nofile={limit}", "--"),
        ) as web:  # fmt: skip
            eventually(
                ends_or_says(web, "http://"),
                f"{limit} descriptors: it serves or ends",
            )
            if not web.running:
                assert web.wait() > 0
                assert web.output
    assert web.output


@contextlib.contextmanager
def visitors(port: int, most: int) -> Iterator[list[socket.socket]]:
    """Connections that ask for nothing."""
    sockets: list[socket.socket] = []
    try:
        address = ("127.0.0.1", port)
        sockets.extend(socket.create_connection(address, timeout=5.0) for _ in range(most))
        yield sockets
    finally:
        for one in sockets:
            one.close()


def test_rc10_web_serves_again_when_descriptors_are_free(daemon: Daemon, tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text("page")
    with Program(
        BIN / "rc10-web", "--port", "0", "--page", tmp_path,
        env=daemon.env, prefix=("prlimit", "--nofile=20", "--"),
    ) as web:  # fmt: skip
        port = int(web.wait_line(r"http://localhost:(\d+)")[1])
        with visitors(port, 30):
            eventually(
                lambda: len(list(Path(f"/proc/{web.pid}/fd").iterdir())) >= 20, "no descriptor left"
            )
            # It waits instead of asking again and again.
            before = cpu_ticks(web.pid)
            start = daemon.state()["tick"]
            daemon.wait_state(lambda state: state["tick"] > start + 1000, "a second later")
            assert cpu_ticks(web.pid) - before < 50
        page = eventually(lambda: answer(port), "it serves again")
        assert page == "page"


def cpu_ticks(pid: int) -> int:
    """Hundredths of a second of CPU time."""
    words = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return int(words[11]) + int(words[12])


def answer(port: int) -> str:
    with contextlib.suppress(OSError, http.client.HTTPException):
        connection = http.client.HTTPConnection("127.0.0.1", port, timeout=5.0)
        connection.request("GET", "/")
        return connection.getresponse().read().decode()
    return ""


def test_a_guard_without_descriptors_does_not_start_or_sends_rc10d_away_in_words(
    tmp_path: Path,
) -> None:
    served = tmp_path / "guard.socket"
    for limit in LIMITS:
        with Program(
            BIN / "rc10-guard", "--until-unused",
            env={"RC10_RUN_DIR": str(tmp_path)}, prefix=("prlimit", f"--nofile={limit}", "--"),
        ) as guard:  # fmt: skip
            eventually(
                partial(lambda program: not program.running or served.exists(), guard),
                f"{limit} descriptors: it listens or ends",
            )
            asked = guard.running
            if asked:
                guard.signal(signal.SIGTERM)
            status = guard.wait()
            # It may end, in words, between its socket and what it needs besides.
            assert (asked and status == 0) or (status > 0 and guard.output)
