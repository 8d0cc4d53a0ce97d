"""Laws of the mailbox behind every subscription, and of key expressions against Zenoh's own."""

from collections import defaultdict

import zenoh
from hypothesis import given
from hypothesis import strategies as st

from services.bus.keys import matches
from services.bus.mailbox import Mailbox

TOPICS = st.sampled_from(["a", "b", "c"])
PUT = st.tuples(st.just("put"), TOPICS)
TAKE = st.tuples(st.just("take"), st.just(""))


@given(st.lists(st.one_of(PUT, TAKE), max_size=80), st.integers(1, 4))
def test_a_mailbox_delivers_the_newest_of_each_topic_in_order(steps: list[tuple[str, str]], keep: int) -> None:
    """Against the simplest model: a list a topic, cut to its newest."""
    mailbox = Mailbox(keep)
    expected: dict[str, list[bytes]] = defaultdict(list)
    for number, (action, topic) in enumerate(steps):
        if action == "put":
            payload = b"%d" % number
            mailbox.put(topic, payload)
            expected[topic] = [*expected[topic], payload][-keep:]
            continue
        delivery = mailbox.receive(0.0)
        if delivery is None:
            assert not any(expected.values())
        else:
            assert delivery.payload == expected[delivery.topic].pop(0)


@given(st.lists(TOPICS, min_size=1, max_size=60), st.integers(1, 4))
def test_no_topic_waits_for_more_than_one_message_of_each_other(puts: list[str], keep: int) -> None:
    mailbox = Mailbox(keep)
    for topic in puts:
        mailbox.put(topic, b"")
    order = []
    while (delivery := mailbox.receive(0.0)) is not None:
        order.append(delivery.topic)
    for topic in set(puts):
        turns = [place for place, found in enumerate(order) if found == topic]
        gaps = [later - earlier for earlier, later in zip([-1, *turns], turns, strict=False)]
        assert max(gaps) <= len(set(puts))


CHUNK = st.text("ab1-", min_size=1, max_size=3)
TOPIC = st.lists(CHUNK, min_size=1, max_size=5).map("/".join)
PATTERN = st.lists(st.one_of(CHUNK, st.just("*"), st.just("**")), min_size=1, max_size=5).map("/".join)


@given(PATTERN, TOPIC)
def test_key_expressions_mean_what_zenoh_takes_them_for(pattern: str, topic: str) -> None:
    assert matches(pattern, topic) == zenoh.KeyExpr.autocanonize(pattern).includes(topic)


@given(st.lists(CHUNK, min_size=2, max_size=5), st.data())
def test_a_topic_with_levels_replaced_by_stars_still_means_it(chunks: list[str], data: st.DataObject) -> None:
    pattern = [data.draw(st.sampled_from([chunk, "*", "**"])) for chunk in chunks]
    assert matches("/".join(pattern), "/".join(chunks))
    assert matches("/".join(pattern), "/".join(chunks)) == zenoh.KeyExpr.autocanonize("/".join(pattern)).includes("/".join(chunks))
