"""Listens to a running box: on its bus, and whether its page answers."""

import time
from collections import deque
from dataclasses import dataclass, field
from typing import Literal

from models.config.site import Site
from models.messages import codec, topics
from models.messages.addressed import read_health
from models.messages.health import Health
from models.messages.motion import Motion
from models.process import Delivery
from services.bus.join import join
from services.doctor.lateness import Age
from services.supervisor import page

Answer = Literal["answers", "silent"]

LISTEN_S = 5.0
"""Health comes once a second; who is not heard in this time does not speak."""
ENOUGH_S = 2.5
"""If everybody was heard, this is long enough to judge rates."""
_JOIN_S = 4.0
_PAGE_S = 3.0
_KEEP = 8
_AGES = 150
"""As many as come in five seconds; whoever floods the bus does not make the doctor grow."""


@dataclass
class Heard:
    """What came while the box was listened to.

    Attributes:
        bus, page: "silent" is: the port is held, and nothing came within seconds.
        seconds: for how long the bus was listened to.
        healths: newest of each process.
        alive: processes that hold their token on the bus now.
        live: figures that came.
        ages: of the newest of these.
        unreadable: messages that could not be read, by topic.
    """

    bus: Answer = "silent"
    page: Answer = "silent"
    seconds: float = 0.0
    healths: dict[str, Health] = field(default_factory=dict)
    alive: set[str] = field(default_factory=set)
    live: int = 0
    ages: deque[Age] = field(default_factory=lambda: deque(maxlen=_AGES))
    unreadable: dict[str, int] = field(default_factory=dict)

    def take(self, delivery: Delivery) -> None:
        """Count one message."""
        topic = delivery.topic
        try:
            if topic == topics.motion("live"):
                motion = codec.decode(delivery.payload, Motion)
                self.live += 1
                self.ages.append(Age.of(motion, time.monotonic_ns()))
            else:
                health = read_health(topic, delivery.payload)
                self.healths[health.process] = health
        except codec.CodecError:
            self.unreadable[topic] = self.unreadable.get(topic, 0) + 1

    def note(self, topic: str, alive: bool) -> None:
        """A process joined or left the bus."""
        (self.alive.add if alive else self.alive.discard)(topics.process_of(topic))


def listen(site: Site, expected: frozenset[str]) -> Heard:
    """Listen to the box of a site.

    Args:
        site: its site file.
        expected: names of the processes that should speak; when all have, listening ends early.
    """
    heard = Heard(page="answers" if page.answers(site.tablet, _PAGE_S) else "silent")
    bus = join(site.bus.endpoint, _JOIN_S)
    if bus is None:
        return heard
    heard.bus = "answers"
    try:
        subscription = bus.subscribe(topics.ALL_HEALTH, topics.motion("live"), keep=_KEEP)
        bus.watch_alive(topics.ALL_ALIVE, heard.note)
        began_s = time.monotonic()
        while heard.seconds < (ENOUGH_S if expected <= heard.healths.keys() else LISTEN_S):
            if (delivery := subscription.receive(0.1)) is not None:
                heard.take(delivery)
            heard.seconds = time.monotonic() - began_s
    finally:
        bus.close()
    return heard
