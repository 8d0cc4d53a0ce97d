"""A bus that brings what a test has made, as fast as it is taken, and ends the process when all is taken."""

import threading
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path

import psutil
import pytest

from models.config.site import CameraConfig, Site
from models.messages import codec, topics
from models.messages.health import Health
from models.process import Delivery, ProcessContext, Resources, Subscription
from services.bus.keys import matches
from tests.mutations.mutate import mutants, raw_mutants
from tests.mutations.samples import RIG, by_topic

MB = 2**20
COUNTS = [
    pytest.param(2_000, marks=[pytest.mark.slow, pytest.mark.timeout(300)]),
    pytest.param(100_000, marks=[pytest.mark.mutations, pytest.mark.slow, pytest.mark.timeout(1800)]),
]
GROWTH_MB = 40.0
"""Far less than a hundred thousand messages of 3 KB would take if they were kept."""


class _Feed:
    """Deliveries one after the other; every other `receive` finds nothing, so that whoever drains it comes to an end."""

    def __init__(self, deliveries: Iterator[Delivery], ended: Callable[[], None]) -> None:
        self._deliveries = deliveries
        self._ended = ended
        self._pause = False

    def receive(self, _timeout_s: float) -> Delivery | None:
        self._pause = not self._pause
        if self._pause:
            return None
        delivery = next(self._deliveries, None)
        if delivery is None:
            self._ended()
        return delivery

    def close(self) -> None:
        pass


class FeedBus:
    """`models.process.Bus` for one process.

    Attributes:
        published, newest: how many messages the process has published, and the last one, by topic.
        healths: what it has said of itself.
    """

    def __init__(self, deliveries: Iterable[Delivery], stop: threading.Event) -> None:
        self._deliveries = iter(deliveries)
        self._stop = stop
        self._patterns: tuple[str, ...] = ()
        self.published: Counter[str] = Counter()
        self.newest: dict[str, bytes] = {}
        self.healths: list[Health] = []

    @property
    def refused(self) -> int:
        """How many messages the process has said that it could not read."""
        troubles = [trouble for health in self.healths for trouble in health.troubles if trouble.code == "messages_refused"]
        return sum(int(trouble.words.split()[0]) for trouble in troubles)

    def publish(self, topic: str, payload: bytes) -> None:
        self.published[topic] += 1
        self.newest[topic] = payload
        if "/health/" in topic:
            self.healths.append(codec.decode(payload, Health))

    def subscribe(self, *topics: str, keep: int) -> Subscription:
        assert keep >= 1
        self._patterns += topics
        return _Feed((each for each in self._deliveries if self._is_wanted(each)), self._stop.set)

    def declare_alive(self, topic: str) -> None:
        pass

    def watch_alive(self, topic: str, seen: Callable[[str, bool], None]) -> None:
        pass

    def close(self) -> None:
        pass

    def _is_wanted(self, delivery: Delivery) -> bool:
        return any(matches(pattern, delivery.topic) for pattern in self._patterns)


def context_of(name: str, bus: FeedBus, stop: threading.Event, data: Path, camera: str | None = None) -> ProcessContext:
    """What a process of the small room is given."""
    cameras = [CameraConfig(name=each, kind="video", path="none.avi") for each in RIG.names]
    return ProcessContext(
        name=name,
        camera=camera,
        site=Site(version=2, name="test", calibration="rig.toml", cameras=cameras),
        rig=RIG,
        data=data,
        start_ns=0,
        bus=bus,
        stop=stop,
        resources=lambda: Resources(0.1, 100.0),
    )


class Growth:
    """How much this process has grown since its first `settled`."""

    def __init__(self) -> None:
        self._process = psutil.Process()
        self._base_mb: float | None = None

    def settled(self) -> None:
        """Whatever is cached once and for all has been cached."""
        if self._base_mb is None:
            self._base_mb = self._process.memory_info().rss / MB

    @property
    def mb(self) -> float:
        """Resident memory more than then."""
        return self._process.memory_info().rss / MB - (self._base_mb or 0.0)


def deliveries(topic: str, count: int, growth: Growth, seed: int = 1) -> Iterator[Delivery]:
    """Mutants on a topic; from a tenth on, memory must not grow any more."""
    made = raw_mutants if matches(topics.ALL_BEATS, topic) else mutants
    for number, payload in enumerate(made(by_topic()[topic], seed, count)):
        if number == count // 10:
            growth.settled()
        yield Delivery(topic, payload)
