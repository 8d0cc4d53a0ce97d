"""Writing a lesson: an MCAP file that is whole up to its last synced part at every moment.

A part of fusion's log is written as one chunk, in one piece, and synced before `append` returns. The file is called `.mcap.part`
until its summary is written, and `.ended.mcap.part` from the moment on when it is to be finished. Opening a file that a crash left
is the same as going on with one: it is cut after its last whole chunk, and from there it can be appended to or finished.
"""

import errno
import fcntl
import os
import zlib
from contextlib import suppress
from pathlib import Path
from typing import BinaryIO

import msgspec
from mcap.records import (
    Header,
    Message,
    Metadata,
    MetadataIndex,
)

from models.messages.lesson import FusionLog
from services.lesson import lesson_header
from services.lesson.contents import Contents, chunk_of, summary_of
from services.lesson.free_names import rename_free
from services.lesson.layout import CHANNEL_OF, CHANNELS, MARK, PART_SUFFIX, PROFILE, SCHEMAS, SUFFIX, Mark
from services.lesson.lesson_header import LessonHeader
from services.lesson.mcap_records import MAGIC, encode
from services.support.sync import sync_folder

ENDED_SUFFIX = f".ended{PART_SUFFIX}"
"""Of a file that only waits to be finished: nothing is recorded into it any more, whatever becomes of the recorder."""


class LessonWriter:
    """An unfinished lesson file that is open for writing, and locked as long as it is, so that a list knows.

    Args:
        path: of the file, with `PART_SUFFIX`.
        file: opened for writing, at its end.
        header: what is written at its beginning.
        contents: what it holds.
    """

    def __init__(self, path: Path, file: BinaryIO, header: LessonHeader, contents: Contents) -> None:
        self.path = path
        self.header = header
        self._file = file
        self._contents = contents
        self._locked = False
        self._lock()

    @classmethod
    def create(cls, folder: Path, name: str, header: LessonHeader) -> "LessonWriter":
        """A new lesson; it is on the disk with its header when this returns.

        Raises:
            OSError: there is one of that name, or it cannot be written.
        """
        return cls._begun(folder / f"{name}{PART_SUFFIX}", header)

    @classmethod
    def create_over(cls, path: Path, header: LessonHeader) -> "LessonWriter":
        """The same in the place of an unfinished file of which no more than its header is worth anything.

        Raises:
            OSError: it cannot be written; the file is as it was.
        """
        new = path.with_name(f".{path.name}.new")  # No name of a lesson: a crash may leave it.
        new.unlink(missing_ok=True)
        writer = cls._begun(new, header)
        try:
            writer.path = new.replace(path)
        except BaseException:
            writer.close()
            new.unlink()
            raise
        with suppress(OSError):  # If a power cut takes the new file away, the old one is there again.
            sync_folder(path.parent)
        return writer

    @classmethod
    def _begun(cls, path: Path, header: LessonHeader) -> "LessonWriter":
        file = path.open("xb", buffering=0)
        contents = Contents()
        metadata = Metadata(lesson_header.NAME, header.to_metadata())
        before = MAGIC + encode(Header(PROFILE, f"kinebox {header.kinebox}"))
        body = encode(metadata)
        contents.metadata = MetadataIndex(len(before), len(body), metadata.name)
        writer = cls(path, file, header, contents)
        try:
            writer._write(before + body + encode(*SCHEMAS, *CHANNELS))
            sync_folder(path.parent)
        except BaseException:
            file.close()
            path.unlink()
            raise
        return writer

    @property
    def recorded_s(self) -> float:
        """Length of what is safe on the disk, from the first entry to the last, with the gaps."""
        return self._contents.seconds

    @property
    def gaps(self) -> int:
        """Interruptions of what is safe on the disk."""
        return self._contents.gaps

    @property
    def segments(self) -> int:
        """Stretches that replay in one go."""
        return self._contents.segments

    @property
    def attempts(self) -> int:
        """How many are safe on the disk."""
        return self._contents.counts.get(CHANNEL_OF["feedback"], 0)

    @property
    def newest_attempts(self) -> tuple[int, ...]:
        """The names (`Feedback.id`) of the last of them, in their order."""
        return tuple(self._contents.attempts)

    @property
    def position(self) -> tuple[int, int]:
        """The segment that it is in, 0 before the first, and the part of it that comes next."""
        return self._contents.segment_ns, self._contents.next_part

    @property
    def size(self) -> int:
        """Bytes that are safe on the disk."""
        return self._contents.end

    @property
    def to_finish(self) -> int:
        """Bytes that `finish` adds to it."""
        return len(summary_of(self._contents))

    @property
    def ended(self) -> bool:
        """Whether its recording was ended, so that it is only to be finished."""
        return self.path.name.endswith(ENDED_SUFFIX)

    @property
    def in_place(self) -> bool:
        """Whether what is written lies at `path`: a file that was removed, renamed or replaced takes in all without a word."""
        try:
            there = self.path.stat()
        except (FileNotFoundError, NotADirectoryError):
            return False
        return os.path.samestat(there, os.fstat(self._file.fileno()))

    def append(self, part: FusionLog, gap: str = "") -> None:
        """Write a part; it is safe when this returns.

        Args:
            part: what fusion logged.
            gap: why something is missing before it; empty if nothing is.

        Raises:
            OSError: the disk is full or broken; the file is as it was before, unless it cannot even be cut.
        """
        self._lock()
        contents = self._contents
        mark = Mark(part.segment_ns, part.sequence, gap)
        log_time_ns = max(contents.log_time_ns, part.entries[0].t_ns if part.entries else part.segment_ns)
        messages = [Message(MARK, log_time_ns, msgspec.json.encode(mark), log_time_ns, contents.sequence)]
        for number, entry in enumerate(part.entries, start=contents.sequence + 1):
            log_time_ns = max(log_time_ns, entry.t_ns)
            messages.append(Message(CHANNEL_OF[entry.kind], log_time_ns, entry.payload, entry.t_ns, number))
        chunk = chunk_of(messages)
        body = encode(chunk)
        start = contents.end
        self._write(body)
        contents.take_chunk(start, len(body), chunk, messages, mark)

    def finish(self) -> Path:
        """Write the summary, close the file and give it its final name, numbered if there is a file of that name; its path.

        Raises:
            FileNotFoundError: it is not `in_place`.
            OSError: as for `append`; the file stays unfinished, and can be finished by recovery.
        """
        if not self.in_place:
            raise FileNotFoundError(errno.ENOENT, "the file was removed, renamed or replaced", str(self.path))
        with suppress(OSError):  # The summary says the same.
            self.path = mark_ended(self.path)
        self._write(summary_of(self._contents))
        self._file.close()
        finished = rename_free(self.path, lesson_of(self.path), SUFFIX)
        with suppress(OSError):  # If a power cut takes the new name away, the next start gives it again.
            sync_folder(finished.parent)
        return finished

    def close(self) -> None:
        """Leave the file as it is, unfinished."""
        self._file.close()

    def _lock(self) -> None:
        """Lock the file; if a list looks at it at this moment, then with the next part, for no list may keep a recorder waiting."""
        if self._locked:
            return
        with suppress(OSError):
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self._locked = True

    def _write(self, data: bytes) -> None:
        """All of `data` or nothing, and synced."""
        contents = self._contents
        try:
            view = memoryview(data)
            while view:
                view = view[self._file.write(view) :]
            os.fsync(self._file.fileno())
        except OSError:
            self._file.seek(contents.end)
            self._file.truncate()
            raise
        contents.end += len(data)
        contents.checksum = zlib.crc32(data, contents.checksum)


def lesson_of(path: Path) -> str:
    """The name, without suffix, that an unfinished file gets when it is finished."""
    return path.name.removesuffix(PART_SUFFIX).removesuffix(ENDED_SUFFIX.removesuffix(PART_SUFFIX))


def mark_ended(path: Path) -> Path:
    """Note that an unfinished file is only to be finished; its path from then on.

    A name needs no room, so that it can be given on a full disk, too. It is not synced: after a power cut nothing is gone on with.

    Raises:
        OSError: it cannot be renamed, and has its old name still.
    """
    return path if path.name.endswith(ENDED_SUFFIX) else rename_free(path, lesson_of(path), ENDED_SUFFIX)


def is_being_written(file: BinaryIO) -> bool:
    """Whether a `LessonWriter` has the file of that name open, in any process."""
    try:
        fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except BlockingIOError:
        return True
    except OSError:
        return False  # The file system has no locks.
    fcntl.flock(file, fcntl.LOCK_UN)
    return False
