"""Reading a lesson back: its header, then the parts of fusion's log in their order, every byte checked.

with open_lesson(path) as lesson:
    for part in lesson.parts():
        if part.begins_segment: state = initial_state(rig)
        for entry in part.entries: ...
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import BinaryIO

import msgspec
from mcap.opcode import Opcode
from mcap.records import Header, Metadata

from models.errors import UserError
from models.messages.lesson import Entry
from models.regular_file import require_regular
from services.lesson import lesson_header
from services.lesson.layout import MARK, PART_SUFFIX, PROFILE, SUFFIX, Mark, entry
from services.lesson.lesson_header import HeaderError, LessonHeader, NewerFormatError
from services.lesson.mcap_records import DamageError, OpenChunk, open_chunk, parse, walk
from services.lesson.readable_names import is_readable, readable

FINISHING = (
    "end its recording, or see what 'kinebox doctor' says of it: KineBox finishes what a crash left when it starts, "
    "and what a full disk left once there is room"
)
_RECOVER = (
    f"give it a name that ends with '{PART_SUFFIX}', in the folder of lessons, and start KineBox anew: all before that is "
    "recovered, and the damaged file is kept"
)


class NewerLessonError(UserError):
    """The lesson was recorded by a KineBox that came after this one."""


@dataclass(frozen=True)
class LessonPart:
    """What one `FusionLog` held.

    Attributes:
        segment_ns, sequence: as fusion numbered the part.
        begins_segment: fusion began with a new state before the first entry.
        gap: why something is missing between the part before and this one; empty if nothing is.
        entries: in fusion's order; their times are fusion's own.
    """

    segment_ns: int
    sequence: int
    begins_segment: bool
    gap: str
    entries: tuple[Entry, ...]


@dataclass(frozen=True)
class LessonSummary:
    """A whole lesson in figures.

    Attributes:
        begin_ns, end_ns: CLOCK_MONOTONIC of the first and the last entry; the lesson's start if it has none.
        parts, segments, gaps: how many; the first segment begins without a gap.
        entries: how many, by kind.
    """

    begin_ns: int
    end_ns: int
    parts: int
    segments: int
    gaps: int
    entries: dict[str, int]

    @property
    def seconds(self) -> float:
        """From the first entry to the last, with the gaps."""
        return (self.end_ns - self.begin_ns) * 1e-9


class Lesson:
    """An open lesson file. `parts` and `summary` each read it from the beginning."""

    def __init__(self, path: Path, file: BinaryIO) -> None:
        self.path = path
        self._file = file
        self.header = read_header(path, file)

    def __enter__(self) -> "Lesson":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._file.close()

    def parts(self) -> Iterator[LessonPart]:
        """Every part in fusion's order, read as it is asked for.

        Raises:
            UserError: the file is damaged from here on.
        """
        self._file.seek(0)
        decoder = PartDecoder()
        try:
            for place in walk(self._file):
                if place.opcode == Opcode.CHUNK:
                    yield decoder.decode(open_chunk(place))
        except DamageError as error:
            raise UserError(f"lesson {self.path} is damaged: {error}; {_RECOVER}") from error

    def summary(self) -> LessonSummary:
        """Read the whole file, and so check all of it; UserError as for `parts`."""
        return summarise(self.header, self.parts())

    def require_entries(self) -> None:
        """Raise UserError if nothing was recorded: the recording ended before its first part. And as for `parts`."""
        if not any(part.entries for part in self.parts()):
            remedy = f"remove it with 'kinebox lessons delete {self.path.name.removesuffix(SUFFIX)}'"
            raise UserError(f"lesson {self.path} is empty: its recording ended before anything was recorded; {remedy}")


class PartDecoder:
    """Turns chunks into parts, in their order in the file, and sees to it that none is missing."""

    def __init__(self) -> None:
        self._sequence = 0
        self._segment_ns: int | None = None

    def decode(self, chunk: OpenChunk) -> LessonPart:
        """The part of the next chunk; DamageError if it is not the next one, or no part."""
        number = self._sequence
        found = chunk.messages
        self._sequence += len(found)
        if not found or [message.sequence for message in found] != list(range(number, self._sequence)):
            raise DamageError(f"something is missing before message {number}")
        marked, *rest = found
        if marked.channel_id != MARK:
            raise DamageError(f"the chunk of message {number} does not say what it is part of")
        try:
            mark = msgspec.json.decode(marked.data, type=Mark)
            entries = tuple(entry(message.channel_id, message.publish_time, message.data) for message in rest)
        except (ValueError, KeyError, RecursionError) as error:
            raise DamageError(f"the chunk of message {number} holds what no lesson does") from error
        begins = mark.segment_ns != self._segment_ns
        self._segment_ns = mark.segment_ns
        return LessonPart(mark.segment_ns, mark.sequence, begins, mark.gap, entries)


def summarise(header: LessonHeader, parts: Iterator[LessonPart]) -> LessonSummary:
    """The figures of a lesson's parts."""
    count = segments = gaps = 0
    kinds: dict[str, int] = {}
    times: list[int] = []
    for part in parts:
        count += 1
        segments += part.begins_segment
        gaps += bool(part.gap)
        for item in part.entries:
            kinds[item.kind] = kinds.get(item.kind, 0) + 1
        if part.entries:
            times = [*times[:1], part.entries[0].t_ns, part.entries[-1].t_ns]
    times = times or [header.started_ns]
    return LessonSummary(times[0], times[-1], count, segments, gaps, kinds)


def open_lesson(path: Path) -> Lesson:
    """Open a finished lesson.

    Raises:
        UserError: there is none, it is no lesson, of a newer KineBox, still being written, or its beginning is damaged.
    """
    if path.name.endswith(PART_SUFFIX):
        raise UserError(f"lesson {path} is not finished; {FINISHING}")
    try:
        require_regular(path.stat())
        file = path.open("rb")
    except FileNotFoundError as error:
        raise UserError(f"lesson {path} does not exist; 'kinebox lessons' lists what there is") from error
    except OSError as error:
        raise UserError(f"lesson {path} cannot be read: {error.strerror}; correct its path or its permissions") from error
    try:
        return Lesson(path, file)
    except BaseException:
        file.close()
        raise


def read_header(path: Path, file: BinaryIO) -> LessonHeader:
    """The header of a lesson, finished or not. Reads from the file's beginning.

    Raises:
        NewerLessonError: this KineBox does not know the file's format.
        UserError: it has no header that can be read, or a name that is not UTF-8.
    """
    if not is_readable(path.name):
        name = readable(path.name).removesuffix(PART_SUFFIX).removesuffix(SUFFIX)
        raise UserError(f"the name of lesson {name} is not UTF-8; rename the file")
    foreign = UserError(f"{path} is no lesson of KineBox; name a file that 'kinebox lessons' lists")
    file.seek(0)
    try:
        records = walk(file)
        first = next(records)
        if first.opcode != Opcode.HEADER or parse(Header, first).profile != PROFILE:
            raise foreign
        second = next(records)
        metadata = parse(Metadata, second) if second.opcode == Opcode.METADATA else None
        if metadata is None or metadata.name != lesson_header.NAME:
            raise DamageError(f"the record at byte {second.start} is not the lesson's header")
        return LessonHeader.from_metadata(metadata.metadata)
    except NewerFormatError as error:
        raise NewerLessonError(f"lesson {path} was recorded by a newer KineBox: {error}; update this one to read it") from error
    except HeaderError as error:
        raise UserError(f"lesson {path} is damaged: {error}, and nothing can be read without it; use a copy of the file") from error
    except DamageError as error:
        if file.seek(0) == 0 and file.read(1) == b"\x89":
            raise UserError(f"lesson {path} is damaged: {error}; use a copy of the file") from error
        raise foreign from error
