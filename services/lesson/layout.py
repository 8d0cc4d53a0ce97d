"""How a lesson lies in its MCAP file: the channels, and the mark at the beginning of every chunk.

The file is: header, metadata (`lesson_header`), schemas and channels, then a chunk for each part of fusion's log, then the summary.
There are no indexes of messages: a chunk is half a second, and they would be a twentieth of the file.

In a chunk come first its mark and then the part's entries in fusion's order. Each message is numbered through the whole file; its
publish time is the entry's own time, its log time the latest of any entry until then, since a tick may be dated a little before
the observation that was taken in ahead of it, and log times must not go back.
"""

import msgspec
from mcap.records import Channel, Schema

from models.messages import codec, topics
from models.messages.lesson import Entry, EntryKind

PROFILE = "kinebox"
SUFFIX = ".mcap"
PART_SUFFIX = ".mcap.part"
"""Of a file that is being written, or was when its recorder died."""

MARK = 1
KINDS: dict[int, EntryKind] = {2: "observation", 3: "tick", 4: "motion", 5: "health", 6: "feedback", 7: "corrections"}
"""Kinds of entries by number of their channel."""
CHANNEL_OF = {kind: channel for channel, kind in KINDS.items()}


class Mark(msgspec.Struct, frozen=True):
    """What every chunk begins with.

    Attributes:
        segment_ns, sequence: of the part, as in `FusionLog`.
        gap: why something is missing between the part before and this one; empty if nothing is.
    """

    segment_ns: int
    sequence: int
    gap: str = ""


SCHEMAS = (
    Schema(1, msgspec.json.encode(msgspec.json.schema(Mark)), "jsonschema", "kinebox.Mark"),
    *(
        Schema(number, b"", "", f"kinebox.{name}")
        for number, name in enumerate(("Observation", "Tick", "Motion", "Health", "Feedback", "PupilCorrections"), start=2)
    ),
)
CHANNELS = (
    Channel(MARK, f"{topics.fusion_log()}/mark", "json", {}, 1),
    *(Channel(number, f"{topics.fusion_log()}/{kind}", f"kinebox/{codec.VERSION}", {}, number) for number, kind in KINDS.items()),
)


def entry(channel: int, t_ns: int, payload: bytes) -> Entry:
    """The entry that a message holds; KeyError if its channel has none, ValueError if there is no such time."""
    return Entry(KINDS[channel], t_ns, payload)
