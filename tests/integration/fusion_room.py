"""Fusion's loop in a thread, a synthetic pupil before its cameras, and its log written to a lesson file."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Protocol

import numpy as np

from models.camera.rig import encode_rig
from models.config.site import SITE_VERSION, CameraConfig, Site
from models.messages import codec, topics
from models.messages.health import CameraHealth, Health
from models.messages.lesson import FusionLog, SegmentRequest
from models.messages.motion import Motion
from models.messages.observation import Crop, Observation, Person
from models.process import Bus, ProcessContext, Resources, Subscription
from services.fusion.process import FusionLoop
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_header import LessonHeader
from services.site_file.rendering import render
from services.support.cpu import CpuMeter
from tests.integration.waiting import DEADLINE_S, until
from tests.synthetic.gym import ring_rig
from tests.synthetic.person import Person as Pupil

RIG = ring_rig(4)
SITE = Site(
    version=SITE_VERSION,
    name="Synthetic gym",
    calibration="rig.toml",
    cameras=[CameraConfig(name=name, kind="video", path="none.avi") for name in RIG.names],
)
_FILM_S = 1 / 15


def header(title: str = "7b, throwing", kinebox: str = "0.1.0", machine: str = "test") -> LessonHeader:
    """Of a lesson in this room."""
    return LessonHeader(
        title=title,
        kinebox=kinebox,
        machine=machine,
        preset=SITE.fusion.preset,
        site_toml=render(SITE),
        rig_toml=encode_rig(RIG, "synthetic").decode(),
        started_ns=time.monotonic_ns(),
        wall_minus_monotonic_ns=time.time_ns() - time.monotonic_ns(),
        run_ns=time.monotonic_ns(),
    )


class Opens(Protocol):
    """What buses come from: the memory's router, or one on real sockets, where fusion comes first."""

    def open(self) -> Bus: ...


class Cameras:
    """Four cameras that look at a walking, throwing pupil, with noise; they publish until they are closed."""

    def __init__(self, room: Opens) -> None:
        self._bus = room.open()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._film, name="cameras", daemon=True)
        self._thread.start()

    def close(self) -> None:
        self._stop.set()
        self._thread.join()
        self._bus.close()

    def _film(self) -> None:
        random = np.random.default_rng(7)
        pupil = Pupil()
        sequence = 0
        while not self._stop.wait(_FILM_S / len(RIG)):
            camera = RIG.cameras[sequence % len(RIG)]
            t_ns = time.monotonic_ns()
            pixels = camera.project(pupil.joints(t_ns * 1e-9 % 1000)) + random.normal(0.0, 2.0, (17, 2))
            score = random.uniform(0.2, 1.0, 17).astype(np.float32)
            crop = Crop(float(pixels[:, 0].mean()), float(pixels[:, 1].mean()), 400.0)
            person = Person(1, crop, pixels.astype(np.float32), np.full(17, 2, np.float32), score)
            observation = Observation(camera.name, 0, sequence, sequence, t_ns, t_ns, "thunder", (person,))
            self._bus.publish(topics.observation(camera.name), codec.encode(observation))
            if sequence % 60 < len(RIG):
                rates = CameraHealth(camera.name, 30.0, 15.0, 15.0, 0, 20.0, "thunder", {})
                health = Health(f"edge-{camera.name}", 1, t_ns, "ok", (), 0.1, 1.0, camera=rates)
                self._bus.publish(topics.health(health.process), codec.encode(health))
            sequence += 1


class LogRecorder:
    """Asks fusion for its log and writes what comes, as the recorder does; keeps the live motions beside."""

    def __init__(self, room: Opens, writer: LessonWriter) -> None:
        self._bus = room.open()
        self._log: Subscription = self._bus.subscribe(topics.fusion_log(), keep=1000)
        self._live: Subscription = self._bus.subscribe(topics.motion("live"), keep=100_000)
        self._writer = writer
        self.parts: list[FusionLog] = []

    def record(self, parts: int, gap: str = "") -> None:
        """A segment of so many parts."""
        request = codec.encode(SegmentRequest(time.monotonic_ns()))
        first = len(self.parts)

        def done() -> bool:
            self._bus.publish(topics.segment_request(), request)
            if (delivery := self._log.receive(0.2)) is not None:
                part = codec.decode(delivery.payload, FusionLog)
                if part.segment_ns >= codec.decode(request, SegmentRequest).t_ns:
                    self._writer.append(part, gap if len(self.parts) == first else "")
                    self.parts.append(part)
            return len(self.parts) - first >= parts

        until(done, f"{parts} parts of fusion's log")

    def live_motions(self) -> list[Motion]:
        """All live motions that were published."""
        found = []
        while (delivery := self._live.receive(0.0)) is not None:
            found.append(codec.decode(delivery.payload, Motion))
        return found


@contextmanager
def fusion(room: Opens, data: Path) -> Iterator[Bus]:
    """Fusion's process in this room, until the end of the block."""
    stop = threading.Event()
    bus = room.open()
    context = ProcessContext(
        name="fusion",
        camera=None,
        site=SITE,
        rig=RIG,
        data=data,
        start_ns=time.monotonic_ns(),
        bus=bus,
        stop=stop,
        resources=lambda: Resources(0.1, 100.0),
    )
    thread = threading.Thread(target=FusionLoop(context, CpuMeter()).run, daemon=True)
    thread.start()
    try:
        yield bus
    finally:
        stop.set()
        thread.join(DEADLINE_S)
        assert not thread.is_alive(), "the loop did not honour stop"
        bus.close()
