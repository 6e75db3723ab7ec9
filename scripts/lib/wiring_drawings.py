#!/usr/bin/env python3
"""Draws the wiring of a bus and of the e-stop circuit, in each language of the pages.

usage: scripts/lib/wiring_drawings.py     (writes docs/images/wiring-*.svg)

Lines are grey and boxes light, so that white and dark pages bear them.
"""
# ruff: noqa: RUF001 (signs of Chinese text)

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple
from xml.sax.saxutils import escape

IMAGES = Path(__file__).resolve().parents[2] / "docs/images"
LANGUAGES = {"": 0, ".zh-CN": 1}

STYLE = """  <style>
    .box { fill: #eef3f8; stroke: #5b7a99; stroke-width: 1.5; }
    .name { fill: #16202b; font-weight: bold; }
    .note { fill: #7d8590; font-size: 13px; }
    .wire { stroke: #7d8590; stroke-width: 2; fill: none; }
    .power { stroke: #d55e00; stroke-width: 4; fill: none; }
    .high { stroke: #e69f00; stroke-width: 2.5; fill: none; }
    .low { stroke: #0072b2; stroke-width: 2.5; fill: none; }
    .dot { fill: #7d8590; }
  </style>"""


class Words(NamedTuple):
    english: str
    chinese: str


class Drawing:
    """Parts of one picture, in one language."""

    def __init__(self, width: int, height: int, title: Words, language: int) -> None:
        self.language = language
        self.parts = [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}"',
            '  role="img" aria-labelledby="title"',
            '  font-family="Helvetica, Arial, sans-serif" font-size="14">',
            f'  <title id="title">{escape(title[language])}</title>',
            STYLE,
        ]

    def text(
        self, x: int, y: int, words: Words | str, kind: str = "note", at: str = "start"
    ) -> None:
        said = words if isinstance(words, str) else words[self.language]
        self.parts.append(
            f'  <text class="{kind}" x="{x}" y="{y}" text-anchor="{at}">{escape(said)}</text>'
        )

    def box(self, x: int, y: int, width: int, height: int, *lines: Words | str) -> None:
        self.parts.append(
            f'  <rect class="box" x="{x}" y="{y}" width="{width}" height="{height}" rx="6"/>'
        )
        top = y + height // 2 + 5 - 9 * (len(lines) - 1)
        for number, line in enumerate(lines):
            self.text(x + width // 2, top + 18 * number, line, "name", "middle")

    def wire(self, *points: tuple[int, int], kind: str = "wire") -> None:
        path = " ".join(f"{x},{y}" for x, y in points)
        self.parts.append(f'  <polyline class="{kind}" points="{path}"/>')

    def dot(self, x: int, y: int) -> None:
        self.parts.append(f'  <circle class="dot" cx="{x}" cy="{y}" r="4"/>')

    def resistor(self, x: int, top: int, bottom: int) -> None:
        middle = (top + bottom) // 2
        self.wire((x, top), (x, middle - 14))
        self.parts.append(
            f'  <rect class="box" x="{x - 6}" y="{middle - 14}" width="12" height="28"/>'
        )
        self.wire((x, middle + 14), (x, bottom))

    def contact(self, x: int, y: int, kind: str = "wire", *, closed: bool) -> None:
        """Contact of 50 px, from left to right. Drawn without a hand on it and without power."""
        self.dot(x, y)
        self.dot(x + 50, y)
        self.wire((x, y), (x + 50, y - (7 if closed else 20)), kind=kind)
        if closed:  # the bar that a normally closed contact rests on
            self.wire((x + 50, y - 14), (x + 50, y), kind=kind)

    def svg(self) -> str:
        return "\n".join([*self.parts, "</svg>", ""])


COMPUTER = Words("Raspberry Pi, Jetson", "树莓派、Jetson")


def bus(language: int) -> str:
    title = Words(
        "A CAN bus: one line from drive to drive, 120 ohm at each end",
        "CAN 总线：一条线串过所有电调，两端各 120 Ω",
    )
    drawing = Drawing(860, 330, title, language)
    high, low, ground, last = 60, 110, 270, 790
    drawing.box(20, 30, 170, 110, COMPUTER, Words("with a CAN HAT", "和 CAN HAT"))
    drawing.text(200, high - 8, "CAN_H")
    drawing.text(200, low + 18, "CAN_L")
    drawing.wire((190, high), (last, high), kind="high")
    drawing.wire((190, low), (last, low), kind="low")
    for x in (275, last):
        drawing.dot(x, high)
        drawing.dot(x, low)
        drawing.resistor(x, high, low)
    drawing.text(262, high - 12, Words("120 Ω: jumper of the HAT", "120 Ω：HAT 的跳线帽"))
    drawing.text(
        last + 10, high - 12,
        Words("120 Ω: switch of the last drive", "120 Ω：最后一个电调的开关"), at="end",
    )  # fmt: skip
    for x, name in ((350, Words("drive 1", "电调 1")), (500, Words("drive 2", "电调 2")),
                    (700, Words("last drive", "最后一个电调"))):  # fmt: skip
        drawing.dot(x + 25, high)
        drawing.dot(x + 75, low)
        drawing.wire((x + 25, high), (x + 25, 160), kind="high")
        drawing.wire((x + 75, low), (x + 75, 160), kind="low")
        drawing.box(x, 160, 100, 50, name)
        drawing.wire((x + 50, 210), (x + 50, ground))
        drawing.dot(x + 50, ground)
    drawing.text(625, 190, "…", at="middle")
    drawing.wire((105, 140), (105, ground), (750, ground))
    drawing.text(115, ground - 8, Words("GND, or the supplies' minus", "GND，或电源负极"))
    drawing.text(
        20, 300,
        Words("CAN_H and CAN_L twisted; branches shorter than 30 cm; no star. "
              "Without power, between CAN_H and CAN_L: 60 Ω.",
              "CAN_H 和 CAN_L 双绞；分支短于 30 cm；不要接成星形。"
              "断电后 CAN_H 和 CAN_L 之间应为 60 Ω。"),
    )  # fmt: skip
    return drawing.svg()


def stop(language: int) -> str:
    title = Words(
        "E-stop circuit: button and heartbeat relay drop the contactor of the motors' power",
        "急停电路：急停按钮和心跳继电器都能让电机电源的接触器断开",
    )
    drawing = Drawing(860, 500, title, language)
    # Power of the motors.
    drawing.box(20, 40, 110, 50, Words("battery", "电池"))
    drawing.wire((130, 65), (430, 65), kind="power")
    drawing.text(175, 50, Words("fuse", "保险丝"), at="middle")
    drawing.parts.append('  <rect class="box" x="150" y="57" width="50" height="16"/>')
    drawing.contact(430, 65, "power", closed=False)
    drawing.text(455, 30, Words("K1: contactor", "K1：接触器"), at="middle")
    drawing.wire((480, 65), (690, 65), kind="power")
    drawing.box(690, 40, 150, 50, Words("drives", "电调"))
    # Coil of the contactor.
    coil = 170
    drawing.dot(220, 65)
    drawing.wire((220, 65), (220, 110), (100, 110), (100, coil), (190, coil))
    drawing.contact(190, coil, closed=True)
    drawing.text(215, coil - 24, Words("S1: e-stop button", "S1：急停按钮"), at="middle")
    drawing.wire((240, coil), (330, coil))
    drawing.contact(330, coil, closed=False)
    drawing.text(355, coil - 28, Words("K2: heartbeat relay", "K2：心跳继电器"), at="middle")
    drawing.wire((380, coil), (470, coil))
    drawing.contact(470, coil, closed=False)
    drawing.text(495, coil - 28, Words("S2: start button", "S2：启动按钮"), at="middle")
    drawing.wire((455, coil), (455, coil + 50), (470, coil + 50))
    drawing.dot(455, coil)
    drawing.contact(470, coil + 50, closed=False)
    drawing.wire((520, coil + 50), (560, coil + 50), (560, coil))
    drawing.dot(560, coil)
    drawing.text(495, coil + 72, Words("K1: holds itself", "K1：自锁"), at="middle")
    drawing.wire((520, coil), (640, coil))
    drawing.box(640, coil - 22, 80, 44, Words("coil K1", "线圈 K1"))
    drawing.wire((720, coil), (800, coil))
    drawing.text(805, coil + 5, Words("minus", "负极"))
    # Signals of the computer.
    drawing.box(20, 320, 170, 130, COMPUTER)
    drawing.text(200, 342, "heartbeat_gpio")
    drawing.wire((190, 350), (350, 350))
    drawing.box(350, 318, 220, 64,
                Words("edge watchdog", "边沿看门狗"),
                Words("74HC123 or charge pump", "74HC123 或电荷泵"))  # fmt: skip
    drawing.wire((570, 350), (640, 350))
    drawing.box(640, 328, 80, 44, Words("coil K2", "线圈 K2"))
    drawing.wire((720, 350), (800, 350))
    drawing.text(805, 355, Words("minus", "负极"))
    drawing.text(
        460, 400,
        Words("drops out 50 to 200 ms after the last edge", "最后一个边沿之后 50 到 200 ms 断开"),
        at="middle",
    )  # fmt: skip
    drawing.text(200, 422, "estop_gpio")
    drawing.wire((190, 430), (350, 430))
    drawing.contact(350, 430, closed=True)
    drawing.text(410, 450, Words("S1: its second contact", "S1：它的第二个触点"))
    drawing.wire((400, 430), (800, 430))
    drawing.text(805, 435, "GND")
    drawing.text(
        20, 485,
        Words("Drawn without power and with no hand on a button. "
              "Whatever opens the line of K1 needs S2 to close it again.",
              "按断电、没有人按按钮的状态画出。K1 的线路一旦断开，要按 S2 才会再接通。"),
    )  # fmt: skip
    return drawing.svg()


def drawings() -> dict[Path, str]:
    return {
        IMAGES / f"wiring-{name}{suffix}.svg": draw(language)
        for name, draw in (("bus", bus), ("stop", stop))
        for suffix, language in LANGUAGES.items()
    }


if __name__ == "__main__":
    for path, drawn in drawings().items():
        path.write_text(drawn, encoding="utf-8")
        print(path)
