"""Following fusion's log: which parts belong to the lesson, what is missing between them, and when to ask fusion to begin anew.

Pure: what is heard and the time go in. A lesson's segments are whole from their first part on; when a part is lost the rest of the
segment could not be replayed, so it is left out and a new segment is asked for.
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
        request: what fusion is asked for, again and again.
        gap: why something will be missing before the next segment; empty if nothing is recorded yet.
        segment_ns: of the segment that is being recorded; None between segments.
        sequence: of its next part.
    """

    request: SegmentRequest
    gap: str = ""
    segment_ns: int | None = None
    sequence: int = 0

    def hear(self, part: FusionLog, now_ns: int) -> Accepted | None:
        """A part was heard; None if it does not belong into the lesson."""
        if part.segment_ns <= self.request.t_ns:
            return None  # Of a segment that began before it was asked for: its beginning was not heard.
        if part.segment_ns == self.segment_ns and part.sequence < self.sequence:
            return None
        began_anew = part.segment_ns != self.segment_ns
        if part.sequence != (0 if began_anew else self.sequence):
            self.ask_anew("a part of fusion's log was lost", now_ns)
            return None
        gap = ""
        if began_anew:
            gap = self.gap
            self.gap = "fusion began anew"
        self.segment_ns, self.sequence = part.segment_ns, part.sequence + 1
        return Accepted(gap)

    def ask_anew(self, gap: str, now_ns: int) -> None:
        """Ask for a new segment, because of a gap."""
        self.request = SegmentRequest(now_ns)
        if self.gap:
            self.gap = gap
        self.segment_ns, self.sequence = None, 0
