"""The recorder: lessons begin and end as people wish."""

import errno
from collections.abc import Iterator
from pathlib import Path

import pytest
from structlog.testing import capture_logs

from models.messages import codec
from models.messages.attempts import REMEMBERED
from models.messages.feedback import Feedback
from models.messages.lesson import Entry, FusionLog, SegmentRequest
from services.lesson import recorder as module
from services.lesson.layout import PART_SUFFIX, SUFFIX
from services.lesson.lesson_reader import open_lesson
from services.lesson.pupils import attempts_told
from services.lesson.recorder import RETRY_NS, SILENT_NS, lesson_name
from services.lesson.told_to_stop import SUFFIX as WISH_SUFFIX
from tests.mutations.samples import feedback
from tests.synthetic.lesson import BEGIN_NS, SECOND_NS, header, part
from tests.synthetic.recording_room import Room
from tests.synthetic.recovery import recover


@pytest.fixture
def room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Room]:
    (tmp_path / "lessons").mkdir()
    room = Room(tmp_path / "lessons", monkeypatch)
    yield room
    room.recorder.close()


@pytest.fixture
def automatic_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Room]:
    room = Room(tmp_path, monkeypatch, automatic=True)
    yield room
    room.recorder.close()


def test_nothing_is_recorded_and_fusion_is_asked_for_nothing_before_somebody_wishes_it(room: Room) -> None:
    assert room.asks() is None
    room.recorder.take(part(BEGIN_NS + 1, 0))
    assert room.recorder.health().lesson == ""
    assert room.files(PART_SUFFIX) == room.files(SUFFIX) == []


def test_a_lesson_is_of_who_asked_for_it_first(room: Room) -> None:
    room.recorder.start("7b", asked_ns=5)
    room.recorder.start("7b", asked_ns=6)
    assert room.recorder.health().asked_ns == 5
    room.recorder.stop()
    assert room.recorder.health().asked_ns == 0
    room.recorder.start("7b", asked_ns=6)
    assert room.recorder.health().asked_ns == 6


def test_a_lesson_is_recorded_from_start_to_stop(room: Room) -> None:
    room.recorder.start("7b, throwing")
    room.record(parts=4)
    health = room.recorder.health()
    assert (health.title, health.gaps) == ("7b, throwing", 0)
    assert health.recorded_s == pytest.approx(2.0, abs=0.1)
    (written,) = room.folder.glob(f"*{PART_SUFFIX}")
    assert health.size_bytes == written.stat().st_size > 0
    room.recorder.stop()
    assert room.asks() is None
    (name,) = room.files(SUFFIX)
    with open_lesson(room.folder / name) as lesson:
        assert lesson.summary().parts == 4
    assert name == f"{health.lesson}{SUFFIX}"


def test_a_second_start_changes_nothing(room: Room) -> None:
    room.recorder.start("one")
    before = room.recorder.health()
    room.recorder.start("two")
    assert room.recorder.health() == before


def test_the_same_request_is_repeated_so_that_fusion_goes_on(room: Room) -> None:
    room.recorder.start("one")
    room.record(parts=2)
    room.now_ns += 5 * SECOND_NS
    assert room.asks() == SegmentRequest(BEGIN_NS, BEGIN_NS + 1, 2)


def test_a_lost_part_is_asked_for_and_a_gap_in_the_file_only_if_fusion_does_not_have_it_any_more(room: Room) -> None:
    room.recorder.start("one")
    room.record(parts=2)
    room.now_ns += SECOND_NS
    room.recorder.take(part(BEGIN_NS + 1, 3))
    room.record(parts=2)
    assert room.recorder.health().gaps == 0
    room.recorder.take(part(BEGIN_NS + 1, 5))
    room.fusion_begins_anew()
    assert room.recorder.health().gaps == 1
    room.recorder.stop()
    (name,) = room.files(SUFFIX)
    with open_lesson(room.folder / name) as lesson:
        assert [item.gap for item in lesson.parts()] == ["", "", "", "", "fusion began anew"]


@pytest.mark.parametrize("wrong", ["an entry's time", "the segment's name"])
def test_a_part_from_the_future_is_left_out_and_asked_for_again_and_does_not_date_what_comes_after_it(
    room: Room, wrong: str
) -> None:
    room.recorder.start("one")
    room.record(parts=1)
    room.now_ns += SECOND_NS // 2
    good = part(BEGIN_NS + 1, 1)
    late = Entry("tick", 2**62, b"")
    bad = FusionLog(good.segment_ns, 1, (late, *good.entries)) if wrong == "an entry's time" else FusionLog(2**62, 0, good.entries)
    room.recorder.take(bad)
    room.recorder.take(good if wrong == "the segment's name" else part(BEGIN_NS + 1, 2))
    room.record(parts=2)
    assert room.recorder.health().recorded_s < 10
    assert room.recorder.health().gaps == 0
    room.recorder.stop()
    (name,) = room.files(SUFFIX)
    with open_lesson(room.folder / name) as lesson:
        assert lesson.summary().seconds < 10


def test_when_fusion_is_not_heard_the_recorder_says_that_it_stands_still(room: Room) -> None:
    room.recorder.start("one")
    room.record(parts=1)
    assert room.trouble == ""
    room.now_ns += SILENT_NS + 1
    assert "stands still: nothing is heard of fusion" in room.trouble
    room.record(parts=1)


def test_a_lesson_that_died_before_its_first_part_has_no_gap_before_it(room: Room) -> None:
    room.recorder.start("one")
    name = room.recorder.health().lesson
    assert room.recorder._running is not None
    room.recorder._running.writer.close()
    room.recorder = room.started(recover(room.folder, header().run_ns))
    room.record(parts=2)
    assert room.recorder.health().gaps == 0
    room.recorder.stop()
    with open_lesson(room.folder / f"{name}{SUFFIX}") as lesson:
        assert [item.gap for item in lesson.parts()] == ["", ""]


@pytest.mark.parametrize("kept", [True, False])
def test_a_lesson_that_the_recorders_death_cut_short_is_gone_on_with(room: Room, kept: bool) -> None:
    room.recorder.start("one")
    room.record(parts=2)
    name = room.recorder.health().lesson
    # The process is killed here, its file closed by the kernel; then it is started again by the supervisor.
    assert room.recorder._running is not None
    room.recorder._running.writer.close()
    room.now_ns += 3 * SECOND_NS
    room.recorder = room.started(recover(room.folder, header().run_ns))
    assert room.recorder.health().lesson == name
    assert room.asks() == SegmentRequest(room.now_ns, BEGIN_NS + 1, 2)
    if kept:
        room.record(parts=2)
    else:
        room.fusion_begins_anew()
    room.recorder.close()
    gaps = ["", "", "", ""] if kept else ["", "", "the recorder was started again"]
    with open_lesson(room.folder / f"{name}{SUFFIX}") as lesson:
        assert [item.gap for item in lesson.parts()] == gaps


def test_a_wish_to_end_another_lesson_ends_none(automatic_room: Room) -> None:
    automatic_room.recorder.look_after()
    running = automatic_room.recorder.health().lesson
    assert running
    automatic_room.recorder.stop("2026-11-22-of-the-class-before")
    assert automatic_room.recorder.health().lesson == running
    automatic_room.recorder.stop(running)
    assert automatic_room.recorder.health().lesson == ""


def test_an_automatic_recorder_begins_by_itself_and_stops_for_good_when_told_to(automatic_room: Room) -> None:
    room = automatic_room
    room.record(parts=1)
    assert room.recorder.health().title == module.AUTOMATIC_TITLE
    room.recorder.stop()
    room.now_ns += 2 * RETRY_NS
    assert room.asks() is None


def test_an_automatic_recorder_that_was_told_to_stop_and_then_died_does_not_record_when_it_is_started_again(
    automatic_room: Room,
) -> None:
    room = automatic_room
    room.record(parts=1)
    room.recorder.stop()
    for _ in range(2):
        room.recorder = room.started(recover(room.folder, header().run_ns), automatic=True)
        room.now_ns += 2 * RETRY_NS
        assert room.asks() is None
    room.recorder.start("7b")
    assert room.asks() is not None


def test_the_next_start_of_the_box_records_by_itself_again_and_nothing_is_left_of_earlier_wishes(automatic_room: Room) -> None:
    room = automatic_room
    for run_ns in (1, 2, 3):
        room.recorder = room.started(automatic=True, run_ns=run_ns)
        room.now_ns += 60 * SECOND_NS
        assert room.asks() is not None
        room.recorder.stop()
    assert len(room.files(WISH_SUFFIX)) == 1


def test_a_wish_that_cannot_be_kept_is_said_and_ends_the_lesson_all_the_same(
    automatic_room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    room = automatic_room
    room.record(parts=1)

    def refuse(*_: object, **__: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    with monkeypatch.context() as broken, capture_logs() as logs:
        broken.setattr(Path, "touch", refuse)
        room.recorder.stop()
    assert room.asks() is None
    assert len(room.files(SUFFIX)) == 1
    assert "Read-only file system" in [line.get("reason") for line in logs]


@pytest.mark.parametrize(
    ("title", "ending"),
    [
        ("7b, throwing", "-7b-throwing"),
        ("", ""),
        ("../../etc", "-etc"),
        ("Würfe: 3. Stunde!", "-würfe-3-stunde"),
        ("a" * 80, "-" + "a" * 40),
    ],
)
def test_a_lessons_name_is_a_safe_file_name_that_people_recognise(title: str, ending: str) -> None:
    name = lesson_name(header(title), set())
    assert name[:11].count("-") == 3
    assert name[15:] == ending
    assert "/" not in name
    assert lesson_name(header(title), {name, f"{name}-2"}) == f"{name}-3"


def attempts_in(told: list[Feedback], sequence: int) -> FusionLog:
    """A part of the log in which these attempts were told."""
    return FusionLog(BEGIN_NS + 1, sequence, tuple(Entry("feedback", BEGIN_NS + 2, codec.encode(one)) for one in told))


def test_the_recorder_says_which_attempts_the_file_holds_also_after_it_was_killed(room: Room) -> None:
    told = [feedback(BEGIN_NS + number * SECOND_NS // 100) for number in range(REMEMBERED + 5)]
    ids = tuple(one.id for one in told)
    room.recorder.start("one")
    assert (room.recorder.health().began_ns, room.recorder.health().attempts) == (BEGIN_NS, 0)
    room.now_ns += SECOND_NS
    room.recorder.take(attempts_in(told[:2], 0))
    room.recorder.take(attempts_in(told[2:-1], 1))
    assert (room.recorder.health().attempts, room.recorder.health().newest) == (REMEMBERED + 4, ids[4:-1])
    assert room.recorder._running is not None
    room.recorder._running.writer.close()
    room.recorder = room.started(recover(room.folder, header().run_ns))
    health = room.recorder.health()
    assert (health.began_ns, health.attempts, health.newest) == (BEGIN_NS, REMEMBERED + 4, ids[4:-1])
    room.recorder.take(attempts_in(told[-1:], 2))
    assert (room.recorder.health().attempts, room.recorder.health().newest) == (REMEMBERED + 5, ids[5:])
    room.recorder.stop()
    assert room.recorder.health().newest == ()
    (name,) = room.files(SUFFIX)
    with open_lesson(room.folder / name) as lesson:
        assert tuple(one.id for one in attempts_told(lesson.parts())) == ids, "the last of them is number `attempts`"


def test_an_attempt_that_cannot_be_read_counts_and_has_no_name(room: Room) -> None:
    room.recorder.start("one")
    room.now_ns += SECOND_NS
    room.recorder.take(FusionLog(BEGIN_NS + 1, 0, (Entry("feedback", BEGIN_NS + 2, b"damaged"),)))
    assert (room.recorder.health().attempts, room.recorder.health().newest) == (1, (0,))
