"""A guest whose clock counts instructions: kernel and user together, one guest nanosecond each.

QEMU translates, one CPU, `-icount shift=0`: how busy the host is changes nothing, a repeat with
the same kernel and files gives the same figures. Instructions are no cycles: no cache, no
pipeline. Compare variants; do not read off microseconds of a board.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

# In the order in which they need each other.
MODULES = (
    "net/can/can.ko",
    "net/can/can-raw.ko",
    "net/can/can-bcm.ko",
    "drivers/net/can/dev/can-dev.ko",
    "drivers/net/can/vcan.ko",
)
# ttyS0 carries the output of the script, ttyS1 the kernel's messages and the script's status.
INIT = """\
#!/bin/sh
export PATH=/bin HOME=/tmp
/bin/busybox --install -s /bin
mount -t proc p /proc; mount -t sysfs s /sys; mount -t devtmpfs d /dev
mkdir -p /dev/shm; mount -t tmpfs m /dev/shm; mount -t tmpfs r /run; mount -t tmpfs t /tmp
for module in /modules/*; do insmod $module || exit; done
ip link set lo up || exit
for bus in vcan0 vcan1; do /sbin/ip link add $bus type vcan && ip link set $bus up || exit; done
stty -F /dev/ttyS0 -onlcr
(cd /tmp; exec sh /script </dev/null >/dev/ttyS0 2>&1)
echo "status $?" >/dev/ttyS1
sleep 0.1; poweroff -f
"""


class GuestError(Exception):
    """The guest, or the script in it, has failed."""


@dataclass(frozen=True)
class Kernel:
    """An image and the folder of its modules, as Debian's packages have them."""

    name: str
    image: Path
    modules: Path


def installed_rt_kernel() -> Kernel:
    images = sorted(Path("/boot").glob("vmlinuz-*-rt-amd64"))
    if not images:
        raise GuestError("no PREEMPT_RT kernel: apt-get install linux-image-rt-amd64")
    release = images[-1].name.removeprefix("vmlinuz-")
    return Kernel("PREEMPT_RT", images[-1], Path("/lib/modules") / release / "kernel")


def fetched_kernel(cache: Path) -> Kernel:
    """Debian's ordinary kernel. Unpacked only: the host's boot stays as it is."""
    if not cache.exists():
        depends = _output("apt-cache", "depends", "linux-image-amd64")
        package = re.search(r"Depends: (linux-image-\S+)", depends)
        if not package:
            raise GuestError("apt knows no linux-image-amd64: apt-get update")
        cache.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=cache.parent) as folder:
            _output(
                "apt-get",
                "download",
                "-qq",
                "-o",
                "APT::Sandbox::User=root",
                package[1],
                cwd=folder,
            )
            (archive,) = Path(folder).glob("*.deb")
            _output("dpkg", "-x", archive, Path(folder) / "root")
            shutil.move(Path(folder) / "root", cache)
    (image,) = (cache / "boot").glob("vmlinuz-*")
    release = image.name.removeprefix("vmlinuz-")
    return Kernel("ordinary", image, cache / "lib/modules" / release / "kernel")


def run(kernel: Kernel, script: str, files: dict[str, Path], *, limit_s: float = 600) -> str:
    """Returns the output of the script.

    `files`: place in the guest -> file or folder, with the libraries that it needs.
    """
    with tempfile.TemporaryDirectory(prefix="rc10-counted-") as folder:
        work = Path(folder)
        _build_root(work / "root", kernel, script, files)
        _pack(work / "root", work / "initrd")
        return _boot(kernel, work, limit_s)


def _build_root(root: Path, kernel: Kernel, script: str, files: dict[str, Path]) -> None:
    for name in ("bin", "dev", "proc", "sys", "run", "tmp", "modules"):
        (root / name).mkdir(parents=True)
    for number, module in enumerate(MODULES):
        shutil.copy(kernel.modules / module, root / "modules" / f"{number}.ko")
    _add(root, "/bin/busybox", Path(_program("busybox")))
    _add(root, "/sbin/ip", Path(_program("ip")))
    (root / "bin/sh").symlink_to("busybox")
    for place, file in files.items():
        _add(root, place, file)
    (root / "script").write_text(script)
    (root / "init").write_text(INIT)
    (root / "init").chmod(0o755)


# No program of a guest imports these.
_LEFT_OUT = shutil.ignore_patterns(
    "test", "tests", "config-*", "dist-packages", "pip", "setuptools", "*.a"
)


def _add(root: Path, place: str, file: Path) -> None:
    target = root / place.lstrip("/")
    target.parent.mkdir(parents=True, exist_ok=True)
    if file.is_dir():
        shutil.copytree(file, target, ignore=_LEFT_OUT)
        for library in [*target.rglob("*.so"), *target.rglob("*.so.*")]:
            _add_libraries(root, library)
    else:
        shutil.copy(file, target)
        _add_libraries(root, file)


def _add_libraries(root: Path, file: Path) -> None:
    listed = subprocess.run(["ldd", file], capture_output=True, text=True, check=False).stdout
    for library in re.findall(r"(/\S+) \(", listed):
        copy = root / library.lstrip("/")
        if not copy.exists():
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(library, copy)


def _pack(root: Path, initrd: Path) -> None:
    names = "\n".join(str(path.relative_to(root)) for path in [root, *sorted(root.rglob("*"))])
    with initrd.open("wb") as out:
        subprocess.run(
            [_program("busybox"), "cpio", "-o", "-H", "newc", "-R", "0:0"],
            input=names.encode(),
            stdout=out,
            stderr=subprocess.DEVNULL,
            cwd=root,
            check=True,
        )


def _boot(kernel: Kernel, work: Path, limit_s: float) -> str:
    log = work / "log"
    log.touch()
    command = [
        *(_program("qemu-system-x86_64"), "-nodefaults", "-no-user-config", "-display", "none"),
        *("-no-reboot", "-m", "1024", "-accel", "tcg,thread=single", "-smp", "1"),
        *("-icount", "shift=0,sleep=off", "-rtc", "base=2025-01-01,clock=vm", "-seed", "1"),
        *("-kernel", str(kernel.image), "-initrd", str(work / "initrd")),
        *("-append", "console=ttyS1 quiet panic=-1", "-serial", "stdio", "-serial", f"file:{log}"),
    ]
    try:
        done = subprocess.run(
            command, stdin=subprocess.DEVNULL, capture_output=True, timeout=limit_s, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise GuestError(f"the guest did not end within {limit_s:g} s") from error
    output = done.stdout.decode(errors="replace")
    status = re.search(r"^status (\d+)", log.read_text(errors="replace"), re.MULTILINE)
    if not status or status[1] != "0":
        what = f"status {status[1]}" if status else "no status"
        raise GuestError(f"{what}: {output[-2000:]}{log.read_text(errors='replace')[-2000:]}")
    return output


def _program(name: str) -> str:
    found = shutil.which(name, path="/usr/local/bin:/usr/bin:/bin:/usr/sbin:/sbin")
    if not found:
        raise GuestError(f"{name} is missing: scripts/install-deps.sh vm")
    return found


def _output(*command: str | Path, cwd: str | None = None) -> str:
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=cwd)
    if done.returncode != 0:
        raise GuestError(f"{command[0]}: {done.stderr[-500:]}")
    return done.stdout
