"""What a crash left is made whole again: cut after its last whole chunk, and then finished or gone on with.

A crash leaves the beginning of one chunk behind the last whole one, and nothing but that is thrown away: of a file that is damaged
in any other way, a copy is kept beside what was recovered. A lesson that was ended is only finished: nobody is recorded who was
told that the recording is over. No file is overwritten, and one of a newer KineBox is left as it is.

To read eight hours of lesson takes eight seconds of a fast core, and on a school's box longer than the twenty that fusion keeps for
a recorder that returns: so the lesson that goes on is looked for first, and the others are completed beside it.
"""

import os
import shutil
import threading
from pathlib import Path

import structlog

from models.errors import UserError
from services.lesson.free_names import rename_free, reserve
from services.lesson.index import LessonIndex
from services.lesson.layout import PART_SUFFIX
from services.lesson.lesson_file import ENDED_SUFFIX, LessonWriter, lesson_of, mark_ended
from services.lesson.lesson_reader import NewerLessonError, read_header
from services.lesson.readable_names import is_readable, readable
from services.lesson.survey import StoppedError, survey
from services.support.sync import sync_folder

DAMAGED_SUFFIX = f"{PART_SUFFIX}.damaged"
log = structlog.get_logger()


class Left:
    """The unfinished lessons that are in a folder before a recorder begins there. One that begins later is none of them."""

    def __init__(self, folder: Path) -> None:
        self._paths = [path for path in sorted(folder.glob(f"*{PART_SUFFIX}")) if _is_lesson(path)]

    def cut_short(self, run_ns: int) -> LessonWriter | None:
        """Open the newest one that was begun in this run of the box and not ended: its recorder died while it was being recorded.

        Of a lesson of another run no more is read than its header.

        Args:
            run_ns: CLOCK_MONOTONIC at the start of this run of the box.

        Returns:
            The lesson, to be gone on with; None if there is none.
        """
        begun = [(began_ns, path) for path in self._paths if (began_ns := _began_ns(path, run_ns)) is not None]
        for _, path in sorted(begun, reverse=True):
            self._paths.remove(path)
            writer = _recovered(path)
            if writer is not None and not writer.ended:
                return writer
            if writer is not None:
                _finish(writer)
        return None

    def complete(self, stop: threading.Event) -> None:
        """Finish all others. Once `stop` is set the rest stay as they are, until the next start."""
        for path in self._paths:
            try:
                writer = _recovered(path, stop)
            except StoppedError:
                return
            if writer is not None:
                _finish(writer)


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


def _recovered(path: Path, stop: threading.Event | None = None) -> LessonWriter | None:
    """As `_reopened`, and None, having said so, of one that cannot be read or written now; it is tried again at the next start."""
    try:
        writer = _reopened(path, stop)
    except OSError as error:
        log.warning("a lesson could not be recovered", lesson=path.name, reason=str(error))
        return None
    if writer is not None:
        log.info("lesson recovered", lesson=path.name, mb=round(writer.size / 1e6, 2))
    return writer


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
            file.close()
            path.unlink()
            return LessonWriter.create(path.parent, path.name.removesuffix(PART_SUFFIX), header)
        file.seek(contents.end)
        file.truncate()
    except BaseException:
        file.close()
        raise
    return LessonWriter(path, file, header, contents)


def _keep(path: Path) -> Path:
    """Copy a damaged file beside itself; the copy is safe when this returns."""
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


def _finish(writer: LessonWriter) -> None:
    try:
        path = writer.finish()
    except OSError as error:
        writer.close()
        log.warning("a recovered lesson could not be finished", lesson=writer.path.name, reason=str(error))
    else:
        LessonIndex(path.parent).note(writer, path)
