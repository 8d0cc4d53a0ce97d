"""Heartbeats: a sign of life several times a second from the loop of a process that must not hang.

Health, once a second, takes measuring; a beat takes nothing, so it can come often enough for a hung process to be missed within a
second. It must be the loop itself that beats: a thread of its own would beat on while the loop hangs.
"""

import os
import time
from collections.abc import Callable

from models.messages import topics
from models.process import Bus

PERIOD_S = 0.2


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


def beating_pid(payload: bytes) -> int | None:
    """The id of the process whose beat this is; None if it is no beat."""
    return int(payload) if payload.isdigit() and len(payload) < 10 else None
