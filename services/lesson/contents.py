"""What a lesson's MCAP file holds: its chunks, and the summary that is written from them at its end."""

import struct
import zlib
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Final

import zstandard
from mcap.opcode import Opcode
from mcap.records import Chunk, ChunkIndex, DataEnd, Footer, McapRecord, Message, MetadataIndex, Statistics, SummaryOffset

from models.messages import codec
from models.messages.attempts import REMEMBERED
from models.messages.feedback import Feedback
from services.lesson.layout import CHANNEL_OF, CHANNELS, SCHEMAS, Mark
from services.lesson.mcap_records import MAGIC, encode, encode_messages

_COMPRESSION: Final = "zstd"
_LEVEL: Final = 6
"""Covariances are symmetric, which lower levels do not see: 12 % larger files. Higher ones gain nothing."""


@dataclass
class Contents:
    """What a file holds up to its end, from which its summary is written.

    Attributes:
        end: size of the file in bytes.
        checksum: CRC-32 of all bytes until there.
        metadata: where the header lies.
        chunks: where the chunks lie.
        counts: messages by channel.
        sequence: number of the next message.
        log_time_ns: of the latest message; log times never go back.
        gaps: parts before which something is missing.
        segments: stretches that replay in one go.
        segment_ns: the name of the last one; 0 before the first.
        next_part: number of the part that it goes on with.
        attempts: names of the last attempts in it, in their order; 0 for one that cannot be read.
    """

    end: int = 0
    checksum: int = 0
    metadata: MetadataIndex | None = None
    chunks: list[ChunkIndex] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)
    sequence: int = 0
    log_time_ns: int = 0
    gaps: int = 0
    segments: int = 0
    segment_ns: int = 0
    next_part: int = 0
    attempts: deque[int] = field(default_factory=lambda: deque(maxlen=REMEMBERED))

    @property
    def seconds(self) -> float:
        """From the first entry to the last, with the gaps."""
        return (self.chunks[-1].message_end_time - self.chunks[0].message_start_time) * 1e-9 if self.chunks else 0.0

    def take_chunk(self, start: int, length: int, chunk: Chunk, messages: Sequence[Message], mark: Mark) -> None:
        """Note a chunk that lies at byte `start`."""
        for message in messages:
            self.counts[message.channel_id] = self.counts.get(message.channel_id, 0) + 1
            if message.channel_id == CHANNEL_OF["feedback"]:
                self.attempts.append(_name_of(message.data))
        self.chunks.append(
            ChunkIndex(
                chunk_length=length,
                chunk_start_offset=start,
                compression=chunk.compression,
                compressed_size=len(chunk.data),
                message_end_time=chunk.message_end_time,
                message_index_length=0,
                message_index_offsets={},
                message_start_time=chunk.message_start_time,
                uncompressed_size=chunk.uncompressed_size,
            )
        )
        self.sequence += len(messages)
        self.log_time_ns = messages[-1].log_time
        self.gaps += bool(mark.gap)
        self.segments += mark.segment_ns != self.segment_ns
        self.segment_ns, self.next_part = mark.segment_ns, mark.sequence + 1


def chunk_of(messages: list[Message]) -> Chunk:
    """Messages in the order of their log times, compressed."""
    data = encode_messages(messages)
    return Chunk(
        compression=_COMPRESSION,
        data=zstandard.ZstdCompressor(level=_LEVEL).compress(data),
        message_end_time=messages[-1].log_time,
        message_start_time=messages[0].log_time,
        uncompressed_crc=zlib.crc32(data),
        uncompressed_size=len(data),
    )


def summary_of(contents: Contents) -> bytes:
    """Everything after the last chunk: end of the data, summary, footer."""
    assert contents.metadata is not None  # noqa: S101 - every file begins with its header
    data_end = encode(DataEnd(contents.checksum))
    statistics = Statistics(
        attachment_count=0,
        channel_count=len(CHANNELS),
        channel_message_counts=contents.counts,
        chunk_count=len(contents.chunks),
        message_count=sum(contents.counts.values()),
        message_end_time=contents.chunks[-1].message_end_time if contents.chunks else 0,
        message_start_time=contents.chunks[0].message_start_time if contents.chunks else 0,
        metadata_count=1,
        schema_count=len(SCHEMAS),
    )
    groups: list[tuple[Opcode, list[McapRecord]]] = [
        (Opcode.SCHEMA, [*SCHEMAS]),
        (Opcode.CHANNEL, [*CHANNELS]),
        (Opcode.STATISTICS, [statistics]),
        (Opcode.CHUNK_INDEX, [*contents.chunks]),
        (Opcode.METADATA_INDEX, [contents.metadata]),
    ]
    start = contents.end + len(data_end)
    summary, offsets = b"", []
    for opcode, records in groups:
        group = encode(*records)
        offsets.append(SummaryOffset(group_length=len(group), group_opcode=opcode, group_start=start + len(summary)))
        summary += group
    offsets_start = start + len(summary)
    summary += encode(*offsets)
    # The footer up to its own check sum is part of what the sum is over.
    checksum = zlib.crc32(summary + struct.pack("<BQQQ", Opcode.FOOTER, 20, start, offsets_start))
    return data_end + summary + encode(Footer(start, offsets_start, checksum)) + MAGIC


def _name_of(feedback: bytes) -> int:
    try:
        return codec.decode(feedback, Feedback).id
    except codec.CodecError:  # It counts all the same, as in a report.
        return 0
