"""Set-up of a CAN controller by somebody other than rc10d, and a look at it."""

from __future__ import annotations

from pathlib import Path

from guestlib import run

# Enough for a computer that pauses in most of them.
ATTEMPTS = 20


def set_link(iface: str, settings: str) -> None:
    """In one process, so that rc10d hardly acts in between; again, if it has meanwhile."""
    batch = Path("/tmp/set-link")
    batch.write_text(
        f"link set {iface} down\nlink set {iface} type can {settings}\nlink set {iface} up\n"
    )
    for attempt in range(ATTEMPTS):
        try:
            run("ip", "-batch", batch)
        except RuntimeError as error:
            if "busy" not in str(error) or attempt + 1 == ATTEMPTS:
                raise
        else:
            return


def link_details(iface: str) -> str:
    return run("ip", "-details", "link", "show", iface)
