"""Calls from one program to another: a request of one LCM type, an answer of another."""

from __future__ import annotations

import struct
import time
from collections import OrderedDict
from typing import TYPE_CHECKING, Any, Callable, Generic, TypeVar

from rc10.errors import ServiceFailed, ServiceRefused, ServiceTimeout
from rc10.identity import Identity, client_name
from rc10.lcm_types.service_request_t import service_request_t
from rc10.lcm_types.service_response_t import service_response_t

if TYPE_CHECKING:
    from rc10.link import Link

RequestT = TypeVar("RequestT")
ResponseT = TypeVar("ResponseT")

_QUEUE = 100
_REMEMBERED = 64


class ServiceServer(Generic[RequestT, ResponseT]):
    """Answers calls of one service while the link is pumped: by spin(), rate() or a request.

    A call that comes again is answered again and not carried out again; the last 64 answers are
    remembered. One that may have waited for longer than its client does, while the program was busy
    with something else, is refused: receive more often than that. The channels are
    `<name>.request` and `<name>.response`.

    Args:
        link: Robot.link, or an LcmLink of your own.
        name: of the service.
        request_type: the class that lcm-gen made, of what is asked.
        response_type: of what is answered.
        handler: carries a call out. An exception is the answer "failed", in its words.
    """

    def __init__(
        self,
        link: Link,
        name: str,
        request_type: type[RequestT],
        response_type: type[ResponseT],
        handler: Callable[[RequestT], ResponseT],
    ) -> None:
        self.name = name
        self._link = link
        self._request_type: Any = request_type
        self._types = (fingerprint(request_type), fingerprint(response_type))
        self._handler = handler
        self._answers: OrderedDict[tuple[str, int, int], bytes] = OrderedDict()
        self._began_s = link.now()
        link.subscribe(f"{name}.request", self._on_request, _QUEUE)

    def _on_request(self, data: bytes) -> None:
        try:
            request = service_request_t.decode(data)
        except (ValueError, struct.error):
            return  # the client's own time-out tells it what to check
        call = (request.client, request.session, request.seq)
        if call not in self._answers:
            self._answers[call] = self._answer(request).encode()
            while len(self._answers) > _REMEMBERED:
                self._answers.popitem(last=False)
        self._link.publish(f"{self.name}.response", self._answers[call])

    def _answer(self, request: service_request_t) -> service_response_t:
        answer = service_response_t()
        answer.utime = time.time_ns() // 1000
        answer.client = request.client
        answer.session = request.session
        answer.seq = request.seq
        if (request.request_type, request.response_type) != self._types:
            answer.status = service_response_t.STATUS_REFUSED
            answer.message = (
                f"client and server were built with other definitions of the types of '{self.name}'"
            )
            return answer
        if self._is_late(request):
            answer.status = service_response_t.STATUS_REFUSED
            answer.message = (
                "too late: it may have waited here for longer than its client waits"
                " (does the server receive often enough?)"
            )
            return answer
        try:
            result: Any = self._handler(self._request_type.decode(request.payload))
            answer.payload = result.encode()
        except Exception as error:  # noqa: BLE001  # the caller is told, whatever it is
            answer.status = service_response_t.STATUS_FAILED
            answer.message = str(error) or type(error).__name__
        answer.size = len(answer.payload)
        return answer

    def _is_late(self, request: service_request_t) -> bool:
        """Whether it may have come so long ago that nobody waits for its answer any more."""
        came_s: float = max(self._link.empty_s(), self._began_s)  # at the earliest
        return self._link.now() - came_s > request.timeout_ms / 1000


class ServiceClient(Generic[RequestT, ResponseT]):
    """Calls one service.

    Args:
        link: Robot.link, or an LcmLink of your own.
        name: of the service.
        request_type: the class that lcm-gen made, of what is asked.
        response_type: of what is answered.
        client: shown to the server; None for the program's name.
    """

    def __init__(
        self,
        link: Link,
        name: str,
        request_type: type[RequestT],
        response_type: type[ResponseT],
        client: str | None = None,
    ) -> None:
        self.name = name
        self._link = link
        self._response_type: Any = response_type
        self._types = (fingerprint(request_type), fingerprint(response_type))
        self._identity = Identity(client_name(client))
        self._open: int | None = None
        self._answer: service_response_t | None = None
        self._foreign = False
        link.subscribe(f"{name}.response", self._on_response, _QUEUE)

    def call(self, request: RequestT, timeout_s: float = 1.0, repeat_s: float = 0.1) -> ResponseT:
        """Calls and waits for the answer, receiving meanwhile; not in a callback.

        Args:
            request: what is asked.
            timeout_s: how long to wait.
            repeat_s: how often to send it again, under the same number: it is carried out once.

        Raises:
            ServiceTimeout: no answer; the message says what to check.
            ServiceRefused: not tried, in the server's words.
            ServiceFailed: tried, in the server's words.
        """
        payload: Any = request
        message = service_request_t()
        self._identity.sign(message)
        message.timeout_ms = round(timeout_s * 1000)
        message.request_type, message.response_type = self._types
        message.payload = payload.encode()
        message.size = len(message.payload)
        self._open, self._answer = message.seq, None
        data = message.encode()
        deadline_s = self._link.now() + timeout_s
        while self._answer is None and self._link.now() < deadline_s:
            self._link.publish(f"{self.name}.request", data)
            again_s = min(self._link.now() + repeat_s, deadline_s)
            while self._answer is None and (left_s := again_s - self._link.now()) > 0:
                self._link.pump(left_s)
        self._open = None
        return self._take(self._answer, timeout_s)

    def _take(self, answer: service_response_t | None, timeout_s: float) -> ResponseT:
        if answer is None and self._foreign:
            raise ServiceTimeout(
                f"messages with other definitions arrive on {self.name}.response: "
                "both programs need the same rc10"
            )
        if answer is None:
            raise ServiceTimeout(
                f"no answer from service '{self.name}' within {timeout_s:g} s: is the program that "
                "serves it running, and does it use the same LCM address? Or does its handler take "
                "longer?"
            )
        if answer.status == service_response_t.STATUS_REFUSED:
            raise ServiceRefused(f"service '{self.name}' refused: {answer.message}")
        if answer.status != service_response_t.STATUS_OK:
            raise ServiceFailed(f"service '{self.name}' failed: {answer.message}")
        try:
            response: ResponseT = self._response_type.decode(answer.payload)
        except (ValueError, struct.error):
            raise ServiceFailed(
                f"service '{self.name}': the answer is of another type or of other definitions"
            ) from None
        return response

    def _on_response(self, data: bytes) -> None:
        try:
            answer = service_response_t.decode(data)
        except (ValueError, struct.error):
            self._foreign = True
            return
        # All clients of the service hear all answers.
        if (answer.client, answer.session, answer.seq) == (
            self._identity.client,
            self._identity.session,
            self._open,
        ):
            self._answer = answer


def fingerprint(kind: type) -> int:
    """The number by which LCM knows a type, as an envelope carries it."""
    generated: Any = kind
    return int.from_bytes(generated._get_packed_fingerprint(), "big", signed=True)
