"""Unread messages of one subscription: the newest few of every topic, the topics taking turns.

Both buses put what arrives here, so that they keep, drop and order alike. A topic that floods can displace only its own
messages and never another topic's, and it cannot starve another one either: a reader that is too slow for all gets the
newest of each in turn. A reader that keeps up receives everything in the order of arrival.
"""

import threading
import time
from collections import deque

from models.process import Delivery


class Mailbox:
    """A bounded ring per topic under one condition variable. Any thread may put, any thread may receive."""

    def __init__(self, keep: int) -> None:
        if keep < 1:
            raise ValueError(f"keep must be at least 1, not {keep}")
        self._keep = keep
        self._rings: dict[str, deque[bytes]] = {}
        self._turns: deque[str] = deque()
        self._arrived = threading.Condition(threading.Lock())
        self._closed = False

    def put(self, topic: str, payload: bytes) -> None:
        """Store a message; if its topic is full, the topic's oldest one goes. Never waits for a reader."""
        with self._arrived:
            if self._closed:
                return
            ring = self._rings.get(topic)
            if ring is None:
                ring = self._rings[topic] = deque(maxlen=self._keep)
                self._turns.append(topic)
            ring.append(payload)
            self._arrived.notify()

    def receive(self, timeout_s: float) -> Delivery | None:
        """The oldest unread message of the topic whose turn it is; None after `timeout_s` without one, or when closed."""
        deadline_s = time.monotonic() + timeout_s
        with self._arrived:
            while not self._turns:
                remaining_s = deadline_s - time.monotonic()
                if self._closed or remaining_s <= 0 or not self._arrived.wait(remaining_s):
                    break
            return self._take()

    def close(self) -> None:
        """Forget what is unread and wake whoever waits."""
        with self._arrived:
            self._closed = True
            self._rings.clear()
            self._turns.clear()
            self._arrived.notify_all()

    def _take(self) -> Delivery | None:
        if not self._turns:
            return None
        topic = self._turns.popleft()
        ring = self._rings[topic]
        payload = ring.popleft()
        if ring:
            self._turns.append(topic)
        else:
            del self._rings[topic]  # So that topics which no longer exist leave nothing behind.
        return Delivery(topic, payload)
