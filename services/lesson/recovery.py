"""What a crash left is made whole again: cut after its last whole chunk, and then finished or gone on with.

Nothing is thrown away but the beginning of one chunk: of a file that is damaged otherwise, the whole is kept beside what was
recovered.
"""

import shutil
from pathlib import Path
from typing import BinaryIO

import structlog
from mcap.opcode import Opcode
from mcap.records import Chunk, MetadataIndex

from models.errors import UserError
from services.lesson import lesson_header
from services.lesson.index import LessonIndex
from services.lesson.layout import PART_SUFFIX, Mark
from services.lesson.lesson_file import Contents, LessonWriter
from services.lesson.lesson_reader import PartDecoder, read_header
from services.lesson.mcap_records import DamageError, messages, parse, walk

DAMAGED_SUFFIX = ".damaged"
_LARGEST_TAIL = 2 * 2**20
"""A crash leaves no more behind the last whole chunk; if there is more, the damage is another, and a copy is kept."""
log = structlog.get_logger()

_BEGINNING = (Opcode.HEADER, Opcode.METADATA, Opcode.SCHEMA, Opcode.CHANNEL)


def recover(folder: Path, run_ns: int) -> LessonWriter | None:
    """Make every unfinished lesson of a folder whole. Nobody may be writing there.

    Args:
        folder: of the lessons.
        run_ns: CLOCK_MONOTONIC at the start of this run of the box.

    Returns:
        The newest lesson that was begun in this run, still open, since the recorder died while it was being recorded; None if
        there is none. All others are finished.
    """
    goes_on: LessonWriter | None = None
    for path in sorted(folder.glob(f"*{PART_SUFFIX}")):
        try:
            writer = reopen(path)
        except UserError as error:
            path.rename(path.with_name(path.name + DAMAGED_SUFFIX))
            log.warning("nothing could be recovered", lesson=path.name, reason=str(error))
            continue
        except OSError as error:
            log.warning("a lesson could not be recovered", lesson=path.name, reason=str(error))
            continue
        log.info("lesson recovered", lesson=path.name, mb=round(writer.size / 1e6, 2))
        if writer.header.run_ns == run_ns and (goes_on is None or writer.header.started_ns > goes_on.header.started_ns):
            goes_on, writer = writer, goes_on
        if writer is not None:
            _finish(writer)
    return goes_on


def reopen(path: Path) -> LessonWriter:
    """Open an unfinished lesson after its last whole chunk; what lies behind that is cut off.

    Raises:
        UserError: the file has no header that can be read, so there is nothing to recover.
        OSError: it cannot be read or written.
    """
    file = path.open("r+b", buffering=0)
    try:
        header = read_header(path, file)
        contents = survey(file)
        if not contents.chunks:
            file.close()
            path.unlink()
            return LessonWriter.create(path.parent, path.name.removesuffix(PART_SUFFIX), header)
        if path.stat().st_size - contents.end > _LARGEST_TAIL:
            shutil.copyfile(path, path.with_name(path.name + DAMAGED_SUFFIX))
        file.seek(contents.end)
        file.truncate()
    except BaseException:
        file.close()
        raise
    return LessonWriter(path, file, header, contents)


def survey(file: BinaryIO) -> Contents:
    """What a file with a good header holds, up to its first damage or, if there is none, its summary."""
    contents, decoder = Contents(), PartDecoder()
    file.seek(0)
    try:
        for place in walk(file):
            if place.opcode == Opcode.METADATA:
                contents.metadata = MetadataIndex(place.start, place.end - place.start, lesson_header.NAME)
            if place.opcode == Opcode.CHUNK:
                part = decoder.decode(place)
                mark = Mark(part.segment_ns, part.sequence, part.gap)
                contents.take_chunk(place.start, place.end - place.start, parse(Chunk, place), messages(place), mark)
            elif contents.chunks or place.opcode not in _BEGINNING:
                break
            contents.end, contents.checksum = place.end, place.checksum
    except DamageError:
        pass  # Here the file ends.
    return contents


def _finish(writer: LessonWriter) -> None:
    try:
        LessonIndex(writer.path.parent).note(writer, writer.finish())
    except OSError as error:
        writer.close()
        log.warning("a recovered lesson could not be finished", lesson=writer.path.name, reason=str(error))
