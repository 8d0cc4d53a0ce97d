"""What no healthy process sends on the bus: bytes that are no message, and messages that have lost their end."""

import random
from collections.abc import Collection, Mapping

from services.bus.keys import matches
from tests.mutations.consumers import patterns
from tests.mutations.samples import by_topic

LONGEST = 20_000


def on_every_topic(heard: Mapping[str, bytes]) -> dict[str, bytes]:
    """What was heard, and a sample of every topic on which nobody speaks before he is asked."""
    silent = unheard(heard)
    samples = {topic: payloads[0] for topic, payloads in by_topic().items() if any(matches(each, topic) for each in silent)}
    return samples | dict(heard)


def unheard(topics: Collection[str]) -> list[str]:
    """Key expressions of the bus that none of these topics belongs to."""
    return [pattern for pattern in patterns().values() if not any(matches(pattern, topic) for topic in topics)]


def garbage_for(payload: bytes, chance: random.Random) -> bytes:
    """Random bytes of a random length, half of them with the two bytes with which this topic's messages begin."""
    head = payload[:2] if chance.random() < 0.5 else b""
    return head + chance.randbytes(chance.choice((0, 1, 2, 30, 1000, LONGEST)))


def truncated(payload: bytes, chance: random.Random) -> bytes:
    """The beginning of a message."""
    return payload[: chance.randrange(max(len(payload), 1))]
