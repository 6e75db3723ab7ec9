"""A serial port without a wire: a pseudo terminal with a name that stays."""

from __future__ import annotations

import contextlib
import os
import tty
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pathlib import Path


class FakePort:
    """A device on a USB adapter as the host sees it: plugged in, pulled out, plugged in again.

    The host opens `path`, a link to a pseudo terminal, as it does with /dev/serial/by-id. A
    pseudo terminal has no bit rate: bytes arrive as soon as they are sent.

    Args:
        path: the name that the host opens; it is there while the device is plugged in.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._device: int | None = None
        self._host: int | None = None

    def __enter__(self) -> FakePort:
        self.plug()
        return self

    def __exit__(self, *_: object) -> None:
        self.unplug()

    def plug(self) -> None:
        """Plugs it in; nothing if it is."""
        if self._device is not None:
            return
        self._device, self._host = os.openpty()
        tty.setraw(self._host)
        os.set_blocking(self._device, False)
        self.path.symlink_to(os.ttyname(self._host))

    def unplug(self) -> None:
        """Pulls it out: whoever has it open sees it hang up. Nothing if it is out."""
        if self._device is None or self._host is None:
            return
        self.path.unlink()
        os.close(self._host)
        os.close(self._device)
        self._device = self._host = None

    def send(self, data: bytes) -> None:
        """Sends to the host. Without a host that reads, and unplugged, bytes are lost."""
        if self._device is not None:
            with contextlib.suppress(BlockingIOError):
                os.write(self._device, data)
