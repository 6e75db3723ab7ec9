"""scripts/demo.sh that ends while it prepares: nothing of it is left."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

pytestmark = pytest.mark.timeout(60)
REPO = Path(__file__).resolve().parents[2]
# Preparation without an end: it starts another process and tells its log. Both hold the pipe open.
ENDLESS = """#!/bin/bash
sleep 600 >&$TOLD &
readlink /proc/$$/fd/1 >&$TOLD
wait
"""
# Compiler that waits to be told that it fails.
CMAKE = """#!/bin/bash
[ "$1" = --build ] || exit 0
echo building >&$TOLD
read -r status
exit "$status"
"""


@pytest.fixture
def demo(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """The demo with stand-ins for all that it prepares, and the pipe that these hold open."""
    scripts = tmp_path / "scripts"
    shutil.copytree(REPO / "scripts" / "lib", scripts / "lib")
    shutil.copy(REPO / "scripts" / "demo.sh", scripts)
    shutil.copy(REPO / "CMakePresets.json", tmp_path)
    for path, text in (
        (scripts / "install-deps.sh", "#!/bin/sh\n"),
        (scripts / "venv.sh", ENDLESS),
        (scripts / "web.sh", ENDLESS),
        (tmp_path / "bin" / "cmake", CMAKE),
    ):
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        path.chmod(0o755)
    told, tell = os.pipe()
    environment = {name: value for name, value in os.environ.items() if name != "RC10_BUILD"}
    environment |= {"PATH": f"{tmp_path}/bin:{os.environ['PATH']}", "TOLD": str(tell)}
    process = subprocess.Popen(
        [scripts / "demo.sh"],
        stdin=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        pass_fds=[tell],
        process_group=0,
        env=environment,
        text=True,
    )
    os.close(tell)
    yield process, told
    os.close(told)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


def folder_of_its_logs(told: int) -> Path:
    """Read when the demo compiles and both preparations run."""
    text = ""
    while text.count("\n") < 3:
        text += os.read(told, 4096).decode()
    logs = [Path(line) for line in text.splitlines() if line != "building"]
    assert logs[0].parent == logs[1].parent
    assert logs[0].parent.is_dir()
    return logs[0].parent


@pytest.mark.parametrize(("status", "ended"), [(None, 130), (7, 1)], ids=["Ctrl-C", "no build"])
def test_nothing_is_left_of_a_demo_that_ends_while_it_prepares(
    demo: tuple[subprocess.Popen[str], int], status: int | None, ended: int
) -> None:
    process, told = demo
    folder = folder_of_its_logs(told)
    assert process.stdin is not None
    if status is None:
        os.killpg(process.pid, signal.SIGINT)
    else:
        process.stdin.write(f"{status}\n")
        process.stdin.flush()
    assert process.wait() == ended
    assert os.read(told, 1) == b"", "each process that held the pipe has ended"
    assert not folder.exists()
