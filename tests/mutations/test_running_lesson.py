"""Mutated parts of fusion's log through the recorder while it records, each as the part that the lesson waits for.

A part with another segment's name or number is left out before it is written, which `test_mutations` covers: so here they follow
the recorder. What of them can be read as a part is written, and the files must be whole all the same.
"""

import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from mcap.reader import make_reader

from models.messages import codec, topics
from models.messages.lesson import FusionLog, LessonRequest
from models.process import Delivery
from services.lesson.folder_lock import lock
from services.lesson.lesson_reader import open_lesson
from services.lesson.process import RecorderLoop
from tests.mutations.feed import COUNTS, GROWTH_MB, FeedBus, Growth, context_of
from tests.mutations.mutate import mutants
from tests.mutations.samples import log

LESSON_LENGTH = 1000
"""Mutants before the next lesson is begun, so that lessons end and begin among them."""


def expected(loop: RecorderLoop) -> FusionLog:
    """The part that the lesson waits for."""
    running, now_ns = loop._recorder._running, time.monotonic_ns()
    if running is None or running.following.segment_ns == 0:
        return log(now_ns, 0, now_ns)
    return log(now_ns, running.following.sequence, running.following.segment_ns)


def latest_ns(path: Path) -> int:
    """Of all messages in a lesson, as any reader of MCAP is told."""
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    assert summary.statistics is not None
    return summary.statistics.message_end_time


@pytest.mark.parametrize("count", COUNTS)
def test_whatever_reaches_the_writer_the_lessons_are_whole(count: int, tmp_path: Path) -> None:
    stop, growth, folder = threading.Event(), Growth(), tmp_path / "lessons"

    def lessons() -> Iterator[Delivery]:
        samples = [b""]
        mutated = mutants(samples, 1, count)
        for number in range(count):
            if number == count // 10:
                growth.settled()
            if number % LESSON_LENGTH == 0:
                yield Delivery(topics.lesson_request(), codec.encode(LessonRequest("stop")))
                yield Delivery(topics.lesson_request(), codec.encode(LessonRequest("start", "among them")))
            samples[:] = [codec.encode(expected(loop))]
            yield Delivery(topics.fusion_log(), next(mutated))

    bus = FeedBus(lessons(), stop)
    with lock(folder):
        loop = RecorderLoop(context_of("recorder", bus, stop, tmp_path), folder)
        loop.run()
        ended_ns = time.monotonic_ns()
    assert growth.mb < GROWTH_MB
    assert bus.refused > count // 4, "many mutants can be read as a part"
    finished = sorted(folder.glob("*.mcap"))
    assert len(finished) == len(range(0, count, LESSON_LENGTH)), "a mutant ended a lesson"
    assert not list(folder.glob("*.part"))
    parts = 0
    for path in finished:
        with open_lesson(path) as lesson:
            parts += lesson.summary().parts
            assert all(part.segment_ns > 0 for part in lesson.parts()), "a part of no segment was written"
        assert latest_ns(path) <= ended_ns, "a mutant's time dates what came after it"
    assert parts > count // 10, "the mutants did not reach the writer"
