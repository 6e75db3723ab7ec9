"""systemd-networkd and udev read systemd/networkd, and of the file that a page shows.

Of this guest's interfaces can0 and can1 are SJA1000, can2 and can3 CTU CAN FD.
"""

from __future__ import annotations

import contextlib
import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from guestlib import Proc, link_down, run, wait_for
from hostlib.page import blocks_run_by
from link_setup import link_details, set_link
from patience import PATIENCE_S

if TYPE_CHECKING:
    from collections.abc import Iterator

REPO = Path(__file__).parents[2]
EXAMPLES = REPO / "systemd/networkd"
# Where systemd reads what lasts until the next boot.
CONFIGURATION = Path("/run/systemd/network")
LCM_ROUTE = "239.255.76.67"


def example(name: str) -> str:
    return (EXAMPLES / name).read_text(encoding="utf-8")


@contextlib.contextmanager
def configured(name: str, text: str) -> Iterator[None]:
    CONFIGURATION.mkdir(parents=True, exist_ok=True)
    file = CONFIGURATION / name
    file.write_text(text, encoding="utf-8")
    try:
        yield
    finally:
        file.unlink()


@pytest.fixture(autouse=True)
def seen_by_udev() -> None:
    """networkd leaves alone what udev, which virtme-ng starts, has not seen."""
    run("udevadm", "settle")


def networkd() -> Proc:
    return Proc("/lib/systemd/systemd-networkd")


def bring_up(iface: str, text: str) -> str:
    """A stopped interface after networkd, and of every line of the file."""
    link_down(iface)
    with configured(f"80-{iface}.network", text.replace("can0", iface)), networkd() as process:
        wait_for(lambda: ",UP," in link_details(iface), PATIENCE_S, f"{iface} is up", poll_s=0.1)
        process.stop()
        # FILE:LINE: what it ignores there, and why.
        assert not re.search(r"\.network:\d+", process.output()), process.output()
    return link_details(iface)


@pytest.fixture(params=["example", "page"])
def classic(request: pytest.FixtureRequest) -> str:
    if request.param == "example":
        return example("80-can0.network")
    (block,) = blocks_run_by("tests/vm/test_networkd.py", REPO / "docs/can-setup.md")
    return block.text


def test_a_classic_interface_comes_up_without_an_automatic_restart(classic: str) -> None:
    set_link("can0", "bitrate 500000 restart-ms 100")
    became = bring_up("can0", classic)
    for words in (" bitrate 1000000 ", "restart-ms 0"):
        assert words in became, became


def test_an_interface_for_can_fd_comes_up_with_both_rates_and_sample_points() -> None:
    set_link("can2", "bitrate 500000 fd off restart-ms 100")
    try:
        became = bring_up("can2", example("80-can0-fd.network"))
    finally:
        link_down("can2")
    for words in (
        " bitrate 1000000 sample-point 0.800",
        " dbitrate 5000000 dsample-point 0.750",
        "<FD",
        "restart-ms 0",
    ):
        assert words in became, became


def test_an_interface_gets_the_name_of_its_place() -> None:
    properties = run("udevadm", "info", "--query=property", "/sys/class/net/can1")
    path = re.search(r"^ID_PATH=(\S+)$", properties, re.MULTILINE)
    assert path, properties
    text = example("70-can-by-place.link")
    assert "Path=platform-*.spi-cs-0\n" in text
    link_down("can1")
    with configured("70-chassis.link", text.replace("platform-*.spi-cs-0", path[1])):
        run("udevadm", "control", "--reload")
        run("udevadm", "trigger", "--action=add", "/sys/class/net/can1")
        renamed = Path("/sys/class/net/chassis")
        wait_for(renamed.exists, PATIENCE_S, "the new name", poll_s=0.1)
    run("ip", "link", "set", "chassis", "name", "can1")


def test_the_multicast_group_of_lcm_stays_on_the_computer() -> None:
    run("ip", "route", "del", LCM_ROUTE)
    with configured("70-lo-lcm.network", example("70-lo-lcm.network")), networkd():
        route = wait_for(
            lambda: run("ip", "route", "show", LCM_ROUTE), PATIENCE_S, "the route", poll_s=0.1
        )
    assert "dev lo" in route
    assert "src 127.0.0.1" in route
