"""Changes of the robot's file through rc10-web: who may ask the root helper, and for what."""

from __future__ import annotations

import hashlib
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hostlib import Daemon
from hostlib.daemon import CONFIG
from hostlib.file_helper import FileHelper, FileRequest
from test_web import ELSEWHERE, Page, Web

TOKEN = "abcdefghijkmnpqrstuvwxyz23456789"


def sha256(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()


@pytest.fixture
def helper(tmp_path: Path) -> Iterator[FileHelper]:
    with FileHelper(tmp_path / "config.socket") as helper:
        yield helper


def now_us() -> int:
    return time.monotonic_ns() // 1000


def change(page: Page, kind: str, **message: str) -> dict[str, Any]:
    page.seq += 1
    seq = page.seq
    page.send(type=kind, seq=seq, sent_us=now_us(), **message)
    return page.wait("response", lambda answer: answer["seq"] == seq)


def test_a_page_of_this_computer_asks_the_helper_for_the_robot_that_runs(
    daemon: Daemon, tmp_path: Path, helper: FileHelper
) -> None:
    web = Web(daemon, tmp_path, "--config-socket", str(helper.path))
    shown = daemon.config.read_text()
    with web.program, web.page() as page:
        page.wait("state")
        page.send(type="config", seq=100)
        assert page.wait("config")["sha256"] == sha256(shown)
        answer = change(page, "config_install", text="robot: host\n", replaces=sha256("mine"))
        assert (answer["status"], answer["message"]) == ("ok", "written")
        assert change(page, "config_install", text="robot: host\n")["status"] == "ok"
        helper.answer = "refused\nmotor 'wheel' is ACTIVE"
        refused = change(page, "config_restart")
        assert (refused["status"], refused["message"]) == ("refused", "motor 'wheel' is ACTIVE")
        assert change(page, "config_install", text="x" * 200_000)["status"] == "refused"
        assert change(page, "config_install", text="x", replaces="a b")["status"] == "refused"
    assert helper.requests == [
        FileRequest("install", "host", sha256("mine"), "robot: host\n"),
        FileRequest("install", "host", sha256(shown), "robot: host\n"),
        FileRequest("restart", "host", "-", ""),
    ]


def test_a_change_goes_on_alone(daemon: Daemon, tmp_path: Path, helper: FileHelper) -> None:
    web = Web(daemon, tmp_path, "--config-socket", str(helper.path))
    with web.program, web.page() as page:
        page.wait("state")
        page.send(type="config_install", seq=501, sent_us=now_us(), text="robot: host\n")
        page.send(type="config_restart", seq=502, sent_us=now_us())
        answers = [page.wait("response") for _ in range(2)]
    assert {answer["seq"]: answer["status"] for answer in answers} == {501: "ok", 502: "refused"}
    assert [request.verb for request in helper.requests] == ["install"]


def test_without_rc10d_the_file_of_the_one_robot_that_ran_says_who_may(
    tmp_path: Path, helper: FileHelper
) -> None:
    with Daemon(CONFIG.format(realtime="preferred")) as daemon:
        daemon.wait_ready()
        daemon.kill()
        web = Web(daemon, tmp_path, "--config-socket", str(helper.path))
        with web.program, web.page() as page:
            page.wait("down")
            assert change(page, "config_restart")["status"] == "ok"
            # Another robot's file may say something else.
            (daemon.run_dir / "arm.config").write_text("robot: arm\n")
            assert "--robot" in change(page, "config_restart")["message"]
    assert [request.robot for request in helper.requests] == ["host"]


def test_with_clients_it_takes_a_token_that_may_configure(
    tmp_path: Path, helper: FileHelper
) -> None:
    clients = (
        "clients:\n"
        f"  - {{token: {sha256(TOKEN)}, may: [configure]}}\n"
        f"  - {{token: {sha256('b' * 32)}, may: [command, clear, tune]}}\n"
    )
    with Daemon(clients + CONFIG.format(realtime="preferred")) as daemon:
        daemon.wait_ready()
        web = Web(daemon, tmp_path, "--config-socket", str(helper.path))
        with web.program, web.page() as page:
            page.wait("state")
            for token in (None, "b" * 32):
                if token is not None:
                    page.send(type="token", token=token)
                for kind in ("config_install", "config_restart"):
                    assert "may `configure`" in change(page, kind, text="a")["message"]
            assert helper.requests == []
            page.send(type="token", token=TOKEN)
            assert change(page, "config_restart")["status"] == "ok"
    assert [request.verb for request in helper.requests] == ["restart"]


def test_a_page_from_elsewhere_changes_nothing(
    daemon: Daemon, tmp_path: Path, helper: FileHelper
) -> None:
    subprocess.run(["ip", "address", "replace", f"{ELSEWHERE}/32", "dev", "lo"], check=True)
    words = ("--listen", "0.0.0.0", "--token-file", str(tmp_path / "token"))
    web = Web(daemon, tmp_path, "--config-socket", str(helper.path), *words)
    with web.program, web.page(ELSEWHERE) as page:
        assert change(page, "config_install", text="a")["message"] == "show the token first"
        page.send(type="token", token=web.token)
        page.wait("state")
        for kind in ("config_install", "config_restart"):
            assert "tunnel" in change(page, kind, text="a")["message"]
    assert helper.requests == []


def test_a_robot_without_the_helper_says_so(daemon: Daemon, tmp_path: Path) -> None:
    web = Web(daemon, tmp_path, "--config-socket", str(tmp_path / "nobody"))
    with web.program, web.page() as page:
        page.wait("state")
        assert "lets nobody change its file" in change(page, "config_restart")["message"]
