"""The recorder when its disk fills up, fails or goes away, and when a lesson's file does."""

import errno
import os
import threading
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest

from services.lesson.index import LessonIndex
from services.lesson.layout import PART_SUFFIX, SUFFIX
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_reader import open_lesson
from services.lesson.recorder import RETRY_NS
from services.lesson.recovery import Left
from tests.synthetic.broken_index import break_index
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


def test_a_disk_that_fills_up_ends_the_lesson_cleanly_and_says_so(room: Room) -> None:
    room.recorder.start("one")
    room.record(parts=3)
    room.free_mb = 499.0
    assert room.asks() is None
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


def test_a_refusal_for_want_of_room_is_not_said_any_more_once_there_is_room(room: Room) -> None:
    room.free_mb = 300.0
    room.recorder.start("one")
    assert room.asks() is None
    assert "no lesson was begun: 300 MB are left" in room.trouble, "who asked for it is to hear it"
    assert room.trouble.endswith(f"or other files on the disk of {room.folder}, until 700 MB are free")
    room.free_mb = 501.0
    assert room.asks() is None
    assert room.trouble == ""


@pytest.mark.parametrize(("code", "helps"), [(errno.ENOSPC, "until 700 MB are free"), (errno.EIO, "put the disk back, mend or")])
def test_what_is_to_be_done_about_a_lesson_that_had_to_end_is_against_its_cause(
    room: Room, monkeypatch: pytest.MonkeyPatch, code: int, helps: str
) -> None:
    def fail(*_: object) -> None:
        raise OSError(code, os.strerror(code))

    room.recorder.start("one")
    room.record(parts=1)
    room.now_ns += SECOND_NS
    with monkeypatch.context() as broken:
        broken.setattr("services.lesson.lesson_file.os.fsync", fail)
        room.recorder.take(part(BEGIN_NS + 1, 1))
    trouble = room.recorder.trouble
    assert trouble is not None
    assert ("MB are free" in trouble.remedy, helps in trouble.remedy) == (code == errno.ENOSPC, True)


def test_the_room_that_the_copy_of_a_damaged_lesson_takes_is_told(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    room.recorder.start("one")
    room.record(parts=4)
    room.recorder.stop()
    (name,) = room.files(SUFFIX)
    damaged = (room.folder / name).rename(room.folder / f"damaged{PART_SUFFIX}")
    content = bytearray(damaged.read_bytes())
    content[len(content) // 2] ^= 1
    damaged.write_bytes(content + bytes(3_500_000))
    left = Left(room.folder)
    monkeypatch.setattr("services.lesson.recovery.shutil.disk_usage", lambda _: SimpleNamespace(free=1_000_000))
    left.complete(threading.Event())
    assert left.trouble is not None
    assert left.trouble.words.endswith("No space left on device; it needs 4 MB of room")


def test_a_disk_on_which_no_lesson_can_be_begun_is_told_before_anybody_wishes_one_and_refuses_nobody_who_ends_one(
    room: Room,
) -> None:
    room.free_mb = 300.0
    assert room.asks() is None
    trouble = room.recorder.trouble
    assert trouble is not None
    assert trouble.words == "no lesson can be begun: 300 MB are left on the disk, lessons.least_free_mb is 500"
    assert (trouble.code, bool(trouble.remedy)) == ("disk_full", True), "'not_recording' is how who asked learns that it failed"
    room.free_mb = 501.0
    assert room.asks() is None
    assert room.trouble == ""


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
    assert room.asks() is None
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
    assert room.asks() is None
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
        assert room.asks() is None
        assert room.recorder.health().lesson == ""
        assert f"lesson {lesson} ended: {os.strerror(code)}" in room.trouble
    room.recorder.start("two")
    assert room.trouble == ""
    room.recorder.stop()
    assert recover(room.folder, run_ns=0) is None
    with open_lesson(room.folder / f"{lesson}{SUFFIX}") as opened:
        assert opened.summary().parts == 3


def test_a_folder_that_cannot_be_written_to_is_named(room: Room, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(*_: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    monkeypatch.setattr(LessonWriter, "create", refuse)
    room.recorder.start("one")
    assert "no lesson was begun: Read-only file system" in room.trouble
    assert room.recorder.health().lesson == ""


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
    assert room.asks() is None
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


def test_a_lesson_that_a_full_disk_left_unfinished_is_told_of_also_in_the_next_one_and_finished_once_there_is_room(
    room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    room.recorder.start("one")
    room.record(parts=3)
    name = room.recorder.health().lesson
    with monkeypatch.context() as full:
        full.setattr("services.lesson.lesson_file.os.fsync", no_space)
        room.now_ns += SECOND_NS
        room.recorder.take(part(BEGIN_NS + 1, 3))
        assert f"lesson {name} ended: No space left on device" in room.trouble
        room.left.complete(threading.Event())
    room.recorder.start("two")
    room.record(parts=1)
    assert room.trouble == ""
    assert room.waiting == f"lesson {name} is not finished yet: No space left on device; it needs 1 MB of room"
    assert room.left.trouble is not None
    assert room.left.trouble.remedy.startswith(f"make so much room on the disk of {room.folder}; nothing of it is lost")
    room.left.complete(threading.Event())
    assert room.waiting == ""
    assert room.recorder.health().title == "two"
    room.record(parts=1)
    with open_lesson(room.folder / f"{name}{SUFFIX}") as lesson:
        assert lesson.summary().parts == 3


def test_of_a_lesson_that_a_person_ended_nothing_is_said_any_more_once_it_is_finished(
    room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    room.recorder.start("one")
    room.record(parts=1)
    with monkeypatch.context() as full:
        full.setattr("services.lesson.lesson_file.os.fsync", no_space)
        room.recorder.stop()
        room.left.complete(threading.Event())
        room.recorder.look_after()
        assert room.trouble
        assert room.waiting
    room.left.complete(threading.Event())
    room.recorder.look_after()
    assert (room.trouble, room.waiting) == ("", "")


def test_that_a_full_disk_cut_a_lesson_short_is_said_until_the_next_one_although_it_was_finished(
    room: Room, monkeypatch: pytest.MonkeyPatch
) -> None:
    room.recorder.start("one")
    room.record(parts=1)
    with monkeypatch.context() as full:
        full.setattr("services.lesson.lesson_file.os.fsync", no_space)
        room.now_ns += SECOND_NS
        room.recorder.take(part(BEGIN_NS + 1, 1))
    room.left.complete(threading.Event())
    room.recorder.look_after()
    assert room.waiting == ""
    assert "ended: No space left on device" in room.trouble


def test_an_automatic_recorder_waits_until_there_is_room_again(automatic_room: Room) -> None:
    room = automatic_room
    room.free_mb = 1.0
    assert room.asks() is None
    room.free_mb = 10_000.0
    assert room.asks() is None
    room.now_ns += RETRY_NS
    assert room.asks() is not None
    assert room.trouble == ""
