"""The garbage of the drill on a corrupt bus reaches everybody, and not only the first check of a message."""

import random

import pytest

from models.messages import topics
from services.bus.keys import matches
from tests.faults.garbage import garbage_for, on_every_topic, unheard
from tests.mutations.consumers import patterns
from tests.mutations.samples import by_topic


@pytest.mark.parametrize("topic", by_topic())
def test_garbage_gets_past_the_version_and_the_type_of_its_topic(topic: str) -> None:
    chance, payload = random.Random(0), by_topic()[topic][0]  # noqa: S311 - no secret
    made = [garbage_for(payload, chance) for _ in range(100)]
    assert sum(each[:2] == payload[:2] and len(each) > 2 for each in made) > 25
    assert sum(each[:2] != payload[:2] for each in made) > 25


@pytest.mark.parametrize("pattern", patterns().values())
def test_no_topic_is_spared_on_which_nobody_speaks_before_he_is_asked(pattern: str) -> None:
    assert any(matches(pattern, topic) for topic in on_every_topic({}))


def test_what_was_heard_of_the_box_is_not_replaced_by_a_sample() -> None:
    heard = {topics.motion("live"): b"of the box", topics.control("cam07"): b"a plan"}
    every = on_every_topic(heard)
    assert every.items() >= heard.items()
    assert [topic for topic in every if matches(topics.control("*"), topic)] == [topics.control("cam07")]
    assert topics.motion("smooth") not in every
    assert topics.feedback_request() in unheard(heard)
