"""rc10-web: the text of the robot's file, and what the checker says to a page's own."""

from __future__ import annotations

import json
import stat
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest
from hostlib import Daemon
from hostlib.daemon import BIN
from test_web import Page, Web, resident_kib


@pytest.fixture
def web(daemon: Daemon, tmp_path: Path) -> Iterator[Web]:
    server = Web(daemon, tmp_path)
    with server.program:
        yield server


def test_a_text_is_checked_by_the_words_of_the_checker_itself(web: Web, daemon: Daemon) -> None:
    wrong = daemon.config.read_text().replace("id: 2", "id: 1").replace("zero:", "zer:")
    file = daemon.run_dir / "wrong.yaml"
    file.write_text(wrong)
    told = subprocess.run([BIN / "rc10d", "--check", file], capture_output=True, text=True).stderr
    with web.page() as page:
        page.send(type="config_check", seq=5, text=wrong)
        checked = page.wait("config_checked")
    assert checked["seq"] == 5
    assert checked["checked"]["robot"] is None
    lines = [
        f"{file}:{one['line']}:{one['column']}: {one['path']}: {one['text']}"
        for one in checked["checked"]["errors"]
    ]
    assert len(lines) > 1
    assert lines == told.splitlines()[:-1]


BOMB = "".join(
    [
        "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n",
        *(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 10)),
    ]
)


def test_hostile_texts_are_refused_in_words_and_nobody_else_notices(web: Web) -> None:
    hostile = {
        BOMB: "more than 20000 values",
        "[" * 100_000: "nested more than 16 deep",
        "{a: " * 30_000: "nested more than 16 deep",
        "- " * 60_000: "nested more than 16 deep",
        "robot: !!python/object:os.system 'touch /tmp/x'\n": "tags are not accepted",
        "robot: \u0007": "a control character",
        "buses: *nobody": "not YAML",
        "": "the document is empty",
    }
    with web.page() as page, web.page() as other:
        for seq, (text, words) in enumerate(hostile.items()):
            page.send(type="config_check", seq=seq, text=text)
            other.wait("state")
            checked = page.wait("config_checked")
            assert checked["seq"] == seq
            assert any(words in one["text"] for one in checked["checked"]["errors"]), words
        page.send(type="config_check", seq=90, text="x" * (128 * 1024 + 1))
        refused = page.wait("response")
        assert refused["seq"] == 90
        assert "128 KiB" in refused["message"]
        page.send(type="config_check", seq=91)
        refused = page.wait("response")
        assert (refused["seq"], refused["status"]) == (91, "refused")
        assert other.ask("enable", "wheel")["status"] == "ok"
    assert resident_kib(web.program.pid) < 64 * 1024


def test_a_page_that_asks_faster_than_it_is_answered_gets_the_newest_answer(web: Web) -> None:
    with web.page() as page:
        for seq in range(50):
            page.send(type="config_check", seq=seq, text=f"robot: r{seq}\n")
        answered: dict[int, str] = {}
        while 49 not in answered:
            message = page.next()
            if isinstance(message, dict) and message["type"] in ("config_checked", "response"):
                answered[message["seq"]] = message["type"]
        assert answered[49] == "config_checked"
        assert len(answered) == 50
        for seq in range(50, 100):
            page.send(type="config", seq=seq)
        while 99 not in answered:
            message = page.next()
            if isinstance(message, dict) and message["type"] in ("config", "response"):
                answered[message["seq"]] = message["type"]
        assert answered[99] == "config"
        assert len(answered) == 100


def test_the_file_of_the_robot_is_shown_while_it_runs_after_it_and_when_it_was_refused(
    web: Web, daemon: Daemon
) -> None:
    def shown(page: Page) -> tuple[str, str]:
        page.send(type="config", seq=1)
        told = page.wait("config")
        return told["of"], told["config"]["text"]

    first = daemon.config.read_text()
    with web.page() as page:
        page.wait("state")
        copy = daemon.run_dir / "host.config"
        assert stat.S_IMODE(copy.stat().st_mode) == 0o640
        # A file that was changed since is not the one that runs.
        daemon.config.write_text(first.replace("id: 2", "id: 1"))
        assert shown(page) == ("running", first)
        daemon.kill()
        page.wait("down")
        assert shown(page) == ("last", first)
        daemon.start()
        assert daemon.program.wait() == 2
        assert shown(page) == ("refused", daemon.config.read_text())
        daemon.config.write_text(first)
        daemon.start()
        daemon.wait_ready()
        page.wait("robot")
        assert shown(page) == ("running", first)
        assert list(daemon.run_dir.glob("*.refused")) == []
        copy.write_text("robot: another\n")
        page.send(type="config", seq=2)
        assert "no copy of its file" in page.wait("response")["message"]


def test_the_schema_and_the_template_are_those_of_rc10d(web: Web) -> None:
    for path, word in (("/rc10d.schema.json", "--schema"), ("/template.yaml", "--init")):
        printed = subprocess.run([BIN / "rc10d", word], capture_output=True, check=True).stdout
        served = web.get(path).read()
        if path.endswith("json"):
            assert json.loads(served) == json.loads(printed)
        else:
            assert served == printed
