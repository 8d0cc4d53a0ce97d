"""Following fusion's log: which parts belong to the lesson, what is missing between them, and what fusion is asked for.

Pure: what is heard goes in. A lesson's segments are whole from their first part on. A part that did not come is asked for again,
and until it is there no later one is taken; if fusion does not have it any more it begins a new segment, and there is a gap.
"""

from dataclasses import dataclass
from typing import NamedTuple

from models.messages.lesson import FusionLog, SegmentRequest


class Accepted(NamedTuple):
    """The part belongs into the lesson; `gap` says why something is missing before it and is empty if nothing is."""

    gap: str


@dataclass
class Following:
    """What is expected of fusion's log.

    Attributes:
        asked_ns: CLOCK_MONOTONIC when this began; only segments that begin later are taken, or the one that is gone on with.
        gap: why something will be missing before the next segment; empty if nothing is recorded yet.
        segment_ns: of the segment that is being recorded; 0 before the first.
        sequence: of its next part.
    """

    asked_ns: int
    gap: str = ""
    segment_ns: int = 0
    sequence: int = 0

    @property
    def request(self) -> SegmentRequest:
        """What fusion is asked for, again and again."""
        return SegmentRequest(self.asked_ns, self.segment_ns, self.sequence)

    def hear(self, part: FusionLog) -> Accepted | None:
        """A part was heard; None if it does not belong into the lesson, or not yet."""
        if part.segment_ns != self.segment_ns:
            if part.segment_ns < self.asked_ns or part.segment_ns < self.segment_ns:
                return None
            self.segment_ns, self.sequence = part.segment_ns, 0
        if part.sequence != self.sequence:
            return None
        gap = self.gap if part.sequence == 0 else ""
        self.gap = "fusion began anew"
        self.sequence += 1
        return Accepted(gap)
