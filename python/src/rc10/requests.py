"""Requests to the daemon and their answers."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

from rc10.errors import RequestFailed, RequestRefused
from rc10.lcm_types.named_value_t import named_value_t
from rc10.lcm_types.request_t import request_t
from rc10.lcm_types.response_t import response_t

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rc10.decoder import Decoder
    from rc10.identity import Identity
    from rc10.link import Link

_RESPONSE_QUEUE = 100


@dataclass(frozen=True)
class Response:
    """The daemon's answer to a request that it has carried out."""

    message: str
    """In words; may be empty."""
    values: Mapping[str, float]
    """Named with their units."""


class Request:
    """One request under one number: published as often as it takes, carried out once."""

    def __init__(self, link: Link, channel: str, message: request_t) -> None:
        self.operation: str = message.operation
        self.target: str = message.target
        self.seq: int = message.seq
        self.answer: response_t | None = None
        self._link = link
        self._channel = channel
        self._data: bytes = message.encode()

    def publish(self) -> None:
        """Sends it, or sends it again."""
        self._link.publish(self._channel, self._data)

    def response(self) -> Response | None:
        """Returns the answer, None as long as there is none.

        Raises:
            RequestRefused, RequestFailed: in the daemon's words.
        """
        if self.answer is None:
            return None
        if self.answer.status == response_t.STATUS_REFUSED:
            raise RequestRefused(self.operation, self.target, self.answer.message)
        if self.answer.status != response_t.STATUS_OK:
            raise RequestFailed(self.operation, self.target, self.answer.message)
        values = {value.name: value.value for value in self.answer.values}
        return Response(self.answer.message, MappingProxyType(values))


class Requests:
    """Numbers requests and hands the answers to those that are open."""

    def __init__(self, robot: str, link: Link, decoder: Decoder, identity: Identity) -> None:
        self._link = link
        self._decoder = decoder
        self._identity = identity
        self._request_channel = f"{robot}.v1.request"
        self._response_channel = f"{robot}.v1.response"
        self._open: dict[int, Request] = {}
        link.subscribe(self._response_channel, self._on_response, _RESPONSE_QUEUE)

    @contextmanager
    def open(self, operation: str, target: str, values: Mapping[str, float]) -> Iterator[Request]:
        """Makes a request, without sending it, that waits for its answer in a `with` block."""
        message = request_t()
        self._identity.sign(message)
        message.operation = operation
        message.target = target
        message.value_count = len(values)
        for name, number in values.items():
            value = named_value_t()
            value.name = name
            value.value = float(number)
            message.values.append(value)
        request = Request(self._link, self._request_channel, message)
        self._open[request.seq] = request
        try:
            yield request
        finally:
            del self._open[request.seq]

    def _on_response(self, data: bytes) -> None:
        # All clients of the robot hear all answers.
        answer = self._decoder.decode(self._response_channel, response_t.decode, lambda m: m, data)
        if (
            answer is not None
            and answer.session == self._identity.session
            and answer.client == self._identity.client
            and (request := self._open.get(answer.seq)) is not None
            and request.answer is None
        ):
            request.answer = answer
