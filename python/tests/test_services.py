from __future__ import annotations

import pytest

import rc10
from rc10.lcm_types import counter_t, named_value_t, service_request_t, service_response_t
from rc10.services import fingerprint
from virtual_link import VirtualLink


def counter(count: int) -> counter_t:
    message = counter_t()
    message.count = count
    return message


class Doubler:
    """The service of the tests."""

    def __init__(self, link: VirtualLink) -> None:
        self.calls = 0
        self.server = rc10.ServiceServer(link, "double", counter_t, named_value_t, self.handle)

    def handle(self, request: counter_t) -> named_value_t:
        self.calls += 1
        if request.count < 0:
            raise ValueError("it is negative")
        answer = named_value_t()
        answer.value = 2.0 * request.count
        return answer


@pytest.fixture
def doubler(link: VirtualLink) -> Doubler:
    return Doubler(link)


@pytest.fixture
def client(link: VirtualLink) -> rc10.ServiceClient[counter_t, named_value_t]:
    return rc10.ServiceClient(link, "double", counter_t, named_value_t, client="tester")


def test_a_service_answers(
    doubler: Doubler, client: rc10.ServiceClient[counter_t, named_value_t]
) -> None:
    assert [client.call(counter(n)).value for n in (1, 2, 3)] == [2.0, 4.0, 6.0]
    assert doubler.calls == 3


@pytest.mark.usefixtures("doubler")
def test_a_failure_has_the_words_of_the_server(
    client: rc10.ServiceClient[counter_t, named_value_t],
) -> None:
    with pytest.raises(rc10.ServiceFailed, match="service 'double' failed: it is negative"):
        client.call(counter(-1))


@pytest.mark.usefixtures("doubler")
def test_a_program_with_a_long_name_is_a_client_all_the_same(
    link: VirtualLink, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["/opt/robot/drives_the_chassis_to_the_next_dock.py"])
    client = rc10.ServiceClient(link, "double", counter_t, named_value_t)
    assert client.call(counter(2)).value == 4.0


def test_no_answer_says_what_to_check(
    client: rc10.ServiceClient[counter_t, named_value_t], link: VirtualLink
) -> None:
    before_s = link.now()
    with pytest.raises(rc10.ServiceTimeout, match=r"within 0\.5 s: is the program"):
        client.call(counter(1), timeout_s=0.5)
    assert link.now() - before_s == pytest.approx(0.5)


def test_a_call_is_repeated_and_carried_out_once(
    doubler: Doubler, client: rc10.ServiceClient[counter_t, named_value_t], link: VirtualLink
) -> None:
    heard: list[bytes] = []
    link.subscribe("double.request", heard.append, 100)
    client.call(counter(4))
    link.publish("double.request", heard[0])
    answers: list[bytes] = []
    link.subscribe("double.response", answers.append, 100)
    link.pump(0.0)
    assert len(answers) == 1
    assert doubler.calls == 1


def test_a_lost_call_is_sent_again(
    client: rc10.ServiceClient[counter_t, named_value_t], link: VirtualLink
) -> None:
    late: list[Doubler] = []
    link.after(0.25, lambda: late.append(Doubler(link)))
    assert client.call(counter(4)).value == 8.0


@pytest.mark.usefixtures("doubler")
def test_other_types_are_refused_in_words(link: VirtualLink) -> None:
    other = rc10.ServiceClient(link, "double", named_value_t, named_value_t)
    with pytest.raises(rc10.ServiceRefused, match="other definitions of the types of 'double'"):
        other.call(named_value_t())


def test_the_answer_to_another_client_is_not_ours(
    doubler: Doubler, client: rc10.ServiceClient[counter_t, named_value_t], link: VirtualLink
) -> None:
    other = rc10.ServiceClient(link, "double", counter_t, named_value_t, client="other")
    assert other.call(counter(1)).value == 2.0
    assert client.call(counter(2)).value == 4.0
    assert doubler.calls == 2


def test_garbage_is_ignored(
    doubler: Doubler, client: rc10.ServiceClient[counter_t, named_value_t], link: VirtualLink
) -> None:
    link.publish("double.request", b"garbage")
    link.publish("double.request", service_request_t().encode()[:-3])
    assert client.call(counter(2)).value == 4.0
    assert doubler.calls == 1


def test_an_envelope_carries_the_fingerprints_of_the_types(
    client: rc10.ServiceClient[counter_t, named_value_t], link: VirtualLink
) -> None:
    heard: list[service_request_t] = []
    rc10.Subscriber(link, "double.request", service_request_t, heard.append)
    with pytest.raises(rc10.ServiceTimeout):
        client.call(counter(1), timeout_s=0.05)
    first = heard[0].payload[:8]
    assert (
        heard[0].request_type.to_bytes(8, "big", signed=True) == first == counter_t().encode()[:8]
    )


def ask(link: VirtualLink, number: int, timeout_ms: int = 500) -> None:
    """Sends a call, and does not wait for its answer."""
    request = service_request_t()
    request.client, request.session, request.seq = "tester", 7, number
    request.timeout_ms = timeout_ms
    request.request_type = fingerprint(counter_t)
    request.response_type = fingerprint(named_value_t)
    request.payload = counter(number).encode()
    request.size = len(request.payload)
    link.publish("double.request", request.encode())


@pytest.fixture
def answers(link: VirtualLink) -> list[tuple[int, int, str]]:
    """Number, status and words of what was answered."""
    heard: list[tuple[int, int, str]] = []

    def on_answer(data: bytes) -> None:
        answer = service_response_t.decode(data)
        heard.append((answer.seq, answer.status, answer.message))

    link.subscribe("double.response", on_answer, 100)
    return heard


TOO_LATE = (
    "too late: it may have waited here for longer than its client waits"
    " (does the server receive often enough?)"
)


def late(number: int) -> tuple[int, int, str]:
    return number, service_response_t.STATUS_REFUSED, TOO_LATE


def done(number: int) -> tuple[int, int, str]:
    return number, service_response_t.STATUS_OK, ""


def test_a_call_that_nobody_waits_for_any_more_is_refused(
    doubler: Doubler, link: VirtualLink, answers: list[tuple[int, int, str]]
) -> None:
    link.pump(0.0)
    link.after(1.0, lambda: ask(link, 1))
    link.after(1.1, lambda: ask(link, 1))
    link.pass_time(8.0)  # busy, and does not receive
    link.pump(0.0)
    assert doubler.calls == 0
    assert answers == [late(1), late(1)]
    # Sent while it receives, the next one is carried out.
    link.after(3.0, lambda: ask(link, 2))
    link.pump(5.0)
    link.pump(0.0)
    assert answers[2:] == [done(2)]


def test_a_call_that_waited_while_another_was_carried_out_is_refused(
    link: VirtualLink, answers: list[tuple[int, int, str]]
) -> None:
    def slowly(request: counter_t) -> named_value_t:
        link.pass_time(8.0)
        answer = named_value_t()
        answer.value = float(request.count)
        return answer

    server = rc10.ServiceServer(link, "double", counter_t, named_value_t, slowly)
    link.pump(0.0)
    ask(link, 1)
    ask(link, 2)
    ask(link, 3, timeout_ms=20_000)
    link.pump(0.0)
    assert server.name == "double"
    assert answers == [done(1), late(2), done(3)]


def test_a_call_that_came_while_the_program_was_stopped_in_its_sleep_is_refused(
    doubler: Doubler, link: VirtualLink, answers: list[tuple[int, int, str]]
) -> None:
    def stopped() -> None:  # Ctrl-Z
        ask(link, 1)
        link.time_s += 8.0

    link.after(0.1, stopped)
    link.pump(5.0)
    link.pump(0.0)
    assert doubler.calls == 0
    assert answers == [late(1)]


def test_a_call_within_its_time_is_carried_out_though_the_program_was_away(
    link: VirtualLink, answers: list[tuple[int, int, str]]
) -> None:
    link.pass_time(60.0)
    doubler = Doubler(link)  # before that it heard no call
    link.after(0.2, lambda: ask(link, 1))
    link.pass_time(0.4)
    link.pump(0.0)
    link.pump(0.0)
    assert doubler.calls == 1
    assert answers == [done(1)]


def test_a_call_that_was_carried_out_is_answered_again_however_late(
    doubler: Doubler, link: VirtualLink, answers: list[tuple[int, int, str]]
) -> None:
    ask(link, 1)
    link.pump(0.0)
    ask(link, 1)
    link.pass_time(8.0)
    link.pump(0.0)
    link.pump(0.0)
    assert doubler.calls == 1
    assert answers == [done(1), done(1)]
