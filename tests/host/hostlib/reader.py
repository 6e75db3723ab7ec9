"""The reader of a page: types what it shows, in its order, in as many terminals as it takes."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from hostlib.daemon import BIN, BUILD, REPO
from hostlib.program import Program, eventually

if TYPE_CHECKING:
    from hostlib.page import Block

# They run until Ctrl-C: in a terminal of their own, or until something is seen.
SERVES = re.compile(r"^\S*rc10(d(-\w+)?|-sim) -c \S+$")
WATCHES = re.compile(r"^rc10ctl watch$")
# Beginnings of the shown output of a command that fails.
COMPLAINT = re.compile(r"^(rc10ctl|[\w/]+\.yaml:\d+(:\d+)?): ")
STILL_TURNING = "still turning: the e-stop is cleared when every motor stands still"
# The titles of a table: words in capitals, one for each column.
TITLES = re.compile(r"^[A-Z][A-Z0-9.]*(?: +[A-Z][A-Z0-9.]*)+$")
# The first cell of a row, unless it is a time: two spaces are between columns.
ROW = re.compile(r"^ *([A-Za-z]\S*(?: \S+)*)  +\S")
# The folder that the pages write; its place in the tests is another.
RUN_DIR = "$XDG_RUNTIME_DIR/rc10"
CTRL_C = 130
PATIENCE_S = 60.0


class Command(NamedTuple):
    text: str
    output: str  # as far as the page shows it; sh shows none

    @property
    def complaints(self) -> set[str]:
        return {line for line in self.output.splitlines() if COMPLAINT.match(line)}

    @property
    def headings(self) -> set[str]:
        return headings(self.output)

    @property
    def fails(self) -> bool:
        return bool(self.complaints)


def headings(output: str) -> set[str]:
    """Constant parts of tables: titles, and the beginnings of rows."""
    lines = output.splitlines()
    titles = {" ".join(line.split()) for line in lines if TITLES.match(line)}
    return titles | {row[1] for line in lines if (row := ROW.match(line))}


def commands(block: Block) -> Iterator[Command]:
    """Each line of `sh`; of `console` what stands behind a prompt."""
    if block.kind == "console":
        for part in re.split(r"^\$ ", block.text, flags=re.M)[1:]:
            text, _, output = part.partition("\n")
            yield Command(text, output)
        return
    for line in block.text.splitlines():
        text = re.sub(r"(^|\s+)#.*", "", line).removesuffix("&").strip()
        if text:
            yield Command(text, "")


def only_command(block: Block) -> Command:
    (command,) = commands(block)
    return command


class Reader:
    """Leaving the `with` statement ends what still runs."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        # Short: the path of a socket has 108 bytes at most.
        self.run_dir = Path(tempfile.mkdtemp(prefix="rc10-page-", dir="/dev/shm"))
        self.replace = {RUN_DIR: str(self.run_dir)}
        self._typed_before = [f"export RC10_RUN_DIR={self.run_dir} RC10_STATE_DIR={self.run_dir}"]
        self.servers: list[Program] = []
        # By the commands of the block that was read last.
        self._printed: list[Program | str] = []
        self._status = 0
        for name in ("config", "docs", "examples", "python"):
            (folder / name).symlink_to(REPO / name)
        (folder / ".venv").symlink_to(sys.prefix)
        (folder / "build").mkdir()
        for preset in ("dev", "release"):
            (folder / "build" / preset).symlink_to(BUILD)
        (folder / "root").mkdir()
        sudo = folder / "root" / "sudo"
        sudo.write_text('#!/bin/sh\nexec "$@"\n')
        sudo.chmod(0o755)

    def __enter__(self) -> Reader:
        return self

    def __exit__(self, *_: object) -> None:
        for server in self.servers:
            server.stop()
        shutil.rmtree(self.run_dir)

    def read(self, block: Block) -> None:
        """Types each command of the block; each must end as the page says."""
        self._printed = []
        for command in commands(block):
            text = command.text
            for old, new in self.replace.items():
                text = text.replace(old, new)
            if text.startswith("export "):
                self._typed_before.append(text)
            elif text == "echo $?":
                assert int(command.output) == self._status
            elif SERVES.match(text):
                self.serve(text)
            elif WATCHES.match(text):
                self.watch(Command(text, command.output))
            else:
                self.run(Command(text, command.output))

    def serve(self, text: str) -> None:
        """Starts it in a terminal of its own, and waits until every motor is READY."""
        server = Program("bash", "-ec", self.script(f"exec {text}"), env=self.env())
        self.servers.append(server)
        self._printed.append(server)
        if text.startswith("rc10-sim"):
            server.wait_line("^ready", PATIENCE_S)
        else:
            eventually(lambda: not server.running or self.ready(), f"{text}: every motor is READY")
        assert server.running, server.output

    def watch(self, command: Command) -> None:
        """Looks at it, then presses Ctrl-C."""
        with Program("bash", "-ec", self.script(f"exec {command.text}"), env=self.env()) as shown:
            shown.wait_line("^MOTOR ", PATIENCE_S)
            # The second picture: the first is whole then.
            shown.wait_line("^MOTOR ", PATIENCE_S)
            shown.interrupt()
            assert shown.wait() in (0, CTRL_C), shown.output
            assert command.headings <= headings(shown.output), shown.output

    def run(self, command: Command) -> None:
        """Runs it to its end, which must be as the page says."""
        done = self.shell(command.text)
        # A reader who is told that a motor still turns waits, and types it again.
        while STILL_TURNING in done.stderr:
            done = self.shell(command.text)
        self._status = done.returncode
        self._printed.append(done.stdout + done.stderr)
        said = (done.stdout + done.stderr).replace(str(self.run_dir), "/run/rc10d")
        ended = (done.returncode != 0) == command.fails
        told = command.complaints <= {*said.splitlines()}
        other = sorted(command.headings - headings(said))
        logs = "\n".join(server.output for server in self.servers)
        assert ended, f"{command.text}: status {done.returncode}\n{said}\n{logs}"
        assert told, f"{command.text}: without {command.complaints}\n{said}"
        assert not other, f"{command.text}: shown, but not printed: {other}\n{said}"

    @property
    def printed(self) -> str:
        """By the commands of the block that was read last, with the run folder of the pages."""
        texts = [each if isinstance(each, str) else each.output for each in self._printed]
        return "\n".join(texts).replace(str(self.run_dir), "/run/user/1000/rc10")

    def wait_printed(self, text: str, words: str) -> None:
        """Types the command until it prints the words."""
        eventually(lambda: words in self.shell(text).stdout, f"{text}: {words}")

    def ready(self) -> bool:
        states = self.shell("rc10ctl watch --json --count 1").stdout
        return bool(states) and set(re.findall(r'"status":"(\w+)"', states)) == {"READY"}

    def shell(self, text: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            ["bash", "-ec", self.script(text)],
            env=self.env(),
            capture_output=True,
            text=True,
            check=False,
        )

    def script(self, text: str) -> str:
        return "\n".join([f"cd {self.folder}", *self._typed_before, text])

    def env(self) -> dict[str, str]:
        path = [self.folder / "root", Path(sys.executable).parent, BIN, os.environ["PATH"]]
        return {**os.environ, "PATH": ":".join(map(str, path))}
