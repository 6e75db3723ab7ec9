"""rc10-guard without a CAN interface; with one: tests/kernel/test_guard.py."""

from __future__ import annotations

import array
import contextlib
import fcntl
import mmap
import os
import resource
import signal
import socket
import subprocess
from typing import TYPE_CHECKING

import pytest
from hostlib import eventually
from hostlib.daemon import BIN
from hostlib.program import PATIENCE_S, full_pipe

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

# src/link/guard_page.hpp
PAGE_BYTES = 16
TICKS = 0
ACTED = 9


class Watched:
    """A process that the guard takes for an rc10d among its ticks."""

    def __init__(self, run_dir: Path) -> None:
        self._process = subprocess.Popen(["sleep", "600"])
        page = os.memfd_create("page", os.MFD_ALLOW_SEALING)
        os.ftruncate(page, PAGE_BYTES)
        fcntl.fcntl(page, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK)
        self._page = mmap.mmap(page, PAGE_BYTES)
        self._page[TICKS] = 1
        process = os.pidfd_open(self._process.pid)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._socket.settimeout(PATIENCE_S)
        self._socket.connect(str(run_dir / "guard.socket"))
        rights = array.array("i", [page, process])
        self._socket.sendmsg(
            [b"rc10-guard 1 hero 60000\n# none\n"],
            [(socket.SOL_SOCKET, socket.SCM_RIGHTS, rights)],
        )
        os.close(page)
        os.close(process)
        assert self._socket.recv(64) == b"armed"

    def kill(self) -> None:
        self._process.kill()
        self._process.wait()
        eventually(lambda: self._page[ACTED] == 1, "the guard acts")


@contextlib.contextmanager
def guard(
    run_dir: Path, stderr: int, file_bytes: int | None = None
) -> Iterator[subprocess.Popen[bytes]]:
    limit = file_bytes if file_bytes is not None else resource.RLIM_INFINITY
    with subprocess.Popen(
        [BIN / "rc10-guard"],
        env={**os.environ, "RC10_RUN_DIR": str(run_dir)},
        stderr=stderr,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
    ) as process:
        eventually((run_dir / "guard.socket").exists, "the guard listens")
        try:
            yield process
        finally:
            process.kill()


def test_it_watches_on_when_nobody_reads_what_it_says(tmp_path: Path) -> None:
    with full_pipe() as stderr, guard(tmp_path, stderr):
        for _ in range(2):
            Watched(tmp_path).kill()


def test_it_watches_on_when_its_file_is_full(tmp_path: Path) -> None:
    log = tmp_path / "log"
    log.write_bytes(b"x" * 4096)
    with log.open("ab") as stderr, guard(tmp_path, stderr.fileno(), 4096):
        for _ in range(2):
            Watched(tmp_path).kill()


@pytest.mark.parametrize(
    "number", [signal.SIGUSR1, signal.SIGALRM, signal.SIGTTOU, signal.SIGRTMIN]
)
def test_a_signal_that_means_nothing_to_it_ends_no_watch(
    tmp_path: Path, number: signal.Signals
) -> None:
    with guard(tmp_path, subprocess.DEVNULL) as process:
        watched = Watched(tmp_path)
        process.send_signal(number)
        watched.kill()
