"""What an unfinished or damaged lesson holds, up to where it can be read."""

import threading
from typing import BinaryIO, NamedTuple

from mcap.opcode import Opcode
from mcap.records import MetadataIndex

from services.lesson import lesson_header
from services.lesson.contents import Contents
from services.lesson.layout import Mark
from services.lesson.lesson_reader import PartDecoder
from services.lesson.mcap_records import CutOffError, DamageError, open_chunk, walk

_BEGINNING = (Opcode.HEADER, Opcode.METADATA, Opcode.SCHEMA, Opcode.CHANNEL)
_DATA_END_BYTES = 4


class StoppedError(Exception):
    """Whoever wanted to know what is in a file does not any more."""


class Survey(NamedTuple):
    """What was found in a file.

    Attributes:
        contents: up to where it can be read.
        damage: why it cannot be read further; empty if it was only cut off or if its summary follows, which is made anew.
        ended: its summary follows, so that its recording had been ended.
    """

    contents: Contents
    damage: str
    ended: bool = False


def survey(file: BinaryIO, stop: threading.Event | None = None) -> Survey:
    """What a file with a good header holds, up to its first damage or, if there is none, its summary.

    Raises:
        StoppedError: `stop` was set meanwhile; hours of lesson take long to read.
    """
    contents, decoder = Contents(), PartDecoder()
    file.seek(0)
    try:
        for place in walk(file):
            if stop is not None and stop.is_set():
                raise StoppedError
            if place.opcode == Opcode.DATA_END and len(place.body) == _DATA_END_BYTES:
                return Survey(contents, "", ended=True)
            if place.opcode == Opcode.METADATA:
                contents.metadata = MetadataIndex(place.start, place.end - place.start, lesson_header.NAME)
            if place.opcode == Opcode.CHUNK:
                opened = open_chunk(place)
                part = decoder.decode(opened)
                mark = Mark(part.segment_ns, part.sequence, part.gap)
                contents.take_chunk(place.start, place.end - place.start, opened.chunk, opened.messages, mark)
            elif contents.chunks or place.opcode not in _BEGINNING:
                return Survey(contents, f"the record at byte {place.start} is of no kind that may stand there")
            contents.end, contents.checksum = place.end, place.checksum
    except CutOffError:
        pass
    except DamageError as error:
        return Survey(contents, str(error))
    return Survey(contents, "")
