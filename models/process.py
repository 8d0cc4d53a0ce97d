"""What a process of the box is given, and the bus as it sees it.

`services` and `edge` never import one another: the command line opens the bus, finds a process by its entry point in the group
`kinebox.processes` and calls it with a `ProcessContext`.
"""

import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, Protocol

import msgspec

from models.camera.rig import Rig
from models.config.site import Site

ROUTER = "fusion"
"""The process that is the bus's router, for which all others wait."""
EDGE = "edge"
"""The process of one camera; the only one of which there are several."""
RECORDER = "recorder"
"""The process that writes lessons."""
REPLAY = "replay"
"""The process that plays a lesson, in fusion's place."""
EVALUATION = "evaluation"
"""The process that finds attempts in the smooth motion, and says what is to be said of them."""
ROUTERS = (ROUTER, REPLAY)
"""One of them runs in every box, and has the bus."""
SPARE_READY = "kinebox spare: ready"
"""The line with which a spare says that it has imported and warmed up everything and waits for its post."""

Check = Callable[[Site, Rig, Path], None]
"""What a part wants checked before anything is started, with the data folder; it raises `UserError` if the part could not work."""


def process_name(entry: str, camera: str | None = None) -> str:
    """The name on the bus of the process of an entry point, and for "edge" of a camera."""
    return entry if camera is None else f"{entry}-{camera}"


@dataclass(frozen=True)
class Delivery:
    """One message as it arrived."""

    topic: str
    payload: bytes


class Subscription(Protocol):
    """A stream of deliveries that keeps the newest few of each topic and never grows."""

    def receive(self, timeout_s: float) -> Delivery | None:
        """The next delivery, waiting for one at most `timeout_s`; None if none came.

        Oldest first within a topic; topics take turns, so that none starves however slow the reader is.
        """

    def close(self) -> None:
        """Stop receiving."""


class Bus(Protocol):
    """Publish and subscribe by key expression, and see who is alive."""

    def publish(self, topic: str, payload: bytes) -> None:
        """Hand a message over; never waits for a receiver."""

    def subscribe(self, *topics: str, keep: int) -> Subscription:
        """Receive what is published on key expressions, keeping at most `keep` unread messages of each topic, the newest."""

    def declare_alive(self, topic: str) -> None:
        """Hold a liveliness token until the bus is closed or this process dies."""

    def watch_alive(self, topic: str, seen: Callable[[str, bool], None]) -> None:
        """Call `seen(topic, alive)` for every token that is there and for every change."""

    def close(self) -> None:
        """Leave the bus; tokens go."""


class Resources(NamedTuple):
    """What this process used: CPU seconds a second since the call before, and resident memory now."""

    cpu_cores: float
    rss_mib: float


class Playback(msgspec.Struct, frozen=True):
    """A lesson that is played in the place of a room.

    Attributes:
        file: path of the lesson.
        title: what people call the lesson; may be empty.
        began_wall_ns: CLOCK_REALTIME at which it was begun.
        speed: seconds of the lesson a second.
        loop: begin again at its end.
    """

    file: str
    title: str
    began_wall_ns: int
    speed: float
    loop: bool


@dataclass(frozen=True)
class ProcessContext:
    """Everything a process of the box needs from outside.

    Attributes:
        name: the process's name on the bus: see `process_name`.
        camera: the camera served, for an edge process.
        site: the decoded site file.
        rig: calibration of the site's cameras, in the site's order.
        data: folder with networks and footage.
        start_ns: CLOCK_MONOTONIC shared by all processes of one run; sources count their frames from it.
        bus: open session.
        stop: set when the process shall end.
        resources: measures this process; every process reports the result in its health once a second.
        playback: what is played in the place of a room; None in a room.
        beat: called in every round of the process's loop, tells that it goes round. A process that calls it is missed sooner.
    """

    name: str
    camera: str | None
    site: Site
    rig: Rig
    data: Path
    start_ns: int
    bus: Bus
    stop: threading.Event
    resources: Callable[[], Resources]
    playback: Playback | None = None
    beat: Callable[[], None] = lambda: None
