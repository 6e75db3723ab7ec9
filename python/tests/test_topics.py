from __future__ import annotations

import pytest

import rc10
from rc10.lcm_types import counter_t, named_value_t
from virtual_link import VirtualLink


def counter(count: int) -> counter_t:
    message = counter_t()
    message.name = "n"
    message.count = count
    return message


def test_a_callback_gets_every_message(link: VirtualLink) -> None:
    seen: list[int] = []
    rc10.Subscriber(link, "a.b", counter_t, lambda message: seen.append(message.count))
    publisher = rc10.Publisher(link, "a.b", counter_t)
    for count in (1, 2, 3):
        publisher.publish(counter(count))
    link.pump(0.0)
    assert seen == [1, 2, 3]


def test_the_latest_comes_with_its_age(link: VirtualLink) -> None:
    subscriber = rc10.Subscriber(link, "a", counter_t)
    assert subscriber.latest is None
    rc10.Publisher(link, "a", counter_t).publish(counter(7))
    link.pump(0.0)
    link.pass_time(0.25)
    assert subscriber.latest is not None
    assert subscriber.latest.message.count == 7
    assert subscriber.latest.age_s == pytest.approx(0.25)
    assert subscriber.count == 1


def test_messages_of_another_type_are_counted(link: VirtualLink) -> None:
    subscriber = rc10.Subscriber(link, "a", counter_t)
    rc10.Publisher(link, "a", named_value_t).publish(named_value_t())
    link.publish("a", b"short")
    link.pump(0.0)
    assert (subscriber.count, subscriber.foreign) == (0, 2)


def test_a_channel_is_a_word_and_no_pattern(link: VirtualLink) -> None:
    subscriber = rc10.Subscriber(link, "a.b", counter_t)
    rc10.Publisher(link, "axb", counter_t).publish(counter(1))
    link.pump(0.0)
    assert subscriber.count == 0


def test_what_cannot_be_published_is_refused(link: VirtualLink) -> None:
    with pytest.raises(ValueError, match="1 to 63"):
        rc10.Publisher(link, "a" * 64, counter_t)
    with pytest.raises(TypeError, match="a carries counter_t"):
        rc10.Publisher(link, "a", counter_t).publish(named_value_t())  # type: ignore[arg-type]
