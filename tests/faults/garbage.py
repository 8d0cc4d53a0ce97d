"""Bytes that are no message, and messages that have lost their end."""

import random

LONGEST = 20_000


def garbage_of(chance: random.Random) -> bytes:
    """Random bytes of a random length, half of them with the beginning of a message."""
    head = bytes((1, chance.randint(1, 8))) if chance.random() < 0.5 else b""
    return head + chance.randbytes(chance.choice((0, 1, 2, 30, 1000, LONGEST)))


def truncated(payload: bytes, chance: random.Random) -> bytes:
    """The beginning of a message."""
    return payload[: chance.randrange(max(len(payload), 1))]
