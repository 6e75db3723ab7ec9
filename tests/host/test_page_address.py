"""rc10ctl web: the address of the page, as it is now."""

from __future__ import annotations

import hashlib
import json
import os
import re
import socket
import subprocess
from typing import TYPE_CHECKING

import pytest
from hostlib import Daemon, Program
from hostlib.daemon import BIN, CONFIG

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

# Addresses of a network that nobody has; on loopback, so that it stays here.
ELSEWHERE = "198.51.100.7"


@pytest.fixture(scope="module")
def robot() -> Iterator[Daemon]:
    subprocess.run(["ip", "address", "replace", f"{ELSEWHERE}/32", "dev", "lo"], check=True)
    with Daemon(CONFIG.format(realtime="preferred")) as daemon:
        daemon.wait_ready()
        yield daemon


def serve(robot: Daemon, folder: Path, *words: str | Path) -> tuple[Program, str, str]:
    """rc10-web, its port and its token."""
    (folder / "index.html").write_text("<!doctype html><title>page</title>")
    web = Program(BIN / "rc10-web", "--page", folder, "--port", "0", *words, env=robot.env)
    told = web.wait_line(r"http://[^:]+:(\d+)/(?:#(\w+))?$")
    return web, told[1], told[2] or ""


def test_without_a_page_it_says_how_to_start_one(robot: Daemon) -> None:
    with socket.create_server(("127.0.0.1", 0)) as silent:
        done = robot.ctl("web", "--port", silent.getsockname()[1])
    assert done.returncode == 1
    assert "systemctl start rc10-web" in done.stderr


def test_a_page_for_this_computer_alone_has_no_token_and_no_code(
    robot: Daemon, tmp_path: Path
) -> None:
    web, port, _ = serve(robot, tmp_path)
    with web:
        told = robot.must("web", "--port", port)
        assert told.splitlines()[0] == f"on this computer: http://localhost:{port}/"
        assert "Other computers are not served" in told
        assert "█" not in told
        answer = json.loads(robot.must("web", "--port", port, "--json"))
        assert answer == {"here": f"http://localhost:{port}/", "others": []}


def test_other_computers_get_the_token_behind_the_hash(robot: Daemon, tmp_path: Path) -> None:
    web, port, token = serve(robot, tmp_path, "--listen", "0.0.0.0")
    with web:
        answer = json.loads(robot.must("web", "--port", port, "--json"))
        assert answer["here"] == f"http://localhost:{port}/"
        assert f"http://{ELSEWHERE}:{port}/#{token}" in answer["others"]
        assert all("?" not in url for url in answer["others"])


def test_a_token_that_is_not_there_or_open_to_others_is_said(robot: Daemon, tmp_path: Path) -> None:
    web, port, token = serve(
        robot, tmp_path, "--listen", "0.0.0.0", "--token-file", tmp_path / "token"
    )
    with web:
        missing = robot.ctl("web", "--port", port, "--token-file", tmp_path / "none")
        assert missing.returncode == 1
        assert "--token-file" in missing.stderr
        (tmp_path / "token").chmod(0o644)
        exposed = robot.ctl("web", "--port", port, "--token-file", tmp_path / "token")
        assert exposed.returncode == 1
        assert "chmod 600" in exposed.stderr
        for done in (missing, exposed):
            assert token not in done.stdout + done.stderr


def test_a_new_token_comes_with_the_line_of_its_entry(robot: Daemon) -> None:
    words = robot.must("web", "--new-token", "--port", 8011)
    told = json.loads(robot.must("web", "--new-token", "--port", 8011, "--json"))
    address, token = told["url"].split("#")
    assert address == "http://localhost:8011/"
    assert told["sha256"] == hashlib.sha256(token.encode()).hexdigest()
    (token,) = re.findall(r"http://localhost:8011/#(\w{32})\n", words)
    entry = re.search(r"- (\{token: .*\})\n", words)
    assert entry is not None
    assert hashlib.sha256(token.encode()).hexdigest() in entry[1]
    robot.config.with_name("tokens.yaml").write_text(
        robot.config.read_text() + f"\nclients: [{entry[1]}]\n"
    )
    assert "(token): command" in robot.must("check", robot.config.with_name("tokens.yaml"))


def test_a_terminal_without_utf_8_gets_the_address_alone(robot: Daemon, tmp_path: Path) -> None:
    web, port, token = serve(robot, tmp_path, "--listen", "0.0.0.0")
    with web:
        done = subprocess.run(
            [BIN / "rc10ctl", "web", "--port", port],
            env={**os.environ, **robot.env, "LC_ALL": "C"},
            capture_output=True,
            check=True,
        )
        assert done.stdout.isascii()
        assert token.encode() in done.stdout
