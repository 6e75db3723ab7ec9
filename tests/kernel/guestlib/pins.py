"""An input pin without hardware: the kernel's gpio-sim (User-Mode Linux guest only)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Self

if TYPE_CHECKING:
    pass

CONFIG = Path("/sys/kernel/config/gpio-sim")


class Pin:
    """Line 0 of a simulated chip, at `chip` (such as /dev/gpiochip0) while `with` is open."""

    def __init__(self, name: str = "rc10", high: bool = False) -> None:
        self._folder = CONFIG / name
        self._bank = self._folder / "bank0"
        self._initial = high
        self._line = Path()
        self.chip = Path()

    def __enter__(self) -> Self:
        self._folder.mkdir()
        self._bank.mkdir()
        (self._bank / "num_lines").write_text("1")
        (self._folder / "live").write_text("1")
        device = (self._folder / "dev_name").read_text().strip()
        chip = (self._bank / "chip_name").read_text().strip()
        self._line = Path("/sys/devices/platform", device, chip, "sim_gpio0")
        self.chip = Path("/dev", chip)
        self.set(self._initial)
        return self

    def __exit__(self, *_: object) -> None:
        (self._folder / "live").write_text("0")
        self._bank.rmdir()
        self._folder.rmdir()

    def set(self, high: bool) -> None:
        """Drive the pin from outside, as a switch does."""
        (self._line / "pull").write_text("pull-up" if high else "pull-down")

    def high(self) -> bool:
        return (self._line / "value").read_text().strip() == "1"
