"""The recorder without its bus: lessons begin and end, parts of fusion's log are written, trouble is told.

A lesson ends when a person says so, when the box ends, and when the disk is full or broken or the file is taken away: then it is
finished as well as it can be, and the box goes on. What cannot be finished is handed over to `recovery.py`, which tries it again.
A lesson that was cut short by the recorder's own death is gone on with, without a gap as long as fusion still has what was missed.
"""

import datetime as dt
import re
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import structlog

from models.config.site import LessonsConfig
from models.errors import UserError
from models.messages.health import RecorderHealth
from models.messages.lesson import FusionLog, SegmentRequest
from models.messages.trouble import Trouble
from services.lesson import told_to_stop
from services.lesson.disk_room import make_room, shortage
from services.lesson.folder_lock import is_locked, lock
from services.lesson.following import Following
from services.lesson.free_names import numbered
from services.lesson.index import LessonIndex
from services.lesson.layout import PART_SUFFIX
from services.lesson.lesson_file import LessonWriter, lesson_of
from services.lesson.lesson_header import LessonHeader
from services.lesson.recovery import Left
from services.support.machine import free_disk_mib
from services.support.no_room import is_no_room

AUTOMATIC_TITLE = "Recorded automatically"
SILENT_NS = 5_000_000_000
"""If nothing came from fusion for so long, the recording is standing still."""
RETRY_NS = 30_000_000_000
"""An automatic recording that had to end is tried again after this."""

log = structlog.get_logger()

_NAME_LENGTH = 40
_MEND = "put the disk back, mend or replace it"
_TAKEN_AWAY = "its file was removed, renamed or replaced"
_LEAVE_ALONE = f"leave files that end with '{PART_SUFFIX}' alone, and begin another lesson"


def _never() -> bool:
    return False


@dataclass
class _Running:
    writer: LessonWriter
    following: Following
    heard_ns: int
    asked_ns: int


class Recorder:
    """One lesson after the other.

    Args:
        folder: of the lessons, locked; it is made and locked anew for the next lesson if somebody took it away.
        config: of the site.
        header: the header of a lesson of this title that begins now.
        run_ns: CLOCK_MONOTONIC at the start of this run of the box.
        left: takes a lesson that cannot be finished, and tries it again.
        unfinished: a lesson to go on with; None if there is none.
        clock_ns: CLOCK_MONOTONIC.
    """

    def __init__(
        self,
        folder: Path,
        config: LessonsConfig,
        header: Callable[[str], LessonHeader],
        run_ns: int,
        left: Left,
        unfinished: LessonWriter | None = None,
        clock_ns: Callable[[], int] = time.monotonic_ns,
    ) -> None:
        self._folder = folder
        self._config = config
        self._header = header
        self._run_ns = run_ns
        self._left = left
        self._clock_ns = clock_ns
        by_itself = config.automatic and not told_to_stop.is_noted(folder, run_ns)
        self._automatic_ns: int | None = clock_ns() if by_itself else None
        self._ended: Trouble | None = None
        self._is_over: Callable[[], bool] = _never
        """Whether `_ended` needs not be said any more, although no other lesson has begun."""
        self._lacking = ""  # Why the disk would take no lesson; looked at while there is none.
        self._running: _Running | None = None
        self._lock: BinaryIO | None = None
        if unfinished is not None:
            self._begin(unfinished, "the recorder was started again")

    def start(self, title: str, asked_ns: int = 0) -> None:
        """Begin a lesson, unless one is being recorded; `asked_ns` names who asked for it."""
        if self._running is not None:
            return
        if lacking := self._shortage():
            self._trouble(f"no lesson was begun: {lacking}", self._make_room(), lambda: not self._shortage())
            return
        header = self._header(title)
        try:
            writer = self._create(header)
        except OSError as error:
            remedy = self._make_room() if is_no_room(error) else "correct lessons.folder or the folder's rights, or mend its disk"
            self._trouble(f"no lesson was begun: {error.strerror} at {self._folder}", remedy)
            return
        except UserError as error:
            self._trouble(f"no lesson was begun: {error}", "")
            return
        self._all_is_well()
        self._begin(writer, asked_ns=asked_ns)
        log.info("lesson begins", lesson=_name(writer), title=title)

    def stop(self, lesson: str = "") -> None:
        """End the lesson, if one is being recorded; in this run no automatic one begins any more.

        Who wishes it goes on until it is done: then nothing is unsaid about how it ended.

        Args:
            lesson: the one to end, if only this one shall be; another one goes on.
        """
        if lesson and (self._running is None or _name(self._running.writer) != lesson):
            return
        if self._automatic_ns is not None:
            self._automatic_ns = None
            self._note_wish()
        if self._running is not None:
            self._all_is_well()
        self._finish()

    def close(self) -> None:
        """The box ends: the lesson is finished."""
        self._finish()
        self._unlock()

    def take(self, part: FusionLog) -> None:
        """A part of fusion's log was heard."""
        running, now_ns = self._running, self._clock_ns()
        if running is None:
            return
        if part.latest_ns > now_ns:
            # It would date everything that comes after it, since times in a file never go back.
            log.warning("part of fusion's log from the future left out", lesson=_name(running.writer), sequence=part.sequence)
            return
        accepted = running.following.hear(part)
        if accepted is None:
            return
        running.heard_ns = now_ns
        try:
            running.writer.append(part, accepted.gap)
        except OSError as error:
            self._finish(error.strerror or str(error), self._against(error))
            return
        if accepted.gap:
            log.warning("gap in the lesson", lesson=_name(running.writer), reason=accepted.gap)

    @property
    def request(self) -> SegmentRequest | None:
        """What fusion shall be asked for; None while nothing is recorded."""
        return None if self._running is None else self._running.following.request

    def look_after(self) -> None:
        """Once a second: watch disk and file, begin what is automatic."""
        if self._running is None and self._automatic_ns is not None and self._clock_ns() >= self._automatic_ns:
            self.start(AUTOMATIC_TITLE)
        if self._is_over():
            self._all_is_well()
        if self._running is None:
            self._lacking = self._shortage()
            return
        try:
            in_place = self._running.writer.in_place
        except OSError as error:
            self._finish(error.strerror or str(error), self._against(error))
            return
        if not in_place:
            self._finish()
            return
        if lacking := self._shortage():
            self._finish(lacking, self._make_room())

    @property
    def trouble(self) -> Trouble | None:
        """What is wrong; None if nothing is."""
        running = self._running
        if running is None:
            return self._ended or self._no_room()
        if self._clock_ns() - running.heard_ns > SILENT_NS:
            words = f"lesson {_name(running.writer)} stands still: nothing is heard of fusion"
            return Trouble("recording_stalled", words, "wait some seconds: it goes on when the figure does")
        return None

    def health(self) -> RecorderHealth:
        """What is being recorded."""
        running = self._running
        if running is None:
            return RecorderHealth(lesson="", title="", recorded_s=0.0, size_bytes=0, gaps=0)
        writer = running.writer
        return RecorderHealth(
            lesson=_name(writer),
            title=writer.header.title,
            recorded_s=writer.recorded_s,
            size_bytes=writer.size,
            gaps=writer.gaps,
            began_ns=writer.header.started_ns,
            attempts=writer.attempts,
            newest=writer.newest_attempts,
            asked_ns=running.asked_ns,
        )

    def _note_wish(self) -> None:
        try:
            told_to_stop.note(self._folder, self._run_ns)
        except OSError as error:
            words = "that no lesson shall begin by itself could not be noted: if the recorder is started again, one does"
            log.warning(words, folder=str(self._folder), reason=error.strerror)

    def _begin(self, writer: LessonWriter, gap: str = "", asked_ns: int = 0) -> None:
        now_ns = self._clock_ns()
        segment_ns, _ = writer.position
        if not segment_ns:
            gap = ""  # Before the first part nothing is missing.
        self._running = _Running(writer, Following(now_ns, gap, *writer.position), heard_ns=now_ns, asked_ns=asked_ns)

    def _finish(self, why: str = "", remedy: str = "") -> None:
        """End the lesson; `why` it had to end, if nobody wished it, and what to do."""
        running, self._running = self._running, None
        if running is None:
            return
        writer = running.writer
        name = _name(writer)
        if why:
            self._trouble(f"lesson {name} ended: {why}", remedy)
        try:
            path = writer.finish()
        except FileNotFoundError:
            writer.close()
            self._trouble(f"lesson {name} ended: {_TAKEN_AWAY}", _LEAVE_ALONE)
            return
        except OSError as error:
            writer.close()
            self._left.hand_over(writer, error)
            # Who wished its end is told that it is not finished; why it had to end is to be known also when it is.
            words = f"lesson {name} ended: {why or error.strerror or error}"
            lesson = lesson_of(writer.path)
            is_over = _never if why else lambda: not self._left.waits(lesson)
            self._trouble(words, remedy or self._against(error), is_over)
            return
        LessonIndex(self._folder).note(writer, path)
        log.info("lesson ends", lesson=name, seconds=round(writer.recorded_s, 1), mb=round(writer.size / 1e6, 2), gaps=writer.gaps)

    def _trouble(self, words: str, remedy: str, is_over: Callable[[], bool] = _never) -> None:
        """Say it until another lesson begins, or it is over."""
        trouble = Trouble("not_recording", words, remedy)
        if trouble != self._ended:
            log.warning("not recording", reason=words, remedy=remedy)
        self._ended, self._is_over = trouble, is_over
        if self._automatic_ns is not None:
            self._automatic_ns = self._clock_ns() + RETRY_NS

    def _all_is_well(self) -> None:
        self._ended, self._is_over = None, _never

    def _against(self, error: OSError) -> str:
        return self._make_room() if is_no_room(error) else _MEND

    def _make_room(self) -> str:
        return make_room(self._folder, self._config)

    def _no_room(self) -> Trouble | None:
        """Said before anybody is refused; not as "not_recording", by which who asked for a lesson knows that it failed."""
        return Trouble("disk_full", f"no lesson can be begun: {self._lacking}", self._make_room()) if self._lacking else None

    def _shortage(self) -> str:
        return shortage(free_disk_mib(self._folder), self._config)

    def _create(self, header: LessonHeader) -> LessonWriter:
        if not is_locked(self._folder):
            self._unlock()
            self._lock = lock(self._folder)
        taken = {path.name.split(".")[0] for path in self._folder.iterdir()}
        return LessonWriter.create(self._folder, lesson_name(header, taken), header)

    def _unlock(self) -> None:
        if self._lock is not None:
            self._lock.close()
            self._lock = None


def lesson_name(header: LessonHeader, taken: set[str]) -> str:
    """A new name for a lesson: when it began, in local time, and what people call it; of letters, digits and hyphens."""
    began = dt.datetime.fromtimestamp(header.started_s, tz=dt.UTC).astimezone()
    words = re.sub(r"[\W_]+", "-", header.title.lower())[:_NAME_LENGTH].strip("-")
    names = numbered(f"{began:%Y-%m-%d-%H%M}{'-' if words else ''}{words}")
    return next(name for name in names if name not in taken)


def _name(writer: LessonWriter) -> str:
    return writer.path.name.split(".")[0]
