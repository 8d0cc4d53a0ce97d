"""The log of what fusion takes in and gives out, in its order, for as long as somebody asks for it (`models.messages.lesson`)."""

from models.messages.lesson import LEASE_NS, Entry, EntryKind, FusionLog, SegmentRequest

PART_NS = 500_000_000
"""Length of a part. What fusion has not published when it dies is lost."""
MAX_PART_BYTES = 1 << 20
"""A part that has reached this is published early, at the next tick; it is larger by what came in since the last one."""


class SegmentLog:
    """Collects entries and gives them out in parts; does nothing until it is asked, nor once nobody asks any more."""

    def __init__(self) -> None:
        self._request_ns = 0
        self._asked_ns = 0
        self._segment_ns = 0
        self._sequence = 0
        self._part_ns = 0
        self._bytes = 0
        self._entries: list[Entry] = []

    @property
    def running(self) -> bool:
        """Whether entries are collected."""
        return self._request_ns > 0

    def ask(self, request: SegmentRequest, now_ns: int) -> bool:
        """A request was heard at `now_ns`; True if a segment begins by it, for which fusion needs a new state.

        A request from the future is damaged, and would shut out every later one.
        """
        if request.t_ns > now_ns:
            return False
        self._asked_ns = now_ns
        if request.t_ns <= self._request_ns:
            return False
        self._request_ns = request.t_ns
        self._segment_ns, self._sequence = now_ns, 0
        self._begin_part(now_ns)
        return True

    def add(self, kind: EntryKind, t_ns: int, payload: bytes = b"") -> None:
        """Something was taken in or given out."""
        if self.running:
            self._entries.append(Entry(kind, t_ns, payload))
            self._bytes += len(payload)

    def part(self, now_ns: int) -> FusionLog | None:
        """The next part, if it is due. Call it often."""
        if not self.running or (now_ns - self._part_ns < PART_NS and self._bytes < MAX_PART_BYTES):
            return None
        part = FusionLog(self._segment_ns, self._sequence, tuple(self._entries))
        self._sequence += 1
        self._begin_part(now_ns)
        if now_ns - self._asked_ns > LEASE_NS:
            self._request_ns = 0
        return part

    def _begin_part(self, now_ns: int) -> None:
        self._part_ns = now_ns
        self._bytes = 0
        self._entries = []
