"""The records of an MCAP file, read with their places and checked, so that damage is found and named by its byte.

Format: https://mcap.dev/spec. The package `mcap` reads and writes single records; its own readers neither tell where a record
lies, which recovery must know, nor bound what a corrupt length makes them allocate.
"""

import struct
import zlib
from collections.abc import Iterator, Sequence
from io import BytesIO
from typing import BinaryIO, NamedTuple, Protocol, TypeVar

import zstandard
from mcap.data_stream import ReadDataStream, RecordBuilder
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.records import Chunk, DataEnd, McapRecord, Message

MAGIC = b"\x89MCAP0\r\n"
_HEAD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<HIQQ")
_CHUNK = struct.Struct("<QQQII4sQ")
"""Of a chunk before its data: times, size, CRC-32, name of the compression, and last the length of the data."""
_LARGEST_RECORD = 64 * 2**20
_LARGEST_CHUNK = 256 * 2**20

RecordT_co = TypeVar("RecordT_co", covariant=True)


class DamageError(ValueError):
    """Bytes that are no MCAP file, or are one no more; says what is wrong and at which byte."""


class CutOffError(DamageError):
    """The file ends in the middle of a record, or where another should begin, and is otherwise as it was written."""


class Place(NamedTuple):
    """One record of a file.

    Attributes:
        start, end: it lies from byte `start` up to byte `end`.
        body: its content without opcode and length.
        checksum: CRC-32 of the file up to `end`.
    """

    opcode: int
    start: int
    end: int
    body: bytes
    checksum: int


class OpenChunk(NamedTuple):
    """A chunk and the messages in it, in their order."""

    chunk: Chunk
    messages: tuple[Message, ...]


class _Readable(Protocol[RecordT_co]):
    @staticmethod
    def read(stream: ReadDataStream) -> RecordT_co: ...


def walk(file: BinaryIO) -> Iterator[Place]:
    """Every record from the beginning up to and including the footer.

    Raises:
        CutOffError: the file ends too early.
        DamageError: it does not begin as MCAP, a record cannot be of the length that it says, or the data section differs from its
            check sum.
    """
    magic = file.read(len(MAGIC))
    if magic != MAGIC:
        raise DamageError("it does not begin as an MCAP file")
    start, checksum = len(MAGIC), zlib.crc32(magic)
    while True:
        head = file.read(_HEAD.size)
        if len(head) < _HEAD.size:
            raise CutOffError(f"it is cut off at byte {start}")
        opcode, length = _HEAD.unpack(head)
        if length > _LARGEST_RECORD:
            raise DamageError(f"byte {start} begins no record")
        body = file.read(length)
        if len(body) < length:
            if not _is_beginning(opcode, length, body):
                raise DamageError(f"the record at byte {start} would go on beyond the end of the file")
            raise CutOffError(f"it is cut off within the record at byte {start}")
        place = Place(opcode, start, start + len(head) + length, body, zlib.crc32(body, zlib.crc32(head, checksum)))
        if opcode == Opcode.DATA_END and parse(DataEnd, place).data_section_crc not in (0, checksum):
            raise DamageError("its data differ from their check sum")
        yield place
        if opcode == Opcode.FOOTER:
            if file.read(len(MAGIC) + 1) != MAGIC:
                raise DamageError(f"it does not end as an MCAP file after byte {place.end}")
            return
        start, checksum = place.end, place.checksum


def parse(kind: type[_Readable[RecordT_co]], place: Place) -> RecordT_co:
    """A record of a kind that lies at a place.

    Raises:
        DamageError: it cannot be read as that.
    """
    try:
        return kind.read(ReadDataStream(BytesIO(place.body)))
    except (McapError, struct.error, ValueError, OverflowError) as error:  # the last of lengths that no file can have
        raise DamageError(f"the record at byte {place.start} cannot be read") from error


def open_chunk(place: Place) -> OpenChunk:
    """The chunk at a place, checked against its length and its check sum.

    Raises:
        DamageError: the chunk was changed, or is compressed otherwise than by Zstandard.
    """
    chunk = parse(Chunk, place)
    if chunk.compression != "zstd" or chunk.uncompressed_size > _LARGEST_CHUNK:
        raise DamageError(f"the chunk at byte {place.start} is none that KineBox writes")
    if len(place.body) != _CHUNK.size + len(chunk.data):
        raise DamageError(f"the chunk at byte {place.start} says two different lengths")
    try:
        if zstandard.frame_content_size(chunk.data) != chunk.uncompressed_size:
            raise DamageError(f"the chunk at byte {place.start} was changed")
        data = zstandard.ZstdDecompressor().decompress(chunk.data)
    except zstandard.ZstdError as error:
        raise DamageError(f"the chunk at byte {place.start} was changed") from error
    if zlib.crc32(data) != chunk.uncompressed_crc:
        raise DamageError(f"the chunk at byte {place.start} differs from its check sum")
    try:
        return OpenChunk(chunk, tuple(_messages(data)))
    except struct.error as error:
        raise DamageError(f"the chunk at byte {place.start} is none that KineBox writes") from error


def encode_messages(messages: Sequence[Message]) -> bytes:
    """Messages as the content of a chunk. (Several times as fast as `encode`.)"""
    parts = []
    for message in messages:
        parts.append(_HEAD.pack(Opcode.MESSAGE, _MESSAGE.size + len(message.data)))
        parts.append(_MESSAGE.pack(message.channel_id, message.sequence, message.log_time, message.publish_time))
        parts.append(message.data)
    return b"".join(parts)


def encode(*records: McapRecord) -> bytes:
    """Records as the bytes of a file."""
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]


def _is_beginning(opcode: int, length: int, body: bytes) -> bool:
    """Whether a record that ends too early was cut off there, rather than its length changed: a chunk says its length twice.

    Of another kind none is left behind: the others are written with their file's beginning or behind its last chunk. Where less is
    left than stands in a chunk before its data, there is nothing to lose.
    """
    if len(body) < _CHUNK.size:
        return True
    return opcode == Opcode.CHUNK and _CHUNK.unpack_from(body)[-1] == length - _CHUNK.size


def _messages(data: bytes) -> Iterator[Message]:
    at = 0
    while at < len(data):
        opcode, length = _HEAD.unpack_from(data, at)
        at += _HEAD.size
        if opcode == Opcode.MESSAGE:
            channel, sequence, log_time, publish_time = _MESSAGE.unpack_from(data, at)
            yield Message(channel, log_time, data[at + _MESSAGE.size : at + length], publish_time, sequence)
        at += length
