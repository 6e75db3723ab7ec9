"""Stands for the root helper: systemd's socket, and an answer to each request."""

from __future__ import annotations

import socket
import threading
from dataclasses import dataclass
from pathlib import Path
from typing import Self


@dataclass
class FileRequest:
    verb: str
    robot: str
    replaces: str
    text: str


class FileHelper:
    def __init__(self, path: Path) -> None:
        self.path = path
        self.requests: list[FileRequest] = []
        self.answer = "done\nwritten"
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._listener.bind(str(path))
        self._listener.listen(4)
        self._thread = threading.Thread(target=self._serve)

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        # Ends accept().
        self._listener.shutdown(socket.SHUT_RDWR)
        self._thread.join()
        self._listener.close()

    def answer_to(self, request: FileRequest) -> str:  # noqa: ARG002
        """The same to each; one that does what it is asked has others."""
        return self.answer

    def _serve(self) -> None:
        while True:
            try:
                connection, _ = self._listener.accept()
            except OSError:
                return
            with connection:
                head, text = connection.recv(200_000).decode().split("\n", 1)
                verb, robot, replaces = head.split(" ")
                self.requests.append(FileRequest(verb, robot, replaces, text))
                connection.send(self.answer_to(self.requests[-1]).encode())
