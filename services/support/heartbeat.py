"""Heartbeats: a sign of life several times a second from the loop of a process that must not hang, and its last one.

Health, once a second, takes measuring; a beat takes nothing, so it can come often enough for a hung process to be missed within two
seconds. It must be the loop itself that beats: a thread of its own would beat on while the loop hangs. A
process that ends of itself says so with its last beat: to leave the bus and to tidy up takes a while, on a loaded CPU seconds.
"""

import os
import time
from collections.abc import Callable
from typing import NamedTuple

from models.messages import topics
from models.process import Bus

PERIOD_S = 0.2
_LAST = b" ends"


class Beat(NamedTuple):
    """What a heartbeat tells: whose it is, and whether the process ends and will beat no more."""

    pid: int
    last: bool


class Heartbeat:
    """Call it in every round of the loop, as often as the loop goes round.

    Args:
        process: its name on the bus.
        bus: where to beat.
        clock_s: CLOCK_MONOTONIC.
    """

    def __init__(self, process: str, bus: Bus, clock_s: Callable[[], float] = time.monotonic) -> None:
        self._topic = topics.beat(process)
        self._payload = str(os.getpid()).encode()
        self._bus = bus
        self._clock_s = clock_s
        self._next_s = clock_s()

    def __call__(self) -> None:
        """Beat, if the last one is long enough ago."""
        now_s = self._clock_s()
        if now_s >= self._next_s:
            self._next_s = now_s + PERIOD_S
            self._bus.publish(self._topic, self._payload)

    def last(self) -> None:
        """Beat for the last time: the process ends."""
        self._bus.publish(self._topic, self._payload + _LAST)


def read_beat(payload: bytes) -> Beat | None:
    """What a beat tells; None if it is no beat."""
    pid = payload.removesuffix(_LAST)
    return Beat(int(pid), last=pid != payload) if pid.isdigit() and len(pid) < 10 else None
