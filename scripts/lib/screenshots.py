#!/usr/bin/env python3
"""Makes the pictures of docs/images that show programs: real output of a demo that runs.

  .venv/bin/python scripts/lib/screenshots.py [--build build/dev]

watch.png is the screen of a terminal in which `rc10ctl watch` runs, plot.png what rc10.plot draws.
A quiet computer and root's rights make better figures: everything in the pictures is measured.
"""

from __future__ import annotations

import argparse
import codecs
import fcntl
import os
import select
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time
from pathlib import Path

import pyte
from matplotlib import font_manager
from PIL import Image, ImageDraw, ImageFont

REPO = Path(__file__).resolve().parents[2]
IMAGES = REPO / "docs" / "images"
COLUMNS, ROWS = 118, 40
FONT_PX, LINE_PX, MARGIN_PX = 20, 26, 16
BACKGROUND = "#1b1e24"
FOREGROUND = "#d5d8de"
# pyte's names of the terminal's colours.
COLOURS = {
    "default": FOREGROUND,
    "red": "#f07178",
    "green": "#8fc97b",
    "brown": "#e6c07b",
    "blue": "#72b1f0",
    "magenta": "#c792ea",
    "cyan": "#6cc7cf",
}
INSIDE = "RC10_SCREENSHOTS_INSIDE"
# So many pictures of the sparkline, and as often.
SPARK_PICTURES, HZ = 60, 8
PLOTTED = ("front_left.velocity_rpm", "front_left.target", "yaw.angle_deg")


def enter_namespace() -> None:
    """LCM's multicast goes to a loopback of our own, as in the demo."""
    if os.environ.get(INSIDE) == "yes":
        return
    os.environ[INSIDE] = "yes"
    # Root's own rights make it real-time.
    way = ["unshare", "--net"] if os.geteuid() == 0 else ["unshare", "--net", "--map-root-user"]
    os.execvp(way[0], [*way, sys.executable, *sys.argv])


def run_in_terminal(command: list[str], env: dict[str, str], seconds: float) -> pyte.Screen:
    """The screen after a while, just before Ctrl-C."""
    screen = pyte.Screen(COLUMNS, ROWS)
    stream = pyte.Stream(screen)
    decode = codecs.getincrementaldecoder("utf-8")("replace").decode
    master, slave = os.openpty()
    fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", ROWS, COLUMNS, 0, 0))
    program = subprocess.Popen(command, stdin=slave, stdout=slave, stderr=slave, env=env)
    os.close(slave)
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0:
        if select.select([master], [], [], left)[0]:
            stream.feed(decode(os.read(master, 65536)))
    program.send_signal(signal.SIGINT)
    program.wait()
    os.close(master)
    return screen


def draw(screen: pyte.Screen) -> Image.Image:
    """The lines that have text, in their colours."""
    # Comes with matplotlib, so that the picture is the same everywhere.
    properties = font_manager.FontProperties(family="DejaVu Sans Mono")
    bold = font_manager.FontProperties(family="DejaVu Sans Mono", weight="bold")
    plain_font = ImageFont.truetype(font_manager.findfont(properties), FONT_PX)
    bold_font = ImageFont.truetype(font_manager.findfont(bold), FONT_PX)
    lines = [line.rstrip() for line in screen.display]
    rows = max(index for index, line in enumerate(lines) if line) + 1
    columns = max(len(line) for line in lines)
    cell_px = round(plain_font.getlength("M"))
    size = (columns * cell_px + 2 * MARGIN_PX, rows * LINE_PX + 2 * MARGIN_PX)
    image = Image.new("RGB", size, BACKGROUND)
    pen = ImageDraw.Draw(image)
    for row in range(rows):
        for column in range(columns):
            cell = screen.buffer[row][column]
            place = (MARGIN_PX + column * cell_px, MARGIN_PX + row * LINE_PX)
            colour = COLOURS.get(cell.fg, FOREGROUND)
            pen.text(place, cell.data, fill=colour, font=bold_font if cell.bold else plain_font)
    return image.quantize(colors=48)


def main() -> None:
    """Runs the demo and looks at it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--build", type=Path, default=REPO / "build" / "dev")
    options = parser.parse_args()
    enter_namespace()
    build = options.build.resolve()
    # The second half of the demo, which makes no namespace: this program reads its LCM.
    folder = tempfile.mkdtemp(prefix="rc10-screenshots.")
    env = {
        **os.environ,
        "RC10_BUILD": str(build),
        "RC10_PYTHON": sys.executable,
        "RC10_DEMO_LCM": "yes",
        "RC10_DEMO_WEB": "",
        "RC10_DEMO_PAGE": "",
        "RC10_RUN_DIR": folder,
        "RC10_STATE_DIR": folder,
    }
    demo = subprocess.Popen(
        [REPO / "scripts" / "demo.sh", "--seconds", "600"],
        env=env,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert demo.stdout is not None
    try:
        if not any(line.rstrip().endswith(" watch") for line in demo.stdout):
            sys.exit("screenshots: the demo did not start")
        watch = [
            str(build / "bin" / "rc10ctl"),
            "watch",
            "--hz",
            str(HZ),
            "--spark",
            "yaw.angle_deg",
        ]
        env["LC_ALL"] = "C.UTF-8"
        screen = run_in_terminal(watch, {**env, "TERM": "xterm"}, SPARK_PICTURES / HZ + 1)
        draw(screen).save(IMAGES / "watch.png", optimize=True)
        picture = str(IMAGES / "plot.png")
        plot = [sys.executable, "-m", "rc10.plot", "--robot", "demo", "--seconds", "5"]
        subprocess.run([*plot, "--png", picture, *PLOTTED], env=env, check=True)
    finally:
        demo.send_signal(signal.SIGTERM)
        demo.communicate()


if __name__ == "__main__":
    main()
