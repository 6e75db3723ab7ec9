"""Rights of senders, with two users and with LCM: `clients` of the configuration."""

from __future__ import annotations

import os
import shutil
import subprocess
from contextlib import contextmanager
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon
from hostlib.daemon import BIN, CONFIG

import rc10

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

# User of no account: the kernel asks for none.
ANNA, BEN, DRIVERS = 4321, 4322, 4400

CLIENTS = f"""
clients:
  - {{user: {ANNA}, may: [command, clear], motors: [wheel, other, yaw]}}
  - {{group: {DRIVERS}, may: [command], motors: [wheel]}}
  - {{lcm: teleop, may: [command], motors: [wheel], max_priority: 10}}
"""


@contextmanager
def robot(clients: str = CLIENTS) -> Iterator[Daemon]:
    """A robot whose socket everybody may use, as members of rc10 may."""
    with Daemon(CONFIG.format(realtime="preferred") + clients) as daemon:
        daemon.wait_ready()
        daemon.run_dir.chmod(0o755)
        for socket in daemon.run_dir.glob("host.*"):
            if socket.is_socket():
                socket.chmod(0o666)
        # The build tree may be root's alone.
        shutil.copy(BIN / "rc10ctl", daemon.run_dir / "rc10ctl")
        yield daemon


def ctl(daemon: Daemon, user: int, *words: str, groups: Sequence[int] = ()) -> str:
    """Output of rc10ctl as this user."""
    who = [f"--reuid={user}", f"--regid={user}"]
    who.append(f"--groups={','.join(map(str, groups))}" if groups else "--clear-groups")
    done = subprocess.run(
        ["setpriv", *who, str(daemon.run_dir / "rc10ctl"), *words],
        env={**os.environ, **daemon.env},
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert (done.returncode == 0) == (done.stderr == ""), done
    return done.stdout + done.stderr


def test_each_user_may_do_what_the_file_says() -> None:
    with robot() as daemon:
        line = next(
            number
            for number, text in enumerate(daemon.config.read_text().splitlines(), 1)
            if text == "clients:"
        )
        assert "enable: 3 of 3" in ctl(daemon, ANNA, "enable")
        refused = ctl(daemon, BEN, "disable")
        assert f"(user {BEN}) may observe and stop, not command wheel" in refused
        assert (
            f"`- {{user: {BEN}, may: [command]}}` to clients at {daemon.config}:{line}" in refused
        )
        assert f"{daemon.config}:{line + 2}" in ctl(daemon, BEN, "disable", "yaw", groups=[DRIVERS])
        assert "disable: 1 of 1" in ctl(daemon, BEN, "disable", "wheel", groups=[DRIVERS])
        refused = ctl(daemon, ANNA, "gains", "wheel", "velocity.kp=0.3")
        assert f"add tune to `may` at {daemon.config}:{line + 1}" in refused
        assert "ACTIVE" in ctl(daemon, BEN, "watch", "--count", "1"), "everybody may look"
        assert daemon.stats()["refusals"]["not permitted"] == 3
        # Root is named nowhere.
        assert "(user 0) may observe and stop" in daemon.ctl("enable").stderr


LIFT = """
modules:
  - {name: lift, type: synchronised_pair, left: wheel, right: other, velocity_limit_rpm: 60}
"""


def test_targets_and_inputs_that_are_not_permitted_name_the_line_that_would_grant_them() -> None:
    grant = f"add `- {{user: {BEN}, may: [command]}}` to clients at "
    with robot(CLIENTS + LIFT) as daemon:
        assert "enable: 3 of 3" in ctl(daemon, ANNA, "enable")
        refused = ctl(daemon, BEN, "set", "wheel", "velocity", "10", "--for", "1s")
        assert "not command wheel: " + grant in refused
        refused = ctl(daemon, BEN, "signal", "lift", "velocity_rpm=10", "--for", "1s")
        assert "not command lift: " + grant in refused


def test_anybody_stops_and_who_may_clears() -> None:
    with robot() as daemon:
        ctl(daemon, ANNA, "enable")
        assert "ESTOP" in ctl(daemon, BEN, "estop") or daemon.state()["state"] == "ESTOP"
        daemon.wait_state(lambda state: state["state"] == "ESTOP", "stopped")
        assert "not clear" in ctl(daemon, BEN, "clear")
        daemon.wait_motors(lambda motor: abs(motor["velocity_rpm"]) < 1.0)
        assert "clear: 3 of 3" in ctl(daemon, ANNA, "clear")
        assert daemon.state()["state"] == "RUN"


def test_a_name_on_lcm_has_the_rights_of_its_entry() -> None:
    with robot() as daemon:
        with rc10.connect("host", client="teleop") as teleop:
            teleop.wait_for_state()
            teleop.enable("wheel")
            with pytest.raises(rc10.RequestRefused, match="may not command yaw"):
                teleop.enable("yaw")
        with rc10.connect("host", client="stranger") as stranger:
            stranger.wait_for_state()
            with pytest.raises(rc10.RequestRefused, match="lcm: stranger, may: "):
                stranger.disable("wheel")
            stranger.estop()
        daemon.wait_state(lambda state: state["state"] == "ESTOP", "stopped")
        daemon.program.wait_line(r"'teleop' \(LCM, this computer\) may not command yaw")


def test_a_user_that_this_computer_has_not_is_told_at_the_start() -> None:
    clients = "clients: [{user: nobody_of_that_name, may: [command]}]\n"
    with Daemon(CONFIG.format(realtime="preferred") + clients) as daemon:
        assert daemon.program.wait() != 0
        assert "there is no user 'nobody_of_that_name'" in daemon.program.output


def test_locked_tuning_is_told() -> None:
    with robot("tuning: locked\n") as daemon:
        refused = daemon.ctl("gains", "wheel", "velocity.kp=0.3")
        assert refused.returncode != 0
        assert "`tuning: locked` at " in refused.stderr
        daemon.must("gains", "wheel")
        assert "  TUNING LOCKED  " in daemon.must("watch", "--once")
        with rc10.connect("host", client="teleop") as client:
            assert rc10.Condition.TUNING_LOCKED in client.wait_for_state(10.0).conditions
        daemon.must("enable", "wheel")
