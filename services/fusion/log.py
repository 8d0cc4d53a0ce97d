"""The log of what fusion takes in and gives out, in its order, for as long as somebody asks for it (`models.messages.lesson`)."""

from collections import deque
from typing import Final, NamedTuple

from models.messages.lesson import LEASE_NS, Entry, EntryKind, FusionLog, SegmentRequest

PART_NS = 500_000_000
"""Length of a part. What fusion has not published when it dies is lost."""
SAID: Final = frozenset[EntryKind](("feedback", "corrections"))
"""A part with what was said of an attempt is published at the next tick: a lesson may end now, and whoever says that it shall has
seen this on the page. A few a minute."""
MAX_PART_BYTES = 1 << 20
"""A part that has reached this is published early, at the next tick; it is larger by what came in since the last one."""
MAX_KEPT_BYTES = 16 << 20
"""Of parts that were given out already; several times what eight cameras make in `LEASE_NS`."""
IN_FLIGHT_NS = 1_000_000_000
"""So long the newest part may take to reach the recorder; before that it is not missed."""


class Answer(NamedTuple):
    """What a request brings about.

    Attributes:
        begins: a segment begins, for which fusion needs a new state.
        again: parts to be published, in this order: those that were missed, or what the segment that ends still holds.
    """

    begins: bool = False
    again: tuple[FusionLog, ...] = ()


class _Kept(NamedTuple):
    part: FusionLog
    t_ns: int
    size: int


class SegmentLog:
    """Collects entries and gives them out in parts; does nothing until it is asked, nor once nobody asks any more."""

    def __init__(self) -> None:
        self._request_ns = 0
        self._asked_ns = 0
        self._segment_ns = 0
        self._sequence = 0
        self._part_ns = 0
        self._bytes = 0
        self._said = False
        self._entries: list[Entry] = []
        self._kept: deque[_Kept] = deque()

    @property
    def running(self) -> bool:
        """Whether entries are collected."""
        return self._request_ns > 0

    def ask(self, request: SegmentRequest, now_ns: int) -> Answer:
        """A request was heard at `now_ns`.

        A request from the future, or for a part of the future, is damaged, and would shut out every later one.
        """
        goes_on = self.running and request.segment_ns == self._segment_ns
        if request.t_ns > now_ns or (goes_on and request.sequence > self._sequence):
            return Answer()
        self._asked_ns = now_ns
        if goes_on and request.sequence >= self._sequence - len(self._kept):
            self._request_ns = max(self._request_ns, request.t_ns)
            return Answer(again=self._missed(request.sequence, now_ns))
        if request.t_ns <= self._request_ns and request.segment_ns < self._segment_ns:
            return Answer()  # A repetition: its segment has begun, of which the recorder had not heard yet.
        rest = (self._collected(),) if self._entries else ()
        self._request_ns = request.t_ns
        self._segment_ns, self._sequence = now_ns, 0
        self._kept.clear()
        self._begin_part(now_ns)
        return Answer(begins=True, again=rest)

    def add(self, kind: EntryKind, t_ns: int, payload: bytes = b"") -> None:
        """Something was taken in or given out."""
        if self.running:
            self._entries.append(Entry(kind, t_ns, payload))
            self._bytes += len(payload)
            self._said |= kind in SAID

    def part(self, now_ns: int) -> FusionLog | None:
        """The next part, if it is due. Call it often."""
        due = now_ns - self._part_ns >= PART_NS or self._bytes >= MAX_PART_BYTES or self._said
        if not self.running or not due:
            return None
        part = self._collected()
        self._keep(_Kept(part, now_ns, self._bytes))
        self._sequence += 1
        self._begin_part(now_ns)
        if now_ns - self._asked_ns > LEASE_NS:
            self._request_ns = 0
            self._kept.clear()
        return part

    def _collected(self) -> FusionLog:
        return FusionLog(self._segment_ns, self._sequence, tuple(self._entries))

    def _keep(self, newest: _Kept) -> None:
        self._kept.append(newest)
        size = sum(kept.size for kept in self._kept)
        while self._kept and (newest.t_ns - self._kept[0].t_ns > LEASE_NS or size > MAX_KEPT_BYTES):
            size -= self._kept.popleft().size

    def _missed(self, sequence: int, now_ns: int) -> tuple[FusionLog, ...]:
        """The parts from `sequence` on, if the recorder must have missed one of them."""
        parts = [kept for kept in self._kept if kept.part.sequence >= sequence]
        if len(parts) <= 1 and all(now_ns - kept.t_ns < IN_FLIGHT_NS for kept in parts):
            return ()
        return tuple(kept.part for kept in parts)

    def _begin_part(self, now_ns: int) -> None:
        self._part_ns = now_ns
        self._bytes = 0
        self._said = False
        self._entries = []
