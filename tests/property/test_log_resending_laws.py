"""Fusion's log and the recorder that follows it, over a bus that loses, doubles and delays, with restarts of either."""

import random
from dataclasses import dataclass, field

from hypothesis import given, settings
from hypothesis import strategies as st

from models.messages.lesson import FusionLog, SegmentRequest
from services.fusion.log import SegmentLog
from services.lesson.following import Following

TICK_NS = 33_000_000
SECOND_NS = 1_000_000_000
TROUBLED_TICKS, CALM_TICKS = 1500, 700
ASKED_EVERY = 30
"""Ticks; about a second."""


@dataclass
class Link:
    """One direction of the bus. Messages arrive late, some twice, some never; in any order, or `in_order`."""

    chance: random.Random
    loss: float
    delay_ns: int
    in_order: bool
    latest_ns: int = 0
    under_way: list[tuple[int, int, FusionLog | SegmentRequest]] = field(default_factory=list)
    sent: int = 0

    def send(self, message: FusionLog | SegmentRequest, now_ns: int) -> None:
        for _ in range(self.chance.choice((1, 1, 1, 2))):
            if self.chance.random() >= self.loss:
                self.sent += 1
                due_ns = now_ns + self.chance.randrange(self.delay_ns)
                self.latest_ns = max(self.latest_ns, due_ns) if self.in_order else due_ns
                self.under_way.append((self.latest_ns, self.sent, message))

    def arrived(self, now_ns: int) -> list[FusionLog | SegmentRequest]:
        due = sorted(one for one in self.under_way if one[0] <= now_ns)
        self.under_way = [one for one in self.under_way if one[0] > now_ns]
        return [message for _, _, message in due]


@dataclass
class Story:
    """A lesson that is recorded through all that can happen; what was written of it, and when something was last."""

    chance: random.Random
    loss: float
    delay_ns: int
    in_order: bool = False
    now_ns: int = 1000 * SECOND_NS
    ticks: int = 0
    log: SegmentLog = field(default_factory=SegmentLog)
    following: Following | None = None
    back_ns: int = 0
    written: list[tuple[FusionLog, str]] = field(default_factory=list)
    written_ns: int = 0

    def __post_init__(self) -> None:
        self.to_recorder = Link(self.chance, self.loss, self.delay_ns, self.in_order)
        self.to_fusion = Link(self.chance, self.loss, self.delay_ns, self.in_order)

    def tick(self) -> None:
        self.now_ns += TICK_NS
        self.ticks += 1
        if self.following is None and self.now_ns >= self.back_ns:
            self.following = self._taken_up()
        self.log.add("tick", self.now_ns, str(self.ticks).encode())
        if (part := self.log.part(self.now_ns)) is not None:
            self.to_recorder.send(part, self.now_ns)
        if self.following is not None and self.ticks % ASKED_EVERY == 0:
            self.to_fusion.send(self.following.request, self.now_ns)
        for message in self.to_fusion.arrived(self.now_ns):
            assert isinstance(message, SegmentRequest)
            for missed in self.log.ask(message, self.now_ns).again:
                self.to_recorder.send(missed, self.now_ns)
        for message in self.to_recorder.arrived(self.now_ns):
            assert isinstance(message, FusionLog)
            if self.following is not None and (accepted := self.following.hear(message)) is not None:
                self.written.append((message, accepted.gap))
                self.written_ns = self.now_ns

    def recorder_dies(self, for_s: int) -> None:
        self.following, self.back_ns = None, self.now_ns + for_s * SECOND_NS

    def something_happens(self) -> None:
        match self.chance.randrange(1000):
            case 0:
                self.log = SegmentLog()
            case 1:
                self.recorder_dies(self.chance.choice((1, 3, 15, 30)))
            case 2:
                self.following, self.written = None, []

    def calm(self) -> None:
        for link in (self.to_recorder, self.to_fusion):
            link.loss, link.delay_ns = 0.0, 1

    def _taken_up(self) -> Following:
        if not self.written:
            return Following(self.now_ns)
        last, _ = self.written[-1]
        return Following(self.now_ns, "the recorder was started again", last.segment_ns, last.sequence + 1)


@settings(max_examples=20)
@given(st.integers(0, 2**32), st.sampled_from((0.0, 0.1, 0.5, 0.9)), st.sampled_from((1, SECOND_NS // 3, 2 * SECOND_NS)))
def test_whatever_is_lost_the_lesson_is_whole_within_its_segments_and_goes_on(seed: int, loss: float, delay_ns: int) -> None:
    story = Story(random.Random(seed), loss, delay_ns)  # noqa: S311 - no secret
    for _ in range(TROUBLED_TICKS):
        story.tick()
        story.something_happens()
    story.calm()
    for _ in range(CALM_TICKS + 30 * SECOND_NS // TICK_NS):
        story.tick()
    assert story.now_ns - story.written_ns < 2 * SECOND_NS, "the recording stands still"
    before: FusionLog | None = None
    for part, gap in story.written:
        if before is not None and part.segment_ns == before.segment_ns:
            assert (part.sequence, gap) == (before.sequence + 1, "")
            assert int(part.entries[0].payload) == int(before.entries[-1].payload) + 1
        else:
            assert part.sequence == 0
            assert bool(gap) == (before is not None), "every interruption is said, and nothing else"
            assert before is None or part.segment_ns > before.segment_ns
        before = part


@settings(max_examples=20)
@given(st.integers(0, 2**32), st.sampled_from(((0.0, 2 * SECOND_NS), (0.0, 1), (0.1, SECOND_NS // 10))))
def test_nothing_is_missing_as_long_as_fusion_lives_and_the_recorder_is_back_in_time(seed: int, bus: tuple[float, int]) -> None:
    loss, delay_ns = bus
    story = Story(random.Random(seed), loss, delay_ns, in_order=True)  # noqa: S311 - no secret
    for tick in range(TROUBLED_TICKS):
        story.tick()
        if tick % 400 == 399:
            story.recorder_dies(story.chance.choice((1, 3, 8)))
    story.calm()
    for _ in range(CALM_TICKS):
        story.tick()
    assert [part.sequence for part, _ in story.written] == list(range(len(story.written)))
    assert not [gap for _, gap in story.written if gap]
    assert story.now_ns - story.written_ns < 2 * SECOND_NS
