"""The recorder: lessons begin and end as people wish, and as the disk allows."""

import errno
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

from models.config.site import LessonsConfig
from models.messages.lesson import Entry, FusionLog, SegmentRequest
from models.messages.trouble import one_line
from services.lesson import recorder as module
from services.lesson.folder_lock import lock
from services.lesson.index import LessonIndex
from services.lesson.layout import PART_SUFFIX, SUFFIX
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_header import LessonHeader
from services.lesson.lesson_reader import open_lesson
from services.lesson.recorder import RETRY_NS, SILENT_NS, Recorder, lesson_name
from services.lesson.recovery import recover
from tests.synthetic.broken_index import break_index
from tests.synthetic.lesson import BEGIN_NS, SECOND_NS, header, part


class Room:
    """A recorder with a clock and a disk of the test's own."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch, *, automatic: bool = False) -> None:
        self.now_ns = BEGIN_NS
        self.free_mb = 10_000.0
        self.folder = folder
        lock(folder).close()
        monkeypatch.setattr(module, "free_disk_mib", lambda _folder: self.free_mb * 1e6 / 2**20)
        self.recorder = self.started(automatic=automatic)

    def started(self, unfinished: LessonWriter | None = None, *, automatic: bool = False) -> Recorder:
        config = LessonsConfig(automatic=automatic)
        return Recorder(self.folder, config, self._header, unfinished, lambda: self.now_ns)

    def record(self, parts: int) -> None:
        request = self.recorder.look_after()
        assert request is not None
        for k in range(request.sequence, request.sequence + parts):
            self.now_ns += SECOND_NS // 2
            self.recorder.take(part(request.segment_ns or request.t_ns + 1, k))

    def fusion_begins_anew(self) -> None:
        segment_ns = self.now_ns + 1
        self.now_ns += SECOND_NS
        self.recorder.take(part(segment_ns, 0))

    def files(self, suffix: str) -> list[str]:
        return sorted(path.name for path in self.folder.iterdir() if path.name.endswith(suffix))

    @property
    def trouble(self) -> str:
        """The recorder's trouble as people read it."""
        trouble = self.recorder.trouble
        return "" if trouble is None else one_line((trouble,))

    def _header(self, title: str) -> LessonHeader:
        return header(title)


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
    assert room.recorder.look_after() is None
    room.recorder.take(part(BEGIN_NS + 1, 0))
    assert room.recorder.health().lesson == ""
    assert room.files(PART_SUFFIX) == room.files(SUFFIX) == []


def test_a_lesson_is_recorded_from_start_to_stop(room: Room) -> None:
    room.recorder.start("7b, throwing")
    room.record(parts=4)
    health = room.recorder.health()
    assert (health.title, health.gaps) == ("7b, throwing", 0)
    assert health.recorded_s == pytest.approx(2.0, abs=0.1)
    (written,) = room.folder.glob(f"*{PART_SUFFIX}")
    assert health.size_bytes == written.stat().st_size > 0
    room.recorder.stop()
    assert room.recorder.look_after() is None
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
    assert room.recorder.look_after() == SegmentRequest(BEGIN_NS, BEGIN_NS + 1, 2)


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


def test_a_disk_that_fills_up_ends_the_lesson_cleanly_and_says_so(room: Room) -> None:
    room.recorder.start("one")
    room.record(parts=3)
    room.free_mb = 499.0
    assert room.recorder.look_after() is None
    assert "499 MB are left on the disk, lessons.least_free_mb is 500" in room.trouble
    (name,) = room.files(SUFFIX)
    with open_lesson(room.folder / name) as lesson:
        assert lesson.summary().parts == 3
    room.recorder.start("two")
    assert "no lesson was begun" in room.trouble
    room.free_mb = 501.0
    room.recorder.start("three")
    assert room.trouble == ""
    assert room.recorder.health().title == "three"


def test_a_write_error_ends_the_lesson_and_what_was_safe_stays_readable(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    room.recorder.start("one")
    room.record(parts=3)

    def fail(*_: object) -> None:
        raise OSError(errno.EIO, "Input/output error")

    room.now_ns += SECOND_NS
    with monkeypatch.context() as broken:
        broken.setattr("services.lesson.lesson_file.os.fsync", fail)
        room.recorder.take(part(BEGIN_NS + 1, 3))
    assert "Input/output error" in room.trouble
    assert room.recorder.health().lesson == ""
    assert room.files(PART_SUFFIX)
    assert recover(room.folder, run_ns=0) is None
    (name,) = room.files(SUFFIX)
    with open_lesson(room.folder / name) as lesson:
        assert lesson.summary().parts == 3


def test_trouble_with_the_list_of_lessons_is_no_trouble_of_a_lesson_that_is_finished(room: Room) -> None:
    LessonIndex(room.folder).lessons()
    break_index(room.folder)
    room.recorder.start("one")
    room.record(parts=3)
    room.recorder.stop()
    assert room.trouble == ""
    (name,) = room.files(SUFFIX)
    with open_lesson(room.folder / name) as lesson:
        assert lesson.summary().parts == 3


def vanish(room: Room, how: str) -> Path:
    """Take the file of the lesson that is being recorded away from its name; the file that is there then, if any."""
    (file,) = room.folder.glob(f"*{PART_SUFFIX}")
    if how == "removed":
        file.unlink()
    elif how == "renamed":
        file = file.rename(room.folder / f"elsewhere{PART_SUFFIX}")
    elif how == "replaced":
        file.unlink()
        file.write_bytes(b"another's")
    else:
        room.folder.rename(room.folder.with_name("moved away"))
    return file


VANISHED = ("removed", "renamed", "replaced", "folder moved away")


@pytest.mark.parametrize("how", VANISHED)
def test_a_lesson_whose_file_is_not_there_any_more_ends_within_a_second_and_nobody_is_sent_to_make_room(
    room: Room, how: str
) -> None:
    room.recorder.start("one")
    room.record(parts=3)
    lesson = room.recorder.health().lesson
    file = vanish(room, how)
    assert room.recorder.look_after() is None
    assert room.recorder.health().lesson == ""
    assert f"lesson {lesson} ended: its file was removed, renamed or replaced" in room.trouble
    assert "make room" not in room.trouble
    assert "completes it" not in room.trouble
    if how == "replaced":
        assert file.read_bytes() == b"another's"
    if how == "renamed":
        assert recover(room.folder, run_ns=0) is None
        with open_lesson(room.folder / f"elsewhere{SUFFIX}") as opened:
            assert opened.summary().parts == 3


@pytest.mark.parametrize("how", VANISHED)
def test_a_lesson_that_is_stopped_before_its_loss_was_seen_is_not_said_to_be_recorded(room: Room, how: str) -> None:
    room.recorder.start("one")
    room.record(parts=3)
    vanish(room, how)
    room.recorder.stop()
    assert "its file was removed, renamed or replaced" in room.trouble
    room.recorder.stop()  # The wish is repeated until it is seen to be done.
    assert "its file was removed, renamed or replaced" in room.trouble


def test_after_the_folder_was_moved_away_the_next_lesson_makes_it_anew(room: Room) -> None:
    room.recorder.start("one")
    room.record(parts=1)
    vanish(room, "folder moved away")
    assert room.recorder.look_after() is None
    room.recorder.start("two")
    assert room.trouble == ""
    room.record(parts=2)
    room.recorder.stop()
    (name,) = room.files(SUFFIX)
    with open_lesson(room.folder / name) as opened:
        assert opened.summary().parts == 2


@pytest.mark.parametrize("code", [errno.EIO, errno.ESTALE, errno.EACCES], ids=errno.errorcode.get)
def test_a_lesson_whose_file_cannot_be_looked_at_ends_with_the_reason_and_comes_back_when_its_disk_does(
    room: Room, monkeypatch: pytest.MonkeyPatch, code: int
) -> None:
    room.recorder.start("one")
    room.record(parts=3)
    lesson = room.recorder.health().lesson
    real = Path.stat

    def stat(path: Path, *, follow_symlinks: bool = True) -> os.stat_result:
        if path.name.endswith(PART_SUFFIX):
            raise OSError(code, os.strerror(code))
        return real(path, follow_symlinks=follow_symlinks)

    with monkeypatch.context() as pulled:
        pulled.setattr(Path, "stat", stat)
        assert room.recorder.look_after() is None
        assert room.recorder.health().lesson == ""
        assert f"lesson {lesson} ended: {os.strerror(code)}" in room.trouble
    room.recorder.start("two")
    assert room.trouble == ""
    room.recorder.stop()
    assert recover(room.folder, run_ns=0) is None
    with open_lesson(room.folder / f"{lesson}{SUFFIX}") as opened:
        assert opened.summary().parts == 3


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


def test_a_folder_that_cannot_be_written_to_is_named(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(LessonWriter, "create", refuse)
    room.recorder.start("one")
    assert "no lesson was begun: Read-only file system" in room.trouble
    assert room.recorder.health().lesson == ""


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
    assert room.recorder.look_after() == SegmentRequest(room.now_ns, BEGIN_NS + 1, 2)
    if kept:
        room.record(parts=2)
    else:
        room.fusion_begins_anew()
    room.recorder.close()
    gaps = ["", "", "", ""] if kept else ["", "", "the recorder was started again"]
    with open_lesson(room.folder / f"{name}{SUFFIX}") as lesson:
        assert [item.gap for item in lesson.parts()] == gaps


def no_space(*_: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


@pytest.mark.parametrize("fails", ["os.fsync", "rename_free"], ids=["the summary", "the names"])
def test_a_lesson_that_a_person_ended_is_never_gone_on_with_even_if_it_could_not_be_finished(
    room: Room, monkeypatch: pytest.MonkeyPatch, fails: str
) -> None:
    room.recorder.start("one")
    room.record(parts=2)
    name = room.recorder.health().lesson
    with monkeypatch.context() as full:
        full.setattr(f"services.lesson.lesson_file.{fails}", no_space)
        room.recorder.stop()
        assert f"lesson {name} ended: No space left on device" in room.trouble
        assert recover(room.folder, header().run_ns) is None, "nor while it still cannot be finished"
    room.recorder = room.started(recover(room.folder, header().run_ns))
    assert room.recorder.health().lesson == ""
    assert room.recorder.look_after() is None
    assert (room.files(PART_SUFFIX), room.files(SUFFIX)) == ([], [f"{name}{SUFFIX}"])
    with open_lesson(room.folder / f"{name}{SUFFIX}") as lesson:
        assert lesson.summary().parts == 2


def test_a_lesson_that_was_ended_before_its_first_part_is_never_gone_on_with(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    room.recorder.start("one")
    with monkeypatch.context() as full:
        full.setattr("services.lesson.lesson_file.os.fsync", no_space)
        room.recorder.stop()
    assert recover(room.folder, header().run_ns) is None
    assert len(room.files(SUFFIX)) == 1


def test_an_automatic_recorder_begins_by_itself_and_stops_for_good_when_told_to(automatic_room: Room) -> None:
    room = automatic_room
    room.record(parts=1)
    assert room.recorder.health().title == module.AUTOMATIC_TITLE
    room.recorder.stop()
    room.now_ns += 2 * RETRY_NS
    assert room.recorder.look_after() is None


def test_an_automatic_recorder_waits_until_there_is_room_again(automatic_room: Room) -> None:
    room = automatic_room
    room.free_mb = 1.0
    assert room.recorder.look_after() is None
    room.free_mb = 10_000.0
    assert room.recorder.look_after() is None
    room.now_ns += RETRY_NS
    assert room.recorder.look_after() is not None
    assert room.trouble == ""


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
