"""Set-up of a CAN controller by somebody other than rc10d, and a look at it."""

from __future__ import annotations

from pathlib import Path

from guestlib import run


def set_link(iface: str, settings: str) -> None:
    """In one process: rc10d has no time to act in between."""
    batch = Path("/tmp/set-link")
    batch.write_text(
        f"link set {iface} down\nlink set {iface} type can {settings}\nlink set {iface} up\n"
    )
    run("ip", "-batch", batch)


def link_details(iface: str) -> str:
    return run("ip", "-details", "link", "show", iface)
