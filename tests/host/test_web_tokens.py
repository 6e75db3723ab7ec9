"""Tokens that pages of other computers show to rc10-web."""

from __future__ import annotations

import contextlib
import subprocess
import time
from typing import TYPE_CHECKING

from test_web import ELSEWHERE, Web

if TYPE_CHECKING:
    from pathlib import Path

    from hostlib import Daemon


def test_wrong_tokens_of_all_pages_together_are_judged_one_after_another(
    daemon: Daemon, tmp_path: Path
) -> None:
    subprocess.run(["ip", "address", "replace", f"{ELSEWHERE}/32", "dev", "lo"], check=True)
    server = Web(daemon, tmp_path, "--listen", "0.0.0.0", "--token-file", str(tmp_path / "token"))
    with server.program, contextlib.ExitStack() as opened:
        pages = [opened.enter_context(server.page(ELSEWHERE)) for _ in range(6)]
        for page in pages:
            assert page.wait("hello")["right"] == "nothing"
        begin_s = time.monotonic()
        for page in pages[:5]:
            page.send(type="token", token="a" * 32)
        for page in pages[:5]:
            assert page.wait("hello")["right"] == "nothing"
        pages[5].send(type="token", token=server.token)
        assert pages[5].wait("hello")["right"] == "look"
        # A pause after each of the five; a pause of this computer makes it longer, never shorter.
        assert time.monotonic() - begin_s >= 5 * 0.2
        # One that is overtaken has its answer, too; a longer one is wrong.
        pages[0].send(type="token", token="b" * 100_000)
        pages[0].send(type="token", token="c")
        pages[0].send(type="token", token=server.token)
        told = [pages[0].wait("hello")["right"] for _ in range(3)]
        assert told == ["nothing", "nothing", "look"]
