"""Messages that pages show alone, caused for real."""

from __future__ import annotations

from hostlib import Daemon
from hostlib.daemon import ARM, REPO
from hostlib.page import blocks_run_by
from hostlib.shown import missing_lines

HERE = "tests/host/test_docs_messages.py"
DEMO = (REPO / "config" / "demo.yaml").read_text(encoding="utf-8")
OF_PILOT = (
    ARM
    + """\
      - {name: wheel, model: M3508, id: 1, feedback_timeout_ms: 1000}
      - {name: yaw, model: M3508, id: 2, feedback_timeout_ms: 1000}
clients:
  - {user: root, may: [command], motors: [wheel]}
"""
)


def message_of(page: str) -> str:
    (block,) = blocks_run_by(HERE, REPO / "docs" / page)
    return block.text


def test_who_may_not_command_a_motor_is_told_with_the_line_that_would_grant_it() -> None:
    with Daemon(OF_PILOT) as daemon:
        daemon.wait_ready()
        done = daemon.ctl("enable", "yaw")
        assert done.returncode == 1
        # The page's client and file.
        said = done.stderr.removeprefix("rc10ctl: ").replace("'rc10ctl' (", "'pilot' (")
        said = said.replace(str(daemon.config), "/etc/rc10d/robot.yaml")
        assert missing_lines(message_of("configuration.md"), said) == []


def test_a_request_names_the_motors_that_it_left_out() -> None:
    silent = DEMO.replace("initial_angle_deg: 30}", "initial_angle_deg: 30, silent: true}")
    with Daemon(silent) as daemon:
        daemon.wait_up()
        daemon.wait_motor("feeder", lambda motor: motor["status"] == "READY", "is there")
        done = daemon.ctl("enable")
        assert done.returncode == 1
        assert missing_lines(message_of("lcm.md"), done.stderr.removeprefix("rc10ctl: ")) == []
