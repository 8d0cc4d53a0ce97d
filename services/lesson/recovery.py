"""What a crash left is made whole again: cut after its last whole chunk, and then finished or gone on with.

A crash leaves the beginning of one chunk behind the last whole one, and nothing but that is thrown away: of a file that is damaged
in any other way, a copy is kept beside what was recovered. A lesson that was ended is only finished: nobody is recorded who was
told that the recording is over. No file is overwritten, and one of a newer KineBox is left as it is.
"""

import os
import shutil
from pathlib import Path

import structlog

from models.errors import UserError
from services.lesson.free_names import rename_free, reserve
from services.lesson.index import LessonIndex
from services.lesson.layout import PART_SUFFIX
from services.lesson.lesson_file import LessonWriter, lesson_of, mark_ended
from services.lesson.lesson_reader import NewerLessonError, read_header
from services.lesson.readable_names import is_readable, readable
from services.lesson.survey import survey
from services.support.sync import sync_folder

DAMAGED_SUFFIX = f"{PART_SUFFIX}.damaged"
log = structlog.get_logger()


def recover(folder: Path, run_ns: int) -> LessonWriter | None:
    """Make every unfinished lesson of a folder whole. Nobody may be writing there.

    Args:
        folder: of the lessons.
        run_ns: CLOCK_MONOTONIC at the start of this run of the box.

    Returns:
        The newest lesson that was begun in this run and not ended, still open, since the recorder died while it was being
        recorded; None if there is none. All others are finished.
    """
    goes_on: LessonWriter | None = None
    for path in sorted(folder.glob(f"*{PART_SUFFIX}")):
        if not is_readable(path.name):
            log.warning("an unfinished lesson waits for a name in UTF-8", lesson=readable(path.name), remedy="rename the file")
            continue
        if not path.is_file():
            log.warning("what has an unfinished lesson's name is no file", lesson=path.name, remedy="remove it")
            continue
        try:
            writer = _reopened(path)
        except OSError as error:
            log.warning("a lesson could not be recovered", lesson=path.name, reason=str(error))
            continue
        if writer is None:
            continue
        log.info("lesson recovered", lesson=path.name, mb=round(writer.size / 1e6, 2))
        cut_short = writer.header.run_ns == run_ns and not writer.ended
        if cut_short and (goes_on is None or writer.header.started_ns > goes_on.header.started_ns):
            goes_on, writer = writer, goes_on
        if writer is not None:
            _finish(writer)
    return goes_on


def _reopened(path: Path) -> LessonWriter | None:
    """As `reopen`; None, having said so, of a file that this KineBox cannot recover, or in which there is nothing to recover."""
    if path.stat().st_size == 0:  # The crash came before the lesson's first byte, or before it was given this name.
        path.unlink()
        log.info("an empty file was removed", lesson=path.name)
        return None
    try:
        return reopen(path)
    except NewerLessonError as error:
        log.warning("an unfinished lesson waits for an update", lesson=path.name, reason=str(error))
    except UserError as error:
        kept = rename_free(path, lesson_of(path), DAMAGED_SUFFIX)
        log.warning("nothing could be recovered", lesson=path.name, kept=kept.name, reason=str(error))
    return None


def reopen(path: Path) -> LessonWriter:
    """Open an unfinished lesson after its last whole chunk; what lies behind that is cut off.

    One whose summary was begun is marked as ended.

    Raises:
        NewerLessonError: this KineBox does not know the file's format.
        UserError: the file has no header that can be read, so there is nothing to recover.
        OSError: it cannot be read or written, or there is no room for the copy of a damaged one; it is as it was.
    """
    file = path.open("r+b", buffering=0)
    try:
        header = read_header(path, file)
        contents, damage, ended = survey(file)
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
