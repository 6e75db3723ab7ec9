"""udev reads systemd/udev. GPIO chips are in tests/package, where there is one."""

from __future__ import annotations

import grp
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from guestlib import run, wait_for
from patience import PATIENCE_S

if TYPE_CHECKING:
    from collections.abc import Iterator

RULES = Path(__file__).parents[2] / "systemd/udev/60-rc10d.rules"
GROUP = "rc10d"


def reload_rules() -> None:
    run("udevadm", "control", "--reload")


@pytest.fixture
def rules() -> Iterator[None]:
    """In force, on a computer that has their group."""
    if GROUP not in {each.gr_name for each in grp.getgrall()}:
        run("groupadd", "--system", GROUP)
    installed = Path("/run/udev/rules.d") / RULES.name
    installed.parent.mkdir(exist_ok=True)
    installed.write_text(RULES.read_text(encoding="utf-8"), encoding="utf-8")
    reload_rules()
    yield
    installed.unlink()
    reload_rules()


@pytest.mark.usefixtures("rules")
def test_a_serial_adapter_of_ftdi_holds_back_for_one_millisecond_only() -> None:
    adapter = Path("/sys/bus/usb-serial/devices/ttyUSB0")
    wait_for(adapter.exists, PATIENCE_S, "the adapter", poll_s=0.1)
    run("udevadm", "settle")
    latency_ms = adapter / "latency_timer"
    # QEMU's begins with 0, those of FTDI with this.
    latency_ms.write_text("16")
    # As when it is plugged in.
    interface = adapter.resolve().parent.name
    driver = Path("/sys/bus/usb/drivers/ftdi_sio")
    (driver / "unbind").write_text(interface)
    (driver / "bind").write_text(interface)
    wait_for(
        lambda: latency_ms.exists() and latency_ms.read_text() == "1\n",
        PATIENCE_S,
        "a latency of 1 ms",
        poll_s=0.1,
    )


@pytest.mark.usefixtures("rules")
def test_the_daemon_may_keep_the_processor_awake() -> None:
    device = Path("/dev/cpu_dma_latency")
    run("udevadm", "trigger", "--settle", "/sys/class/misc/cpu_dma_latency")
    assert (device.group(), device.stat().st_mode & 0o777) == (GROUP, 0o660)
