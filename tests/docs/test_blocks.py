"""Each block of a page is run, compiled or compared by a test, or the list below says why not."""

from __future__ import annotations

import re
from typing import NamedTuple

import pytest
from pages import REPO, Page, pages

# By page and first line.
NOT_RUN = {
    # Drawings.
    ("ARCHITECTURE.md", "robot programs ─ LCM"): "a drawing",
    (
        "ARCHITECTURE.md",
        "app:           nothing",
    ): "tests/layers/check_layers.py has the same layers",
    ("ARCHITECTURE.md", "intake       sockets"): "a drawing",
    ("docs/gpio.md", "   closed_level: low"): "a drawing",
    # Another computer, another system.
    ("docs/can-setup.md", "dtparam=spi=on"): "the boot files of a Raspberry Pi",
    ("docs/realtime.md", "isolcpus="): "a kernel's command line",
    ("docs/realtime.md", "echo performance"): "a real CPU's governor",
    ("docs/realtime.md", "sudo systemctl enable --now rc10-irq"): "interrupts of a real controller",
    ("docs/rc10ctl.md", "$ sudo rc10-irq --watch"): "interrupts of a real controller",
    ("docs/lcm.md", "sudo apt install wireguard-tools"): "a network of two computers",
    ("docs/lcm.md", "[Interface]"): "a network of two computers",
    ("docs/lcm.md", "[Service]"): "a network of two computers",
    ("docs/can-setup.md", "[Service]"): "a unit of the user's own",
    ("docs/installing.md", "# sudo systemctl edit rc10d"): "a unit of the user's own",
    ("docs/studio.md", "[Service]"): "a unit of the user's own",
    ("docs/studio.md", "rc10d --check robot.yaml"): "a file of an installed robot",
    ("docs/studio.md", "rc10-web "): "a service; tests/host/test_web.py runs rc10-web",
    ("docs/serial-devices.md", "ls -l /dev/serial/by-id"): "a real serial port",
    (
        "docs/serial-devices.md",
        "sudo apt install socat",
    ): "tests/host/test_own_board.py has a pty of its own",
    ("docs/serial-devices.md", "static rc10_text_line line;"): "an STM32's HAL",
    ("README.md", "git clone"): "scripts/test/fresh.sh runs the second line",
    ("docs/quick-start.md", "git clone"): "scripts/test/fresh.sh runs the second line",
    # Programs.
    ("docs/porting-from-stm32.md", "// firmware"): "two programs side by side",
    (
        "docs/tuning.md",
        "as_shipped: velocity, multisine",
    ): "tests/host/test_motion.py runs the command; the figures are this computer's",
    ("docs/robot-programs.md", "lift = robot.move_to"): "python/tests/test_moves.py",
    (
        "docs/robot-programs.md",
        "poses = rc10.Publisher",
    ): "python/tests/test_topics.py, test_services.py",
}
SHELL = {"sh", "console", "text"}
# Whose Python a test runs.
PROGRAMS = {"README.md", "docs/python.md", "python/README.md"}
# A comment of a page may explain more than the source does.
COMMENT = re.compile(r"[ \t]*(?:#(?!include)|//|/\*).*")


class Block(NamedTuple):
    page: str
    kind: str
    note: str
    text: str

    @property
    def title(self) -> str:
        return f"{self.page}: {self.text.splitlines()[0]}"


def blocks_of(page: Page) -> list[Block]:
    fence = re.compile(r"^```(?P<kind>\w*) ?(?P<note>[^\n]*)\n(?P<text>.*?)^```", re.M | re.S)
    return [
        Block(page.name, *match.group("kind", "note", "text"))
        for match in fence.finditer(page.text)
    ]


BLOCKS = [
    block for page in pages() if not page.name.endswith(".zh-CN.md") for block in blocks_of(page)
]


def reason(block: Block) -> str:
    """The reason why nothing runs it; empty: it is not on the list."""
    whys = [
        why
        for (page, first), why in NOT_RUN.items()
        if page == block.page and block.text.startswith(first)
    ]
    return whys[0] if whys else ""


def source(path: str) -> str:
    return (REPO / path).read_text(encoding="utf-8")


def squeezed(text: str) -> str:
    """Without comments and blanks: pages are narrower than sources, or wider."""
    return "".join("".join(COMMENT.sub("", line).split()) for line in text.splitlines())


def missing_pieces(text: str, path: str) -> list[str]:
    """Pieces of the text that do not stand in the source; an empty line or "..." ends a piece."""
    whole = squeezed(source(path))
    pieces = re.split(r"\n\s*(?:\.\.\.)?\s*\n", text)
    return [piece for piece in pieces if squeezed(piece) not in whole]


def number_of(block: Block) -> int:
    """Among those of its page with its mark, from 1 on."""
    alike = [b for b in BLOCKS if (b.page, b.note) == (block.page, block.note)]
    return alike.index(block) + 1


def reads(block: Block, test: str) -> bool:
    """Whether the test takes this block from its page."""
    name = block.page.rpartition("/")[2]
    if test.endswith(".py"):
        return "blocks_run_by(" in source(test) and f'"{name}"' in source(test).replace(
            f"docs/{name}", name
        )
    # Some scripts have the pages of docs/ alone.
    path = block.page.replace("docs/", "(?:docs/)?")
    shown = re.findall(rf"shown {path} (\d+)", source(test))
    return str(number_of(block)) in shown


def complaint(block: Block) -> str:
    """Empty: a test has it, or it is on the list."""
    if block.note == "hardware" or (block.kind in ("", "ini") and not block.note):
        return "" if reason(block) else "on no list of what cannot run"
    if reason(block):
        return ""
    if block.kind in ("sh", "console", "text"):
        # Unmarked ones: tests/host/test_docs_shell.py says which test reads their page.
        return (
            "" if not block.note or reads(block, block.note) else f"{block.note} does not read it"
        )
    if block.note.endswith(".py"):
        return "" if reads(block, block.note) else f"{block.note} does not read it"
    if block.note:
        missing = missing_pieces(block.text, block.note)
        return f"not in {block.note}: {missing}" if missing else ""
    if block.kind == "python":
        return "" if block.page in PROGRAMS else "a program that no test runs"
    # tests/host/test_docs_robots.py checks them all.
    return "" if block.kind == "yaml" else "code that no test compiles"


@pytest.mark.parametrize("block", BLOCKS, ids=lambda block: block.title)
def test_a_block_is_run_or_says_why_not(block: Block) -> None:
    assert complaint(block) == ""


def test_the_list_has_no_block_that_is_gone() -> None:
    for page, first in NOT_RUN:
        assert any(b.page == page and b.text.startswith(first) for b in BLOCKS), (page, first)


@pytest.mark.parametrize(
    ("kind", "note", "text"),
    [
        ("", "", "rc10d: all is well\n"),
        ("sh", "hardware", "rc10ctl list\n"),
        ("console", "tests/host/test_estop.py", "$ rc10ctl list\n"),
        ("sh", "scripts/test/fresh.sh", "rc10ctl list\n"),
        ("cpp", "", "int x = 1;\n"),
        ("cpp", "examples/hello_motor/hello_motor.cpp", "int x = 1;\n"),
        ("python", "", "x = 1\n"),
        ("ini", "", "[Unit]\n"),
    ],
)
def test_a_block_that_nobody_runs_is_found(kind: str, note: str, text: str) -> None:
    block = Block("docs/motors.md", kind, note, text)
    BLOCKS.append(block)
    try:
        assert complaint(block) != ""
    finally:
        BLOCKS.remove(block)
