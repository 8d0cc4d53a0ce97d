"""The record of a lesson: what fusion consumed, in its order, and who asks for it.

A lesson replays only from a state that is known, and that is fusion's first one. So a recorder that begins asks fusion to begin
anew; from then on fusion publishes everything that it takes in, in its order, as one *segment*. The figure is grey for a moment
then, as at the start of the box: fusion has to find the pupil again.

The recorder repeats its request for as long as it records, and says in it which part it needs next. A repeated request keeps the
log running and begins nothing, so it does not matter how many of them are lost. Parts that the recorder has missed, because it
died or was held up, are published once more: fusion keeps those of the last `LEASE_NS`. A fusion process that was restarted, has
stopped the log, or does not have the part any more begins a new segment. The recorder takes the segment that it is in, and
every one that begins after it asked.
"""

from typing import Literal

import msgspec

from models.messages.observation import require_count

EntryKind = Literal["observation", "tick", "motion", "health", "feedback", "corrections"]
"""What a lesson is made of.

"observation" and "tick" are fusion's input; "motion" (smooth) is its output; "health" is what a process said, "feedback" what
the evaluation said of an attempt, as the teacher saw it on the day, and "corrections" whose attempts were after all.
"""
MAX_TITLE = 80
LEASE_NS = 20_000_000_000
"""Fusion stops the log when the request was not repeated for so long: the recorder is gone, or does not record any more. One that
hangs is found after 3 s, and needs a few more to be back."""


class Entry(msgspec.Struct, frozen=True, array_like=True):
    """One thing that fusion took in or gave out.

    Attributes:
        kind: what it was.
        t_ns: CLOCK_MONOTONIC at which fusion took it in or gave it out; of a tick, when it was due, which may be earlier than
            the observation before it.
        payload: the message as it was on the bus; empty for a tick, whose time is `t_ns`.
    """

    kind: EntryKind
    t_ns: int
    payload: bytes

    def __post_init__(self) -> None:
        require_count("t_ns", self.t_ns)


class FusionLog(msgspec.Struct, frozen=True):
    """A part of a segment (fusion -> recorder), about twice a second, and as soon as something was said of an attempt.

    Attributes:
        segment_ns: CLOCK_MONOTONIC at which fusion's state began; names the segment, and is positive.
        sequence: counts the parts of the segment from 0; a number that is missing is a gap.
        entries: in fusion's order.
    """

    segment_ns: int
    sequence: int
    entries: tuple[Entry, ...]

    def __post_init__(self) -> None:
        require_count("segment_ns", self.segment_ns)
        require_count("sequence", self.sequence)
        if self.segment_ns == 0:
            raise ValueError("segment_ns is 0, which names no segment")

    @property
    def latest_ns(self) -> int:
        """The latest time in the part; no later than now, of a part that fusion made."""
        return max([self.segment_ns, *(entry.t_ns for entry in self.entries)])


class SegmentRequest(msgspec.Struct, frozen=True):
    """Go on with the log, or begin with a new state and log from there (recorder -> fusion).

    Attributes:
        t_ns: CLOCK_MONOTONIC when it was asked first; names the request. Of two requests the later one counts.
        segment_ns: the segment to go on with; 0 for a new one.
        sequence: the part of it that is needed next.
    """

    t_ns: int
    segment_ns: int = 0
    sequence: int = 0

    def __post_init__(self) -> None:
        require_count("t_ns", self.t_ns)
        require_count("segment_ns", self.segment_ns)
        require_count("sequence", self.sequence)


class LessonRequest(msgspec.Struct, frozen=True, omit_defaults=True):
    """Begin or end a lesson (command line -> recorder).

    Attributes:
        action: "start" while one is being recorded changes nothing.
        title: what people call it; at most `MAX_TITLE` characters; without meaning for "stop".
        t_ns: CLOCK_MONOTONIC when it was asked first; names the request of who wants to know whether the lesson is his.
        lesson: to "stop" this one alone, by `RecorderHealth.lesson`; empty for whichever is being recorded.
    """

    action: Literal["start", "stop"]
    title: str = ""
    t_ns: int = 0
    lesson: str = ""

    def __post_init__(self) -> None:
        require_count("t_ns", self.t_ns)
        if len(self.title) > MAX_TITLE:
            raise ValueError(f"a title has at most {MAX_TITLE} characters")
