"""The bus over Zenoh. The fusion process is the router, every other process its client; nothing else needs to run.

Received messages go through a callback that only stores bytes in a `Mailbox`. Zenoh's own `RingChannel` was measured against it
and lost: it has no receive with a timeout, so that a reader must poll (every ms: 5 % of a core when idle against 0.3 %, and 0.8 ms
median latency against 0.35), and it keeps the newest of a pattern, not of each topic, so that one topic can displace another.
"""

from __future__ import annotations  # Zenoh's generic classes exist for the type checker only.

import contextlib
import json
import threading
from collections.abc import Callable
from typing import Any

import zenoh
from zenoh.handlers import Callback

from models.errors import UserError
from models.process import Delivery, Subscription
from services.bus.mailbox import Mailbox

BusError = zenoh.ZError
"""Something cannot be declared or said: the session is closed, or its router has just gone."""
LEASE_MS = 2000
"""A peer that has been silent for so long is taken for dead. A process that was killed is noticed at once."""

_RETRY_FIRST_S = 0.05
_RETRY_LONGEST_S = 0.2
_CLOSE_WITHIN_S = 0.5

_COMMON: dict[str, Any] = {
    "adminspace/enabled": False,
    "plugins_loading/enabled": False,
    "scouting/gossip/enabled": False,
    "scouting/multicast/enabled": False,
    # Without multicast nothing can be found in the half second for which a session waits by default.
    "scouting/delay": 0,
    "timestamping/enabled": False,
    "transport/link/tx/lease": LEASE_MS,
    # On by default; it made latency tails of up to 82 ms and leaked memory whenever a publisher restarted.
    "transport/shared_memory/enabled": False,
    # Packets that wait for a busy link. By default 2: on a loaded CPU, bursts of eight messages then lost every tenth one.
    "transport/link/tx/queue/size/data": 16,
}


def open_router(endpoint: str) -> ZenohBus:
    """Listen on `endpoint` ("tcp/127.0.0.1:7447") and route for every client.

    Raises:
        UserError: the endpoint cannot be listened on.
    """
    try:
        return ZenohBus(zenoh.open(_configuration({"mode": "router", "listen/endpoints": [endpoint]})))
    except zenoh.ZError as error:
        reason = "is in use already" if "in use" in str(error) else "cannot be listened on"
        raise UserError(
            f"bus endpoint {endpoint} {reason}; stop the other KineBox or change bus.endpoint in the site file"
        ) from error


def try_client(endpoint: str, answers_within_s: float = 10.0) -> ZenohBus | None:
    """Connect to the router at `endpoint`; None if it is not there, or does not answer in time.

    Once connected, a link that breaks is mended by Zenoh itself, with all subscriptions and tokens.
    """
    configuration = {
        "mode": "client",
        "connect/endpoints": [endpoint],
        # A session that waits in `open` cannot be told to stop, hence no time limit there and a loop outside.
        "connect/timeout_ms": 0,
        "transport/unicast/open_timeout": round(1000 * answers_within_s),
        "connect/retry": {"period_init_ms": 100, "period_max_ms": 400, "period_increase_factor": 2.0},
    }
    try:
        return ZenohBus(zenoh.open(_configuration(configuration)))
    except zenoh.ZError:
        return None


def open_client(endpoint: str, stop: threading.Event) -> ZenohBus | None:
    """Connect as `try_client` does, trying until the router is there; None if `stop` was set before."""
    wait_s = _RETRY_FIRST_S
    while not stop.is_set():
        bus = try_client(endpoint)
        if bus is not None:
            return bus
        stop.wait(wait_s)
        wait_s = min(2 * wait_s, _RETRY_LONGEST_S)
    return None


class ZenohBus:
    """`models.process.Bus` over an open Zenoh session."""

    def __init__(self, session: zenoh.Session) -> None:
        self._session = session
        self._lock = threading.Lock()
        self._publishers: dict[str, zenoh.Publisher] = {}
        self._tokens: list[zenoh.LivelinessToken] = []
        self._mailboxes: list[Mailbox] = []

    def publish(self, topic: str, payload: bytes) -> None:
        """Hand a message over. If a receiver's link is congested the message is dropped for that receiver."""
        publisher = self._publishers.get(topic)
        if publisher is None:
            publisher = self._declare_publisher(topic)
        publisher.put(payload)

    def subscribe(self, *topics: str, keep: int) -> Subscription:
        """Receive what is published on key expressions, the newest `keep` unread messages of each topic."""
        mailbox = Mailbox(keep)

        def store(sample: zenoh.Sample) -> None:
            if sample.kind == zenoh.SampleKind.PUT:
                mailbox.put(str(sample.key_expr), sample.payload.to_bytes())

        subscribers = [self._session.declare_subscriber(topic, _direct(store)) for topic in topics]
        with self._lock:
            self._mailboxes.append(mailbox)
        return _ZenohSubscription(mailbox, subscribers)

    def declare_alive(self, topic: str) -> None:
        """Hold a liveliness token until the bus is closed or this process dies."""
        token = self._session.liveliness().declare_token(topic)
        with self._lock:
            self._tokens.append(token)

    def watch_alive(self, topic: str, seen: Callable[[str, bool], None]) -> None:
        """Call `seen(topic, alive)`, on a thread of its own, for every token that is there and for every change."""
        alive: set[str] = set()

        def note(sample: zenoh.Sample) -> None:
            name, is_alive = str(sample.key_expr), sample.kind == zenoh.SampleKind.PUT
            # After a link was mended tokens that never went away are announced again.
            if is_alive == (name in alive):
                return
            (alive.add if is_alive else alive.discard)(name)
            seen(name, is_alive)

        self._session.liveliness().declare_subscriber(topic, Callback(note), history=True)

    def close(self) -> None:
        """Leave the bus: tokens go, subscriptions end."""
        with self._lock:
            mailboxes, self._mailboxes = self._mailboxes, []
            self._tokens.clear()
            self._publishers.clear()
        # The session flushes its links first, and a receiver that hangs would hold that up for 10 s.
        closing = threading.Thread(target=self._close_session, name="bus-close", daemon=True)
        closing.start()
        closing.join(_CLOSE_WITHIN_S)
        for mailbox in mailboxes:
            mailbox.close()

    def _close_session(self) -> None:
        # A session that cannot say goodbye is gone with its process.
        with contextlib.suppress(zenoh.ZError):
            self._session.close()  # type: ignore[no-untyped-call]

    def _declare_publisher(self, topic: str) -> zenoh.Publisher:
        with self._lock:
            if topic not in self._publishers:
                self._publishers[topic] = self._session.declare_publisher(
                    topic,
                    congestion_control=zenoh.CongestionControl.DROP,
                    # Not express: a packet is sent at once anyway unless the link is busy, and then sharing one beats a queue.
                )
            return self._publishers[topic]


class _ZenohSubscription:
    def __init__(self, mailbox: Mailbox, subscribers: list[zenoh.Subscriber[None]]) -> None:
        self._mailbox = mailbox
        self._subscribers = subscribers

    def receive(self, timeout_s: float) -> Delivery | None:
        return self._mailbox.receive(timeout_s)

    def close(self) -> None:
        for subscriber in self._subscribers:
            subscriber.undeclare()  # type: ignore[no-untyped-call]
        self._mailbox.close()


def _direct(callback: Callable[[zenoh.Sample], None]) -> Callback[zenoh.Sample]:
    # Called on the network's thread: short enough for it, and saves a thread and an unbounded queue in between.
    return Callback(callback, indirect=False)


def _configuration(entries: dict[str, Any]) -> zenoh.Config:
    configuration = zenoh.Config()
    for key, value in (_COMMON | entries).items():
        configuration.insert_json5(key, json.dumps(value))
    return configuration
