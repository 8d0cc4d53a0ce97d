"""Waiting for what must come, without asserting how soon: a deadline is generous and only ends a test that has failed."""

import time
from collections.abc import Callable

from models.process import Bus, Subscription

DEADLINE_S = 30.0


def until(condition: Callable[[], bool], what: str | Callable[[], str], deadline_s: float = DEADLINE_S) -> None:
    """Wait for a condition, or fail with `what` was waited for; a function is asked once it has failed."""
    end_s = time.monotonic() + deadline_s
    while not condition():
        assert time.monotonic() < end_s, f"waited in vain: {what if isinstance(what, str) else what()}"
        time.sleep(0.01)


def heard(publisher: Bus, subscription: Subscription, topic: str) -> None:
    """Publish until the subscription receives on that topic, then empty it: from now on nothing is lost on the way."""
    marks = 0

    def arrives() -> bool:
        nonlocal marks
        marks += 1
        publisher.publish(topic, b"mark %d" % marks)
        return subscription.receive(0.05) is not None

    until(arrives, f"a message on {topic}")
    last = b"last mark"
    publisher.publish(topic, last)
    until(lambda: (delivery := subscription.receive(1.0)) is not None and delivery.payload == last, f"the last mark on {topic}")
