"""A real controller driver: settings, frames over the wire, restart of the link."""

from __future__ import annotations

import pytest
from guestlib import Candump, link_down, link_up, run
from link_setup import link_details
from patience import PATIENCE_S


def frame_passes(sender: str, receiver: str) -> bool:
    with Candump(receiver) as bus:
        run("cansend", sender, "201#1122334455667788")
        frame = bus.wait_frame(lambda frame: frame.id == 0x201, PATIENCE_S)
    return frame.data == bytes.fromhex("1122334455667788")


@pytest.mark.parametrize("iface", ["can0", "can1"])
def test_controller_has_its_settings(iface: str) -> None:
    details = link_details(iface)
    assert "bitrate 1000000 " in details
    assert "restart-ms 0" in details
    assert "state ERROR-ACTIVE" in details


@pytest.mark.parametrize(("sender", "receiver"), [("can0", "can1"), ("can1", "can0")])
def test_frame_passes_the_wire(sender: str, receiver: str) -> None:
    assert frame_passes(sender, receiver)


def test_link_works_again_after_down_and_up() -> None:
    link_down("can0")
    assert "state STOPPED" in link_details("can0")
    link_up("can0")
    assert frame_passes("can0", "can1")
