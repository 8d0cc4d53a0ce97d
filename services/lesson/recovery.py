"""What a crash left is made whole again: cut after its last whole chunk, and then finished or gone on with.

A crash leaves the beginning of one chunk behind the last whole one, and nothing but that is thrown away: of a file that is damaged
in any other way, a copy is kept beside what was recovered. A lesson that was ended is only finished: nobody is recorded who was
told that the recording is over. No file is overwritten, and one of a newer KineBox is left as it is.

To read eight hours of lesson takes eight seconds of a fast core, and on a school's box longer than the twenty that fusion keeps for
a recorder that returns: so the lesson that goes on is looked for first, and the others are completed beside it.

A disk that is full or away may have room or be back at any time, and a box runs for weeks: what cannot be finished is tried again.
"""

import contextlib
import errno
import math
import os
import shutil
import threading
import time
from pathlib import Path
from typing import NamedTuple

import structlog

from models.errors import UserError
from models.messages.trouble import Trouble
from services.lesson.folder_lock import is_locked
from services.lesson.free_names import rename_free, reserve
from services.lesson.index import LessonIndex
from services.lesson.layout import PART_SUFFIX
from services.lesson.lesson_file import ENDED_SUFFIX, LessonWriter, lesson_of, mark_ended
from services.lesson.lesson_reader import NewerLessonError, read_header
from services.lesson.readable_names import is_readable, readable
from services.lesson.survey import StoppedError, survey
from services.support.no_room import is_no_room
from services.support.sync import sync_folder

DAMAGED_SUFFIX = f"{PART_SUFFIX}.damaged"
RETRY_S = 30.0
"""A lesson that could not be finished is tried again after this."""

_REST = 20
"""It takes a core no more than one part in so many to read again and again what cannot be finished."""
_MENDS_ITSELF = "nothing of it is lost: it is finished by itself once its disk is there, has room and can be written to"

log = structlog.get_logger()


class _Failure(NamedTuple):
    """Why a lesson could not be finished when it was tried last; `lacks_bytes` is the room that it needs, if that is why."""

    why: str = ""
    lacks_bytes: int = 0


class Left:
    """Lessons that wait to be finished: those that are in a folder before a recorder begins there, and those that it hands over.

    They may be handed over and asked about on one thread while they are completed on another.
    """

    def __init__(self, folder: Path) -> None:
        self._why = {path: _Failure() for path in sorted(folder.glob(f"*{PART_SUFFIX}")) if _is_lesson(path)}
        """Empty before it was tried."""
        self._lock = threading.Lock()

    def hand_over(self, writer: LessonWriter, error: OSError) -> None:
        """A lesson that was ended could not be finished, and its file is closed."""
        with self._lock:
            self._why[writer.path] = _failure(error, writer.to_finish)

    def waits(self, lesson: str) -> bool:
        """Whether the lesson of that name is not finished yet."""
        with self._lock:
            return any(lesson_of(path) == lesson for path in self._why)

    @property
    def trouble(self) -> Trouble | None:
        """Which lessons could not be finished, and why not; None if there are none. It keeps nobody from recording."""
        with self._lock:
            tried = [(path, failure) for path, failure in self._why.items() if failure.why]
        if not tried:
            return None
        (path, failure), *others = tried
        which = f"{lesson_of(path)} and {len(others)} more are" if others else f"{lesson_of(path)} is"
        words = f"lesson {which} not finished yet: {failure.why}"
        lacks_bytes = sum(each.lacks_bytes for _, each in tried)
        if not lacks_bytes:
            return Trouble("recording_stalled", words, _MENDS_ITSELF)
        words += f"; {'they need' if others else 'it needs'} {math.ceil(lacks_bytes / 1e6)} MB of room"
        return Trouble("recording_stalled", words, f"make so much room on the disk of {path.parent}; {_MENDS_ITSELF}")

    def cut_short(self, run_ns: int) -> LessonWriter | None:
        """Open the newest one that was begun in this run of the box and not ended: its recorder died while it was being recorded.

        Of a lesson of another run no more is read than its header.

        Args:
            run_ns: CLOCK_MONOTONIC at the start of this run of the box.

        Returns:
            The lesson, to be gone on with; None if there is none.
        """
        begun = [(began_ns, path) for path in self._why if (began_ns := _began_ns(path, run_ns)) is not None]
        for _, path in sorted(begun, reverse=True):
            writer = self._opened(path)
            if writer is not None and not writer.ended:
                self._done(path)
                log.info("lesson recovered", lesson=path.name, mb=_mb(writer))
                return writer
            if writer is not None:
                self._finish(path, writer)
        return None

    def keep_completing(self, stop: threading.Event) -> None:
        """As `complete`, again and again until `stop` is set."""
        while not stop.is_set():
            in_vain_s = self.complete(stop)
            stop.wait(max(RETRY_S, _REST * in_vain_s))

    def complete(self, stop: threading.Event) -> float:
        """Finish all others that can be finished now. Once `stop` is set the rest stay as they are, until the next start.

        Returns:
            Seconds that went into those that cannot be finished.
        """
        in_vain_s = 0.0
        with self._lock:
            paths = list(self._why)
        for path in paths:
            began_s = time.monotonic()
            try:
                writer = self._opened(path, stop)
            except StoppedError:
                break
            if writer is None or not self._finish(path, writer):
                in_vain_s += time.monotonic() - began_s
        return in_vain_s

    def _opened(self, path: Path, stop: threading.Event | None = None) -> LessonWriter | None:
        """As `_reopened`, and None of one that cannot be read or written now: that one waits on, unless somebody removed it."""
        try:
            writer = _reopened(path, stop)
        except OSError as error:
            self._failed(path, path, error, _size(path))  # Of a damaged one, a copy is to be kept.
            return None
        if writer is None:
            self._done(path)
        return writer

    def _finish(self, path: Path, writer: LessonWriter) -> bool:
        """Finish what was opened from `path`; whether that could be done. If not, it waits on."""
        try:
            finished = writer.finish()
        except OSError as error:
            writer.close()
            self._failed(path, writer.path, error, writer.to_finish)
            return False
        self._done(path)
        LessonIndex(finished.parent).note(writer, finished)
        log.info("lesson recovered", lesson=path.name, mb=_mb(writer))
        return True

    def _done(self, path: Path) -> None:
        with self._lock:
            del self._why[path]

    def _failed(self, path: Path, path_now: Path, error: OSError, to_write: int) -> None:
        """It could not be finished, and may have another name since it was marked as ended; a new reason is said once.

        Args:
            path: under which it waits.
            path_now: its path.
            error: why not.
            to_write: bytes that are to be written of it.
        """
        if isinstance(error, FileNotFoundError) and _was_removed(path_now):
            log.info("an unfinished lesson was taken away", lesson=path.name)
            self._done(path)
            return
        failure = _failure(error, to_write)
        with self._lock:
            before = self._why.pop(path)
            self._why[path_now] = failure
        if failure.why != before.why:
            log.warning("a lesson could not be finished; it is tried again", lesson=path_now.name, reason=str(error))


def _failure(error: OSError, to_write: int) -> _Failure:
    return _Failure(error.strerror or str(error), to_write if is_no_room(error) else 0)


def _size(path: Path) -> int:
    try:
        return path.stat().st_size
    except OSError:
        return 0


def _is_lesson(path: Path) -> bool:
    """Whether a file with an unfinished lesson's name can be one; says so if not."""
    if not is_readable(path.name):
        log.warning("an unfinished lesson waits for a name in UTF-8", lesson=readable(path.name), remedy="rename the file")
        return False
    if not path.is_file():
        log.warning("what has an unfinished lesson's name is no file", lesson=path.name, remedy="remove it")
        return False
    return True


def _began_ns(path: Path, run_ns: int) -> int | None:
    """When a lesson began that may be gone on with; None of one that was ended or is of another run."""
    if path.name.endswith(ENDED_SUFFIX):
        return None
    try:
        with path.open("rb") as file:
            header = read_header(path, file)
    except (OSError, UserError):
        return None  # What is wrong is said when it is to be completed.
    return header.started_ns if header.run_ns == run_ns else None


def _reopened(path: Path, stop: threading.Event | None) -> LessonWriter | None:
    """As `reopen`; None, having said so, of a file that this KineBox cannot recover, or in which there is nothing to recover."""
    if path.stat().st_size == 0:  # The crash came before the lesson's first byte, or before it was given this name.
        path.unlink()
        log.info("an empty file was removed", lesson=path.name)
        return None
    try:
        return reopen(path, stop)
    except NewerLessonError as error:
        log.warning("an unfinished lesson waits for an update", lesson=path.name, reason=str(error))
    except UserError as error:
        kept = rename_free(path, lesson_of(path), DAMAGED_SUFFIX)
        log.warning("nothing could be recovered", lesson=path.name, kept=kept.name, reason=str(error))
    return None


def reopen(path: Path, stop: threading.Event | None = None) -> LessonWriter:
    """Open an unfinished lesson after its last whole chunk; what lies behind that is cut off.

    One whose summary was begun is marked as ended.

    Raises:
        StoppedError: `stop` was set before it was read; it is as it was.
        NewerLessonError: this KineBox does not know the file's format.
        UserError: the file has no header that can be read, so there is nothing to recover.
        OSError: it cannot be read or written, or there is no room for the copy of a damaged one; it is as it was.
    """
    name = path
    file = path.open("r+b", buffering=0)
    try:
        header = read_header(path, file)
        contents, damage, ended = survey(file, stop)
        if ended:
            path = mark_ended(path)  # Before its summary, which says so as well, is cut off.
        if damage:
            kept = _keep(path)
            log.warning("lesson damaged", lesson=path.name, kept=kept.name, reason=damage)
        if not contents.chunks:
            writer = LessonWriter.create_over(path, header)
            file.close()
            return writer
        file.seek(contents.end)
        file.truncate()
    except BaseException:
        file.close()
        with contextlib.suppress(OSError):  # By its old name it is tried again; its summary still says that it was ended.
            path.rename(name)
        raise
    return LessonWriter(path, file, header, contents)


def _keep(path: Path) -> Path:
    """Copy a damaged file beside itself; the copy is safe when this returns."""
    if shutil.disk_usage(path.parent).free < path.stat().st_size:
        # A copy that is begun in vain again and again would take the last room from the lesson that is recorded.
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
    kept = reserve(path.parent, lesson_of(path), DAMAGED_SUFFIX)
    try:
        shutil.copyfile(path, kept)
        with kept.open("rb") as copy:
            os.fsync(copy.fileno())
        sync_folder(kept.parent)
    except OSError:
        kept.unlink(missing_ok=True)
        raise
    return kept


def _was_removed(path: Path) -> bool:
    """Whether a file is away, and not the disk on which it is."""
    try:
        return is_locked(path.parent) and not path.exists()
    except OSError:
        return False


def _mb(writer: LessonWriter) -> float:
    return round(writer.size / 1e6, 2)
