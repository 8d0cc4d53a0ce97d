"""Small lessons for tests: a header, and parts of fusion's log with entries of every kind."""

from models.messages.lesson import Entry, FusionLog
from services.lesson.lesson_header import LessonHeader

SECOND_NS = 1_000_000_000
BEGIN_NS = 5 * SECOND_NS


def header(title: str = "7b, throwing", run_ns: int = SECOND_NS) -> LessonHeader:
    return LessonHeader(
        title=title,
        kinebox="0.1.0",
        machine="test",
        preset="default",
        site_toml="version = 1\n",
        rig_toml="version = 1\n",
        started_ns=BEGIN_NS,
        wall_minus_monotonic_ns=1_700_000_000 * SECOND_NS,
        run_ns=run_ns,
    )


def part(segment_ns: int, sequence: int) -> FusionLog:
    """Half a second of log. As in life, a tick is dated a little before the observation that was taken in ahead of it."""
    t_ns = segment_ns + sequence * SECOND_NS // 2
    entries = []
    for k in range(4):
        at_ns = t_ns + k * SECOND_NS // 8
        entries += [
            Entry("observation", at_ns + 5000, b"observation %d " % k * 20),
            Entry("tick", at_ns, b""),
            Entry("motion", at_ns + 9000, bytes(range(256))),
        ]
    return FusionLog(segment_ns, sequence, (*entries, Entry("health", t_ns + SECOND_NS // 2 - 1, b"ok")))
