"""rc10-web: what a browser, a stranger and a slow reader get from it."""

from __future__ import annotations

import contextlib
import http.client
import json
import math
import os
import re
import socket
import stat
import struct
import subprocess
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from hostlib import Daemon
from hostlib.daemon import BIN
from hostlib.program import PATIENCE_S, Program, eventually
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Origin

# Address of this namespace, and no loopback: a page opened by it seems to be on another computer.
ELSEWHERE = "10.10.10.1"
PAGE = "<!doctype html><title>page</title>"
HEADER = struct.Struct("<BBHIIIdd")
# Nearly as many as rc10-web lets in.
STRANGERS = 60
PIECE = 4
MOST_SIGNALS = 32


@dataclass
class Columns:
    """A binary frame: src/web/columns_frame.hpp."""

    kind: int
    view: int
    first: int
    column_us: float
    least: list[list[float]]
    greatest: list[list[float]]

    @staticmethod
    def read(data: bytes) -> Columns:
        version, kind, signals, count, view, _, first, column_us = HEADER.unpack_from(data)
        assert version == 1
        assert kind != PIECE
        assert len(data) == HEADER.size + signals * count * 8
        values = struct.unpack_from(f"<{signals * count * 2}f", data, HEADER.size)
        rows = [list(values[i * count : (i + 1) * count]) for i in range(2 * signals)]
        return Columns(kind, view, int(first), column_us, rows[0::2], rows[1::2])


class Page:
    """An open page."""

    def __init__(self, connection: ClientConnection) -> None:
        self.connection = connection
        self.seq = 0

    def send(self, **message: object) -> None:
        self.connection.send(json.dumps(message))

    def next(self) -> dict[str, Any] | Columns:
        data = self.connection.recv(timeout=PATIENCE_S)
        if isinstance(data, bytes):
            return Columns.read(data)
        message: dict[str, Any] = json.loads(data)
        return message

    def wait(
        self, kind: str, wanted: Callable[[dict[str, Any]], bool] = lambda _: True
    ) -> dict[str, Any]:
        deadline = time.monotonic() + PATIENCE_S
        while time.monotonic() < deadline:
            message = self.next()
            if isinstance(message, dict) and message["type"] == kind and wanted(message):
                return message
        raise AssertionError(f"no such {kind}")

    def recording(self, name: str) -> bytes:
        """All pieces of a recording, each asked for when the one before has come."""
        self.seq += 1
        self.send(type="recording", number=self.seq, name=name)
        file = bytearray()
        while True:
            data = self.connection.recv(timeout=PATIENCE_S)
            if isinstance(data, str) and json.loads(data)["type"] == "response":
                raise AssertionError(data)
            if isinstance(data, str) or data[1] != PIECE:
                continue
            _, _, _, count, number, _, offset, total = HEADER.unpack_from(data)
            assert number == self.seq
            assert len(data) == HEADER.size + count
            file = file or bytearray(int(total))
            file[int(offset) : int(offset) + count] = data[HEADER.size :]
            if offset == 0:
                return bytes(file)
            self.send(type="piece", number=number)

    def wait_columns(self, view: int) -> Columns:
        while True:
            message = self.next()
            if isinstance(message, Columns) and message.view == view:
                return message

    def ask(self, operation: str, target: str = "", **values: float) -> dict[str, Any]:
        self.seq += 1
        seq = self.seq
        words = {"operation": operation, "target": target, "values": values}
        self.send(type="request", seq=seq, sent_us=time.monotonic_ns() // 1000, **words)
        return self.wait("response", lambda answer: answer["seq"] == seq)


class Web:
    """A running rc10-web."""

    def __init__(self, daemon: Daemon, folder: Path, *words: str) -> None:
        self.folder = folder / "page"
        self.folder.mkdir(exist_ok=True)
        (self.folder / "index.html").write_text(PAGE)
        (self.folder / "studio.js").write_text("1;\n")
        self.program = Program(
            BIN / "rc10-web", "--page", self.folder, "--port", "0", *words, env=daemon.env
        )
        told = self.program.wait_line(r"http://[^:]+:(\d+)/(?:#(\w+))?$")
        self.port = int(told[1])
        self.token = told[2] or ""

    def get(self, path: str = "/", method: str = "GET", **headers: str) -> http.client.HTTPResponse:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE_S)
        connection.request(method, path, headers=headers)
        return connection.getresponse()

    @contextlib.contextmanager
    def page(self, address: str = "127.0.0.1", origin: str | None = None) -> Iterator[Page]:
        # A picture of a big robot is more than the library's bound for a message.
        url = f"ws://{address}:{self.port}/link"
        with connect(
            url, max_size=None, origin=None if origin is None else Origin(origin)
        ) as connection:
            yield Page(connection)


@pytest.fixture
def web(daemon: Daemon, tmp_path: Path) -> Iterator[Web]:
    server = Web(daemon, tmp_path)
    with server.program:
        yield server


def test_it_serves_the_files_of_its_page_and_nothing_else(web: Web) -> None:
    answer = web.get("/")
    assert (answer.status, answer.read().decode()) == (200, PAGE)
    policy = answer.headers["Content-Security-Policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "unsafe" not in policy
    assert answer.headers["X-Content-Type-Options"] == "nosniff"
    # Browsers say so where they honour it: not off loopback without TLS.
    assert answer.headers["Cross-Origin-Opener-Policy"] is None
    honoured = web.get("/", **{"Sec-Fetch-Dest": "document"})
    assert honoured.headers["Cross-Origin-Opener-Policy"] == "same-origin"
    assert web.get("/studio.js").headers["Content-Type"].startswith("text/javascript")
    assert web.get("/studio.js?x=1").status == 200
    for path in (
        "/none",
        "/../page/index.html",
        "/%2e%2e/etc/passwd",
        "//etc/passwd",
        "/link",
        "/index.html/",
    ):
        assert web.get(path).status == 404, path
    assert web.get("/", "HEAD").read() == b""
    assert web.get("/", "POST").status == 405


def test_names_and_pages_of_others_are_refused(web: Web) -> None:
    refused = web.get("/", Host="evil.example")
    assert refused.status == 403
    assert "--name" in refused.read().decode()
    assert web.get("/", Host=f"localhost:{web.port}").status == 200
    with pytest.raises(InvalidStatus), web.page(origin="http://evil.example"):
        pass
    with web.page(origin=f"http://127.0.0.1:{web.port}") as page:
        page.wait("hello")


def test_a_page_sees_the_robot_its_state_and_its_events(web: Web) -> None:
    with web.page() as page:
        assert page.wait("hello")["right"] == "command"
        robot = page.wait("robot")
        assert [motor["name"] for motor in robot["robot"]["motors"]] == ["wheel", "other", "yaw"]
        assert "velocity_rpm" in robot["readings"]
        state = page.wait("state")["data"]
        assert [motor["status"] for motor in state["motors"]] == ["READY"] * 3
        assert [bus["name"] for bus in page.wait("diagnostics")["data"]["buses"]] == [
            "chassis",
            "gimbal",
        ]
        assert page.ask("enable", "wheel")["status"] == "ok"
        event = page.wait("event", lambda e: e["source"] == "wheel" and "ACTIVE" in e["text"])
        assert event["severity"] == "info"
    with web.page() as later:
        later.wait(
            "event", lambda e: e["mono_us"] == event["mono_us"] and e["text"] == event["text"]
        )


def test_what_a_page_asks_for_carries_its_name_and_a_refusal_its_reason(
    web: Web, daemon: Daemon
) -> None:
    with web.page() as page:
        name = page.wait("hello")["name"]
        assert re.fullmatch(r"web-\d+ 127\.0\.0\.1", name)
        assert page.ask("enable", "wheel,other")["status"] == "ok"
        refused = page.ask("enable", "weel")
        assert refused["status"] != "ok"
        assert "weel" in refused["message"]
        assert page.ask("fly")["status"] != "ok"
        assert page.ask("estop")["status"] == "ok"
        stopped = page.wait("state", lambda s: s["data"]["state"] == "ESTOP")["data"]
        assert stopped["stopped_by"] == name
        page.ask("clear")
        page.wait("state", lambda s: s["data"]["state"] == "RUN")
    daemon.wait_state(lambda state: state["state"] == "RUN", "it was cleared")


def test_the_columns_of_a_view_follow_each_other_without_a_gap(web: Web) -> None:
    with web.page() as page:
        page.wait("robot")
        page.send(
            type="view",
            view=5,
            signals=["wheel.velocity_rpm", "nobody.x", "yaw.angle_deg"],
            column_us=1000,
            span_us=0,
        )
        answer = page.wait("view")
        assert answer["signals"] == ["wheel.velocity_rpm", "yaw.angle_deg"]
        assert answer["unknown"] == ["nobody.x"]
        reset = page.wait_columns(5)
        assert reset.kind == 2
        end, filled, columns = None, 0, 0
        while columns < 500:
            frame = page.wait_columns(5)
            assert frame.kind == 1
            if end is not None:
                assert frame.first == end
            end = frame.first + len(frame.least[0])
            columns += len(frame.least[0])
            filled += sum(1 for angle in frame.least[1] if not math.isnan(angle))
        missed = page.wait("diagnostics")["data"]["missed_ticks"]
        # Each tick is in a column; one column may hold two, when a tick is late, and the next none.
        assert filled >= columns - missed - columns // 4
        # All that was seen can be looked at again, in any width.
        assert end is not None
        page.send(type="range", first_column=(end - 400) // 8, column_us=8000, count=50)
        past = next(f for f in iter(lambda: page.wait_columns(5), None) if f.kind == 3)
        assert len(past.least[1]) == 50
        assert sum(1 for angle in past.least[1] if not math.isnan(angle)) > 25


def test_a_page_is_told_which_signals_find_no_room_beside_those_of_the_others(web: Web) -> None:
    with web.page() as page, web.page() as other:
        robot = page.wait("robot")
        signals = [f"{m['name']}.{r}" for m in robot["robot"]["motors"] for r in robot["readings"]]
        first, rest = signals[:MOST_SIGNALS], signals[MOST_SIGNALS:]
        assert rest != []
        page.send(type="view", view=1, signals=first, column_us=1000, span_us=0)
        assert page.wait("view")["signals"] == first
        other.send(type="view", view=1, signals=[first[0], rest[0]], column_us=1000, span_us=0)
        answer = other.wait("view")
        assert (answer["signals"], answer["unknown"]) == ([first[0]], [rest[0]])
        # As soon as the other lets one go, there is room for one.
        page.send(type="view", view=2, signals=first[:-1], column_us=1000, span_us=0)
        page.wait("view")
        other.send(type="view", view=2, signals=rest[:2], column_us=1000, span_us=0)
        answer = other.wait("view")
        assert (answer["signals"], answer["unknown"]) == ([rest[0]], [rest[1]])


def test_a_page_from_elsewhere_needs_the_token_looks_and_stops(
    daemon: Daemon, tmp_path: Path
) -> None:
    subprocess.run(["ip", "address", "replace", f"{ELSEWHERE}/32", "dev", "lo"], check=True)
    server = Web(daemon, tmp_path, "--listen", "0.0.0.0", "--token-file", str(tmp_path / "token"))
    with server.program:
        assert stat.S_IMODE(os.stat(tmp_path / "token").st_mode) == 0o600
        assert (tmp_path / "token").read_text().strip() == server.token
        assert len(server.token) == 32
        with server.page(ELSEWHERE) as page:
            assert page.wait("hello")["right"] == "nothing"
            assert page.ask("enable")["message"] == "show the token first"
            page.send(type="view", view=1, signals=["wheel.target"], column_us=1000, span_us=0)
            assert page.wait("response")["status"] == "refused"
            page.send(type="recording", number=1, name="host.blackbox")
            assert page.wait("response")["message"] == "show the token first"
            for kind in ("config", "config_check"):
                page.send(type=kind, seq=1, text="robot: host\n")
                assert page.wait("response")["message"] == "show the token first"
            page.send(type="token", token="a" * 32)
            assert page.wait("hello")["right"] == "nothing"
            page.send(type="token", token=server.token)
            assert page.wait("hello")["right"] == "look"
            page.wait("state")
            assert "tunnel" in page.ask("enable")["message"]
            assert page.recording("host.blackbox").startswith(b"RC10BOX1")
            # Looking is enough to read and to check.
            page.send(type="config", seq=7)
            assert page.wait("config")["config"]["text"] == daemon.config.read_text()
            page.send(type="config_check", seq=8, text=daemon.config.read_text())
            assert page.wait("config_checked")["checked"]["robot"]["name"] == "host"
        # An e-stop needs no right, and no readable message.
        with server.page(ELSEWHERE) as page:
            page.wait("hello")
            page.connection.send('{"type": "request", "operation": "estop", "seq": ')
            daemon.wait_state(lambda state: state["state"] == "ESTOP", "it is stopped")
        with server.page() as page:
            assert page.wait("hello")["right"] == "command"


def test_a_page_gets_the_recording_of_the_robot_that_runs_and_of_the_one_that_has_ended(
    web: Web, daemon: Daemon, tmp_path: Path
) -> None:
    daemon.must("enable", "wheel")

    def events(name: str, page: Page) -> list[str]:
        (tmp_path / "got.blackbox").write_bytes(page.recording(name))
        lines = map(
            json.loads, daemon.must("blackbox", tmp_path / "got.blackbox", "--json").splitlines()
        )
        return [line["text"] for line in lines if line["kind"] == "event"]

    with web.page() as page:
        page.send(type="recordings", seq=3)
        told = page.wait("recordings")
        assert (told["seq"], [file["name"] for file in told["recordings"]]) == (
            3,
            ["host.blackbox"],
        )
        assert told["recordings"][0]["live"] is True
        assert "ENABLING -> ACTIVE" in events("host.blackbox", page)
        daemon.kill()
        assert "ENABLING -> ACTIVE" in events("host.blackbox", page)
        for name in ("../host.blackbox", "robot.yaml", "host.sock"):
            page.send(type="recording", number=99, name=name)
            refused = page.wait("response")
            assert (refused["status"], refused["seq"]) == ("failed", 99)
            assert "no such recording" in refused["message"]


def test_numbers_of_a_recording_come_back_in_words(web: Web) -> None:
    layout = json.loads(web.get("/recording-format.json").read())
    assert layout["magic"] == "RC10BOX1"
    with web.page() as page:
        page.send(
            type="words",
            seq=4,
            events=[[201, 7, 0, ""], [104, 0, 0, "\x1b[31m"], [9999, 1, 2, ""]],
            buses=[["M3508"], []],
            frames=[
                [0, True, "200#2000F00000004000"],
                [1, True, "200#2000F00000004000"],
                [0, False, "x"],
            ],
        )
        words = page.wait("words")
    assert words["seq"] == 4
    assert words["events"][0] == "7 ticks missed"
    assert words["events"][2] == "event 9999"
    assert words["frames"] == ["DJI command of 1 to 4: 10 A, -5 A, 0 A, 20 A", "", ""]


def test_it_lives_when_rc10d_ends_says_so_and_finds_it_again(web: Web, daemon: Daemon) -> None:
    with web.page() as page:
        page.wait("state")
        daemon.kill()
        assert "rc10d" in page.wait("down")["reason"]
        assert page.ask("enable")["status"] == "refused"
        with web.page() as other:
            assert "rc10d" in other.wait("down")["reason"]
        daemon.start()
        daemon.wait_ready()
        page.wait("robot")
        page.send(type="view", view=9, signals=["wheel.velocity_rpm"], column_us=1000, span_us=0)
        assert page.wait("view")["signals"] == ["wheel.velocity_rpm"]
        assert page.ask("enable", "wheel")["status"] == "ok"


def test_while_rc10d_is_down_its_last_words_and_the_mistakes_of_its_file_are_told(
    web: Web, daemon: Daemon
) -> None:
    with web.page() as page:
        page.wait("state")
        daemon.kill()
        down = page.wait("down", lambda told: "robot 'host' runs" in told["log"])
        assert down["refusal"] == ""
        sound = daemon.config.read_text()
        daemon.config.write_text(sound.replace("id: 2", "id: 1"))
        check = subprocess.run(
            [BIN / "rc10d", "--check", daemon.config], capture_output=True, text=True
        )
        daemon.start()
        assert daemon.program.wait() == 2
        down = page.wait("down", lambda told: told["refusal"] != "")
        assert down["refusal"] == check.stderr
        assert "robot 'host' runs" in down["log"]
        # A page that comes later is told the same.
        with web.page() as later:
            assert later.wait("down")["refusal"] == check.stderr
        daemon.config.write_text(sound)
        daemon.start()
        daemon.wait_ready()
        page.wait("robot")
        daemon.program.stop()
        down = page.wait("down", lambda told: "stopping" in told["log"])
        assert down["refusal"] == ""


def test_a_second_rc10d_of_a_robot_leaves_the_log_of_the_first_alone(daemon: Daemon) -> None:
    log = daemon.run_dir / "host.log"
    before = log.stat().st_ino
    second = Program(BIN / "rc10d", "-c", daemon.config, env=daemon.env)
    assert second.wait() == 1
    assert log.stat().st_ino == before
    assert "already has a running rc10d" in (daemon.run_dir / "robot.refusal").read_text()
    # Nor does a check leave anything.
    (daemon.run_dir / "robot.refusal").unlink()
    subprocess.run([BIN / "rc10d", "--check", "/dev/null"], env={**os.environ, **daemon.env})
    assert list(daemon.run_dir.glob("*.refusal")) == []


def test_what_is_no_message_is_refused_and_what_is_too_large_ends_the_page(web: Web) -> None:
    with web.page() as page:
        page.wait("hello")
        for junk in ("", "{", "[]", "null", '{"type": 5}', "\x00\x01", "[" * 10_000):
            page.connection.send(junk)
            assert page.wait("response")["status"] == "refused"
        page.connection.send(b"\xff\xfe" * 100)
        assert page.wait("response")["status"] == "refused"
        page.connection.send("x" * 300_000)
        with pytest.raises(ConnectionClosed):
            page.wait("never")
    for junk_bytes in (
        b"\x00" * 64,
        b"GET / HTTP/9.9\r\n\r\n",
        b"GET " + b"a" * 20_000,
        b"\r\n" * 50,
    ):
        with socket.create_connection(("127.0.0.1", web.port)) as raw:
            raw.sendall(junk_bytes)
            raw.settimeout(PATIENCE_S)
            with contextlib.suppress(ConnectionError):
                while raw.recv(4096):
                    pass
    assert web.get("/").status == 200


def resident_kib(pid: int, which: str = "VmRSS") -> int:
    status = Path(f"/proc/{pid}/status").read_text()
    found = re.search(rf"{which}:\s+(\d+) kB", status)
    assert found is not None
    return int(found[1])


def peak_resident_kib(pid: int) -> int:
    return resident_kib(pid, "VmHWM")


def open_and_never_read(port: int, message: str) -> socket.socket:
    """A page whose buffers are small: it says one thing and reads nothing any more."""
    page = socket.socket()
    page.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    page.connect(("127.0.0.1", port))
    page.sendall(
        b"GET /link HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        b"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    )
    assert page.recv(12) == b"HTTP/1.1 101"
    text = message.encode()
    # A text frame with a length of 16 bits, masked by zeros.
    page.sendall(b"\x81\xfe" + len(text).to_bytes(2, "big") + bytes(4) + text)
    return page


def test_a_page_that_does_not_read_slows_nobody_and_takes_bounded_room(web: Web) -> None:
    readings = ["target", "velocity_rpm", "current_a", "angle_deg", "total_angle_deg", "torque_nm"]
    signals = [f"{motor}.{name}" for motor in ("wheel", "other", "yaw") for name in readings]
    view = {"type": "view", "view": 1, "signals": signals, "column_us": 100, "span_us": 0}
    with open_and_never_read(web.port, json.dumps(view)), web.page() as quick:
        quick.wait("robot")
        quick.send(**{**view, "view": 2, "column_us": 1000})
        quick.wait("view")
        seen = 0
        while seen < 3000:
            seen += len(quick.wait_columns(2).least[0])
        assert resident_kib(web.program.pid) < 64 * 1024


def test_strangers_that_do_not_read_take_bounded_room_together(web: Web) -> None:
    # Short, and answered each time with all that a page needs for its first picture.
    text = b'{"type":"token"}'
    question = bytes((0x81, 0x80 | len(text))) + bytes(4) + text
    with contextlib.ExitStack() as strangers, web.page() as page:
        page.wait("state")
        opened = [
            strangers.enter_context(open_and_never_read(web.port, "x" * 126))
            for _ in range(STRANGERS)
        ]
        # In turns, until each is given up: what the kernel keeps for it is full before.
        while opened:
            for stranger in list(opened):
                try:
                    stranger.sendall(question * 1000)
                except ConnectionError:
                    opened.remove(stranger)
        assert page.ask("enable", "wheel")["status"] == "ok"
        assert peak_resident_kib(web.program.pid) < 64 * 1024


def test_connections_are_bounded_and_their_places_come_back(web: Web) -> None:
    open_sockets = [socket.create_connection(("127.0.0.1", web.port)) for _ in range(80)]
    # Those beyond the bound are closed at once.
    eventually(lambda: sum(is_closed(s) for s in open_sockets) == 80 - 64, "the surplus is closed")
    for one in open_sockets:
        one.close()
    eventually(lambda: answers(web), "there is room again")


def is_closed(one: socket.socket) -> bool:
    try:
        return one.recv(1, socket.MSG_DONTWAIT | socket.MSG_PEEK) == b""
    except BlockingIOError:
        return False
    except ConnectionError:
        return True


def answers(web: Web) -> bool:
    try:
        return web.get("/").status == 200
    except (OSError, http.client.HTTPException):
        return False


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--page", "/nowhere"), "scripts/web.sh"),
        (("--listen", "203.0.113.9", "--token-file", "{folder}/token"), "--listen"),
        (("--port", "70000"), "port"),
        (("--listen", "0.0.0.0", "--token-file", "/proc/none"), "--token-file"),
    ],
)
def test_what_cannot_be_is_said_with_the_remedy(
    tmp_path: Path, words: tuple[str, ...], said: str
) -> None:
    (tmp_path / "index.html").write_text(PAGE)
    page = () if "--page" in words else ("--page", str(tmp_path))
    done = subprocess.run(
        [BIN / "rc10-web", *page, *(word.format(folder=tmp_path) for word in words)],
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert done.returncode != 0
    assert said in done.stderr


def test_a_token_that_others_can_read_is_refused(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text(PAGE)
    token = tmp_path / "token"
    token.write_text("a" * 32 + "\n")
    token.chmod(0o644)
    words = ("--page", str(tmp_path), "--listen", "0.0.0.0", "--token-file", str(token))
    done = subprocess.run(
        [BIN / "rc10-web", *words], capture_output=True, text=True, timeout=PATIENCE_S
    )
    assert done.returncode == 1
    assert "chmod 600" in done.stderr
    assert "a" * 32 not in done.stderr
