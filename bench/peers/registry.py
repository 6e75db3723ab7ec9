"""Clients from package registries, in their pinned versions, and what a guest needs to run them."""

from __future__ import annotations

import subprocess
from dataclasses import dataclass
from pathlib import Path

REPO = Path(__file__).resolve().parents[2]
CLIENTS = REPO / "bench/peers/clients"
INSTALLED = REPO / "build/registry"
WANTED = REPO / "tests/registry/requirements.txt"
PYTHON = Path("/usr/bin/python3")
PACKAGES = "/opt/clients/lib/site-packages"  # motorbridge looks at folders so far above


@dataclass(frozen=True)
class Client:
    """A script of `clients/` that drives four DM4310 at 1 kHz."""

    name: str
    script: str
    lacks: str


# Feedback has no age, error frames are not read, nor what was sent; nothing stops when the program
# hangs; a motor has no limits but those of its frame.
NO_SUPERVISION = "ages, error frames, echo, watchdog, limits"
# They can set the watchdog of a drive.
NO_WATCHDOG_SET = "ages, error frames, echo; the drive's watchdog is not set here; limits"
NAIVE = Client("python-can, naive loop", "client_python_can.py", NO_SUPERVISION)
DAMIAO_MOTOR = Client("damiao-motor", "client_damiao.py", NO_WATCHDOG_SET)
# They speak to the kernel's CAN and to nothing else.
BCM = Client(
    "python-can, BCM",
    "client_python_can_bcm.py",
    NO_SUPERVISION + "; the kernel sends, and goes on after a hang",
)
MOTORBRIDGE = Client("motorbridge", "client_motorbridge.py", NO_WATCHDOG_SET)


def install() -> None:
    """As scripts/test/registry.sh."""
    subprocess.run([REPO / "scripts/lib/pinned_venv", INSTALLED, WANTED], check=True)


def guest_files() -> dict[str, Path]:
    """Python with its library, the clients and their packages: place in a guest -> place here."""
    install()
    library = Path(_python_says("sysconfig.get_path('stdlib')"))
    packages = INSTALLED / "lib" / library.name / "site-packages"
    return {
        "/bin/python3": PYTHON.resolve(),
        str(library): library,
        "/clients": CLIENTS,
        PACKAGES: packages,
    }


def guest_command(client: Client) -> str:
    return f"PYTHONPATH={PACKAGES} /bin/python3 /clients/{client.script} --channel vcan0"


def _python_says(expression: str) -> str:
    code = f"import sysconfig; print({expression})"
    done = subprocess.run([PYTHON, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.strip()
