"""What fusion's process did live comes out of a replay again, bit for bit."""

from pathlib import Path

import pytest

from models.messages import codec
from models.messages.motion import JointState, Motion
from services.bus.memory import MemoryRouter
from services.fusion.config import PRESETS
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_reader import open_lesson
from services.lesson.recovery import reopen
from services.lesson.replay import Comparison, compare, configuration, difference, replay
from tests.integration.fusion_room import RIG, Cameras, LogRecorder, fusion, header

pytestmark = pytest.mark.slow


def check(path: Path) -> Comparison:
    """As a reader of the file alone: its own calibration and preset."""
    with open_lesson(path) as lesson:
        return compare(replay(lesson.parts(), lesson.header.rig(), configuration(lesson.header.preset)))


def test_a_lesson_replays_as_it_was_live_and_so_does_the_live_figure(tmp_path: Path) -> None:
    router = MemoryRouter()
    writer = LessonWriter.create(tmp_path, "lesson", header())
    recorder = LogRecorder(router, writer)
    cameras = Cameras(router)
    with fusion(router, tmp_path):
        recorder.record(parts=1)  # something came before the lesson
        del recorder.parts[:]
        recorder.record(parts=8, gap="another segment")
    cameras.close()
    path = writer.finish()
    found = check(path)
    assert found.first is None
    assert found.segments == 2
    assert found.equal == found.compared > 60
    with open_lesson(path) as lesson:
        replayed = [
            motion
            for item in replay(lesson.parts(), RIG, PRESETS["default"])
            for motion in item.motions
            if item.segment == 1 and motion.kind == "live"
        ]
    published = {motion.t_ns: motion for motion in recorder.live_motions()}
    assert len(replayed) > 60
    assert any((motion.states == JointState.SEEN).all() for motion in replayed)
    assert [difference(published[motion.t_ns], motion) for motion in replayed] == [""] * len(replayed)


def test_fusion_that_dies_in_a_lesson_leaves_two_segments_and_both_replay(tmp_path: Path) -> None:
    router = MemoryRouter()
    writer = LessonWriter.create(tmp_path, "lesson", header())
    recorder = LogRecorder(router, writer)
    cameras = Cameras(router)
    with fusion(router, tmp_path):
        recorder.record(parts=4)
    with fusion(router, tmp_path):
        recorder.record(parts=4, gap="fusion was restarted")
    cameras.close()
    found = check(writer.finish())
    assert found.first is None
    assert found.segments == 2
    assert found.equal == found.compared > 60


def test_what_is_recovered_of_a_lesson_after_a_crash_replays(tmp_path: Path) -> None:
    router = MemoryRouter()
    writer = LessonWriter.create(tmp_path, "lesson", header())
    recorder = LogRecorder(router, writer)
    cameras = Cameras(router)
    with fusion(router, tmp_path):
        recorder.record(parts=6)
    cameras.close()
    writer.close()
    whole = writer.path.read_bytes()
    smooth = [codec.decode(e.payload, Motion) for part in recorder.parts for e in part.entries if e.kind == "motion"]
    lost = 0
    for cut in (1, 700, len(whole) // 3):
        writer.path.write_bytes(whole[:-cut])
        found = check(reopen(writer.path).finish())
        assert found.first is None
        assert 0 < found.equal == found.compared < len(smooth)
        assert len(smooth) - found.equal >= lost, "the more is cut off, the more is lost"
        lost = len(smooth) - found.equal
