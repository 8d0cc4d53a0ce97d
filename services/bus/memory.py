"""The bus within one process, so that step functions and the loops of processes run in tests without sockets.

It behaves as `ZenohBus` does; one suite of laws runs over both (`tests/integration/test_bus_laws.py`).
"""

import threading
from collections.abc import Callable

from models.process import Subscription
from services.bus.keys import matches
from services.bus.mailbox import Mailbox


class MemoryRouter:
    """What the buses of one test share: who subscribes to what, and which tokens are held."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._buses: list[MemoryBus] = []

    def open(self) -> "MemoryBus":
        """A new bus, as of one more process."""
        bus = MemoryBus(self)
        with self._lock:
            self._buses.append(bus)
        return bus

    def route(self, topic: str, payload: bytes) -> None:
        """Hand a message to every mailbox that subscribed to its topic."""
        with self._lock:
            for bus in self._buses:
                bus.deliver(topic, payload)

    def tokens(self) -> set[str]:
        """Every token that is held now."""
        with self._lock:
            return set().union(*(bus.tokens for bus in self._buses))

    def announce(self) -> None:
        """Tell every watcher what changed. Called after any change of tokens or watchers."""
        with self._lock:
            tokens = self.tokens()
            for bus in self._buses:
                bus.compare(tokens)

    def leave(self, bus: "MemoryBus") -> None:
        """Take a bus out with its tokens, as when its process ends or is killed."""
        with self._lock:
            if bus in self._buses:
                self._buses.remove(bus)
            self.announce()


class MemoryBus:
    """`models.process.Bus` among the buses of one `MemoryRouter`."""

    def __init__(self, router: MemoryRouter) -> None:
        self._router = router
        self._subscriptions: list[tuple[str, Mailbox]] = []
        self._watchers: list[_Watcher] = []
        self.tokens: frozenset[str] = frozenset()

    def publish(self, topic: str, payload: bytes) -> None:
        """Hand a message over."""
        self._router.route(topic, payload)

    def subscribe(self, *topics: str, keep: int) -> Subscription:
        """Receive what is published on key expressions, the newest `keep` unread messages of each topic."""
        mailbox = Mailbox(keep)
        self._subscriptions += [(topic, mailbox) for topic in topics]
        return mailbox

    def declare_alive(self, topic: str) -> None:
        """Hold a liveliness token until the bus is closed."""
        self.tokens |= {topic}
        self._router.announce()

    def watch_alive(self, topic: str, seen: Callable[[str, bool], None]) -> None:
        """Call `seen(topic, alive)` for every token that is there and for every change, on the thread that changes it."""
        self._watchers.append(_Watcher(topic, seen))
        self._router.announce()

    def close(self) -> None:
        """Leave the bus: tokens go, subscriptions end."""
        self._router.leave(self)
        for _, mailbox in self._subscriptions:
            mailbox.close()
        self._subscriptions.clear()

    def deliver(self, topic: str, payload: bytes) -> None:
        """Store a message in every mailbox of this bus whose subscription means its topic."""
        for pattern, mailbox in self._subscriptions:
            if matches(pattern, topic):
                mailbox.put(topic, payload)

    def compare(self, tokens: set[str]) -> None:
        """Tell this bus's watchers what differs from what they were told last."""
        for watcher in self._watchers:
            watcher.compare(tokens)


class _Watcher:
    def __init__(self, pattern: str, seen: Callable[[str, bool], None]) -> None:
        self._pattern = pattern
        self._seen = seen
        self._known: set[str] = set()

    def compare(self, tokens: set[str]) -> None:
        current = {token for token in tokens if matches(self._pattern, token)}
        gone, come = self._known - current, current - self._known
        self._known = current
        for token in sorted(gone):
            self._seen(token, False)
        for token in sorted(come):
            self._seen(token, True)
