"""The recorder process: parts of fusion's log and people's wishes in; files, requests to fusion and health out."""

import threading
import time
from pathlib import Path

import structlog

from models.camera.rig import encode_rig
from models.messages import codec, topics
from models.messages.lesson import FusionLog, LessonRequest
from models.messages.trouble import Trouble, messages_refused
from models.process import Delivery, ProcessContext
from services.lesson import origin
from services.lesson.asking import Asking
from services.lesson.disk_wait import LONGEST_S, DiskWait
from services.lesson.folder_lock import lock
from services.lesson.lesson_header import LessonHeader
from services.lesson.recorder import Recorder
from services.lesson.recovery import Left
from services.site_file.rendering import render
from services.support.getting_ready import getting_ready
from services.support.health import HealthReporter, ResourceMeter
from services.support.machine import clocks_ns
from services.support.version import kinebox_version

KEEP = 64
"""Unread parts: fusion sends up to 40 (20 s) again in one go, and new ones come in between."""
_ROUND_S = 0.1
_DISK = (
    f"what is missed within {LONGEST_S:.0f} s is made up for; if it comes again, see what else writes on that disk, "
    "or take a faster one"
)

log = structlog.get_logger()


def main(context: ProcessContext) -> None:
    """Record when asked, until told to stop.

    Raises:
        UserError: the folder of lessons cannot be used.
    """
    folder = context.data / context.site.lessons.folder
    with lock(folder):
        RecorderLoop(context, folder).run()


class RecorderLoop:
    """The loop of `main`, with everything from outside passed in."""

    def __init__(self, context: ProcessContext, folder: Path) -> None:
        self._context = context
        self._bus = context.bus
        self._machine = origin.machine()
        self._rejected = 0
        self._reporter = HealthReporter(context.name, context.bus, context.resources)
        # Listening first, so that a wish that is uttered while a lesson is recovered is not lost.
        self._subscription = self._bus.subscribe(topics.fusion_log(), topics.lesson_request(), keep=KEEP)
        self._left = Left(folder)
        with getting_ready(context.name, self._bus, "the lesson that was cut short is read"):
            unfinished = self._left.cut_short(context.start_ns)
        self._recorder = Recorder(folder, context.site.lessons, self._header, context.start_ns, self._left, unfinished)
        self._asking = Asking()
        self._told = self._recorder.health()
        self._stand_in = HealthReporter(context.name, context.bus, ResourceMeter())

    def run(self) -> None:
        """Take what comes; ask fusion for its log while recording; once a second, say how things are.

        Beside that, lessons of other runs and those that could not be finished are completed: nobody in the room waits for them.
        """
        self._bus.declare_alive(topics.alive(self._context.name))
        beside = threading.Thread(target=self._left.keep_completing, args=(self._context.stop,), name="recovery", daemon=True)
        beside.start()
        with DiskWait(self._disk_waits) as disk:
            try:
                while not self._context.stop.is_set():
                    delivery = self._subscription.receive(_ROUND_S)
                    if delivery is not None:
                        with disk.at_work():
                            self._receive(delivery)
                    if self._reporter.due():
                        with disk.at_work():
                            self._second_passed()
                    if self._asking.due(time.monotonic_ns()):
                        self._ask()
            finally:
                with disk.at_work():
                    self._recorder.close()
                self._subscription.close()
        beside.join()

    def _receive(self, delivery: Delivery) -> None:
        try:
            if delivery.topic == topics.fusion_log():
                self._recorder.take(codec.decode(delivery.payload, FusionLog))
                self._asking.heard(time.monotonic_ns())
                return
            wish = codec.decode(delivery.payload, LessonRequest)
        except codec.CodecError as error:
            if self._rejected == 0:
                log.warning("message refused", topic=delivery.topic, reason=str(error))
            self._rejected += 1
            return
        if wish.action == "start":
            self._recorder.start(wish.title, wish.t_ns)
        else:
            self._recorder.stop(wish.lesson)
        self._second_passed()  # Who wished it is waiting to hear that it was done.
        self._ask()

    def _ask(self) -> None:
        request = self._recorder.request
        if request is not None:
            self._bus.publish(topics.segment_request(), codec.encode(request))

    def _second_passed(self) -> None:
        self._recorder.look_after()
        refused = messages_refused(self._rejected) if self._rejected else None
        troubles = tuple(filter(None, (self._recorder.trouble, self._left.trouble, refused)))
        self._rejected = 0
        self._told = self._recorder.health()
        self._reporter.report("degraded" if troubles else "ok", troubles, recorder=self._told)

    def _disk_waits(self, waited_s: float) -> None:
        """Called beside the loop, which is held up: what it said last is still so."""
        if self._stand_in.due():
            words = f"the disk with the lessons has held up the recorder for {waited_s:.0f} s"
            self._stand_in.report("degraded", (Trouble("recording_stalled", words, _DISK),), recorder=self._told)

    def _header(self, title: str) -> LessonHeader:
        wall_ns, monotonic_ns = clocks_ns()
        return LessonHeader(
            title=title,
            kinebox=kinebox_version(),
            machine=self._machine,
            preset=self._context.site.fusion.preset,
            site_toml=render(self._context.site),
            rig_toml=encode_rig(self._context.rig, "the calibration in use when the lesson was recorded").decode(),
            started_ns=monotonic_ns,
            wall_minus_monotonic_ns=wall_ns - monotonic_ns,
            run_ns=self._context.start_ns,
        )
