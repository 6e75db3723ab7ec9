"""Where a stream goes."""

from __future__ import annotations

import socket
from urllib.parse import urlsplit

from rc10.errors import Rc10Error


class UdpTarget:
    """Sends datagrams to one address; use it in a `with` statement.

    Args:
        url: `udp://HOST:PORT`.

    Raises:
        Rc10Error: it is no such URL, or the host is not known.
    """

    def __init__(self, url: str) -> None:
        parts = urlsplit(url)
        try:
            host, port = parts.hostname, parts.port
        except ValueError:
            host = port = None
        if parts.scheme != "udp" or not host or not port or parts.path not in ("", "/"):
            raise Rc10Error(f"{url!r} is no target: write udp://HOST:PORT")
        try:
            family, kind, protocol, _, address = socket.getaddrinfo(
                host, port, type=socket.SOCK_DGRAM
            )[0]
        except OSError as error:
            raise Rc10Error(f"{url}: {error.strerror or error}") from None
        self._address = address
        self._socket = socket.socket(family, kind, protocol)
        self.refused = 0
        """Datagrams that the system did not take."""

    def __enter__(self) -> UdpTarget:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def send(self, data: bytes) -> None:
        """Sends a datagram; that nobody listens, or that the network is gone, is no error."""
        try:
            self._socket.sendto(data, self._address)
        except OSError:
            self.refused += 1
