"""Mutated messages through those that watch over the box, and the law that everybody who receives is tested."""

import inspect
import time
from contextlib import suppress
from typing import get_args

import pytest

from models.messages import codec, topics
from models.messages.motion import Motion
from models.process import Delivery
from services.bus.keys import matches
from services.bus.mailbox import Mailbox
from services.bus.memory import MemoryRouter
from services.doctor.listen import Heard
from services.lesson.remote import Remote
from services.supervisor.bus_link import unread_beats, unread_healths
from services.support.heartbeat import Beat
from services.tablet.messages import ClientMessage
from tests.mutations import test_mutations as test_mutations  # noqa: PLC0414 - what it asks for is counted, too
from tests.mutations.consumers import ASKED, patterns, received, topics_of
from tests.mutations.feed import COUNTS, GROWTH_MB, Growth, deliveries
from tests.mutations.samples import CLIENT_MESSAGES, by_topic, healths, motion

SUPERVISOR = "services.supervisor.bus_link"
MESSAGES = [topic for topic in by_topic() if not matches(topics.ALL_BEATS, topic)]


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("topic", topics_of(SUPERVISOR, every=True))
def test_the_supervisor_survives_and_still_hears(topic: str, count: int) -> None:
    growth, mailbox, refused = Growth(), Mailbox(1), 0
    for delivery in deliveries(topic, count, growth):
        mailbox.put(topic, delivery.payload)
        _, unread = unread_healths(mailbox) if matches(topics.ALL_HEALTH, topic) else unread_beats(mailbox)
        refused += unread
    assert refused > count // 10
    name = topics.process_of(topic)
    if matches(topics.ALL_BEATS, topic):
        mailbox.put(topic, b"4711")
        assert unread_beats(mailbox) == ([(name, Beat(4711, last=False))], 0)
    else:
        true = healths(time.monotonic_ns())[name]
        mailbox.put(topic, codec.encode(true))
        assert unread_healths(mailbox) == ([true], 0)
    assert growth.mb < GROWTH_MB


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("topic", [topic for topic in MESSAGES if not matches(topics.ALL_HEALTH, topic)])
def test_the_supervisor_takes_no_other_message_for_a_sign_of_life(topic: str, count: int) -> None:
    growth, mailbox = Growth(), Mailbox(1)
    for delivery in deliveries(topic, count, growth):
        mailbox.put(topics.health("fusion"), delivery.payload)
        assert unread_healths(mailbox) == ([], 1)
        if not delivery.payload.isdigit():  # What was cut down to a number is a beat, of a process that nobody waits for.
            mailbox.put(topics.beat("fusion"), delivery.payload)
            assert unread_beats(mailbox) == ([], 1)
    assert growth.mb < GROWTH_MB


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("topic", topics_of("services.doctor.listen"))
def test_the_doctor_survives_and_then_hears_what_is_true(topic: str, count: int) -> None:
    growth, heard = Growth(), Heard()
    for delivery in deliveries(topic, count, growth):
        heard.take(delivery)
    assert heard.unreadable[topic] > count // 10
    now_ns, live = time.monotonic_ns(), heard.live
    for true in healths(now_ns).values():
        heard.take(Delivery(topics.health(true.process), codec.encode(true)))
        assert heard.healths[true.process] == true
    assert heard.healths.keys() <= healths(now_ns).keys()
    heard.take(Delivery(topics.motion("live"), codec.encode(motion(now_ns))))
    assert heard.live == live + 1
    assert growth.mb < GROWTH_MB


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("topic", topics_of("services.lesson.remote", every=True))
def test_whoever_asks_for_a_lesson_survives_and_then_hears_the_recorder(topic: str, count: int) -> None:
    router, growth = MemoryRouter(), Growth()
    box, remote = router.open(), Remote(router.open())
    for delivery in deliveries(topic, count, growth):
        box.publish(topic, delivery.payload)
        heard = remote.listen(0.001)
        assert heard is None or heard.process == "recorder"
    true = healths(time.monotonic_ns())["recorder"]
    box.publish(topics.health("recorder"), codec.encode(true))
    assert remote.listen(5.0) == true
    assert growth.mb < GROWTH_MB


@pytest.mark.parametrize("count", COUNTS)
@pytest.mark.parametrize("topic", MESSAGES)
def test_a_message_that_is_read_at_all_can_be_passed_on(topic: str, count: int) -> None:
    growth, kind, read = Growth(), _kind_of(by_topic()[topic][0]), 0
    for delivery in deliveries(topic, count, growth):
        try:
            message = codec.decode(delivery.payload, kind)
        except codec.CodecError:
            continue
        read += 1
        assert codec.encode(codec.decode(codec.encode(message), kind)) == codec.encode(message)
    assert 0 < read < count
    assert growth.mb < GROWTH_MB


def _kind_of(message: bytes) -> type[codec.Message]:
    for kind in get_args(codec.Message):
        with suppress(codec.CodecError):
            return type(codec.decode(message, kind))
    raise AssertionError(message)


@pytest.mark.parametrize("name", patterns())
def test_every_topic_has_samples_of_which_mutants_are_made(name: str) -> None:
    assert _has_sample(patterns()[name])


def test_both_kinds_of_motion_have_samples() -> None:
    kinds = get_args(inspect.get_annotations(Motion, eval_str=True)["kind"])
    assert {topics.motion(kind) for kind in kinds} <= by_topic().keys()


def test_every_kind_of_message_that_a_page_may_send_has_a_sample_of_which_mutants_are_made() -> None:
    union, _ = get_args(ClientMessage)
    assert {type(message) for message in CLIENT_MESSAGES} == set(get_args(union))


def test_everybody_who_receives_is_tested_with_everything_that_he_receives() -> None:
    assert set(received()) == ASKED, "a module that subscribes has no test here, or one that is tested does not subscribe any more"
    lacking = [(module, pattern) for module, patterns in received().items() for pattern in patterns if not _has_sample(pattern)]
    assert lacking == []


def _has_sample(pattern: str) -> bool:
    return any(matches(pattern, topic) for topic in by_topic())
