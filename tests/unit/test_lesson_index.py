"""The list of lessons: what is in the folder, however the index was lost, broken or out of date."""

import datetime as dt
import errno
import fcntl
import json
import os
import sqlite3
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from services.cli.lessons import listed
from services.lesson import index, lesson_header
from services.lesson.index import LessonIndex
from services.lesson.layout import PART_SUFFIX
from services.lesson.lesson_file import LessonWriter
from services.lesson.recovery import reopen
from tests.synthetic.broken_index import break_index
from tests.synthetic.lesson import BEGIN_NS, SECOND_NS, header, part
from tests.synthetic.recovery import recover


def record(folder: Path, name: str, parts: int = 3, *, finish: bool = True) -> Path:
    writer = LessonWriter.create(folder, name, header(f"title of {name}"))
    for k in range(parts):
        segment, gap = (BEGIN_NS, "") if k < 2 else (BEGIN_NS + 9 * SECOND_NS, "a part was lost")
        writer.append(part(segment, k % 2), gap)
    if finish:
        return writer.finish()
    writer.close()
    return writer.path


def test_a_lesson_is_listed_with_its_figures(tmp_path: Path) -> None:
    file = record(tmp_path, "a")
    (row,) = LessonIndex(tmp_path).lessons()
    assert (row.lesson, row.title, row.state, row.problem) == ("a", "title of a", "finished", "")
    assert (row.gaps, row.segments, row.bytes) == (1, 2, file.stat().st_size)
    assert row.seconds == pytest.approx(9.5, abs=0.01)
    assert row.started_s == pytest.approx(1_700_000_005.0)


def test_what_the_recorder_notes_is_what_reading_the_file_would_give(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    record(tmp_path, "a")
    (read,) = LessonIndex(tmp_path).lessons()
    (tmp_path / index.NAME).unlink()
    (tmp_path / "a.mcap").rename(tmp_path / f"a{PART_SUFFIX}")
    assert recover(tmp_path, run_ns=0) is None
    monkeypatch.setattr(index, "open_lesson", None)
    (noted,) = LessonIndex(tmp_path).lessons()
    assert noted.seconds == pytest.approx(read.seconds, abs=1e-3)
    assert noted == replace(read, changed_ns=noted.changed_ns, seconds=noted.seconds)


def test_files_that_come_go_and_change_are_followed(tmp_path: Path) -> None:
    lessons = LessonIndex(tmp_path)
    assert lessons.lessons() == []
    first, second = record(tmp_path, "a"), record(tmp_path, "b", parts=1)
    assert {row.lesson for row in lessons.lessons()} == {"a", "b"}
    first.unlink()
    second.unlink()
    record(tmp_path, "b", parts=3)
    (row,) = lessons.lessons()
    assert (row.lesson, row.segments) == ("b", 2)


def test_neither_of_a_finished_and_an_unfinished_lesson_of_one_name_hides_the_other(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = record(tmp_path, "a").read_bytes()
    (tmp_path / f"a{PART_SUFFIX}").write_bytes(copy[: len(copy) // 2])
    both = {("a", "finished", str(tmp_path / "a.mcap")), ("a", "unfinished", str(tmp_path / f"a{PART_SUFFIX}"))}
    for _ in range(2):
        listed(tmp_path, json=True)
        assert {(row["lesson"], row["state"], row["file"]) for row in json.loads(capsys.readouterr().out)} == both
        monkeypatch.setattr(index, "_read", None)  # The second time both are known.


def test_programs_are_told_the_file_of_an_unfinished_lesson_that_is_damaged(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / f"b{PART_SUFFIX}").write_bytes(b"nothing")
    listed(tmp_path, json=True)
    (row,) = json.loads(capsys.readouterr().out)
    assert (row["state"], row["file"]) == ("damaged", str(tmp_path / f"b{PART_SUFFIX}"))


def test_a_file_that_is_unchanged_is_not_read_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    record(tmp_path, "a")
    known = LessonIndex(tmp_path).lessons()
    monkeypatch.setattr(index, "open_lesson", None)
    assert LessonIndex(tmp_path).lessons() == known


@pytest.mark.parametrize("content", [b"", b"no database at all" * 100, b"SQLite format 3\x00" + bytes(5000)])
def test_a_broken_index_is_made_anew_from_the_files(tmp_path: Path, content: bytes) -> None:
    record(tmp_path, "a")
    known = LessonIndex(tmp_path).lessons()
    (tmp_path / index.NAME).write_bytes(content)
    assert LessonIndex(tmp_path).lessons() == known
    assert LessonIndex(tmp_path).lessons() == known


def test_an_index_of_another_version_is_made_anew(tmp_path: Path) -> None:
    record(tmp_path, "a")
    with sqlite3.connect(tmp_path / index.NAME) as connection:
        connection.execute("CREATE TABLE lessons (otherwise TEXT)")
        connection.execute("PRAGMA user_version = 99")
    connection.close()
    assert [row.lesson for row in LessonIndex(tmp_path).lessons()] == ["a"]


def spoil(folder: Path, *statements: str) -> None:
    with sqlite3.connect(folder / index.NAME) as connection:
        for statement in statements:
            connection.execute(statement)
    connection.close()


@pytest.mark.parametrize(
    "statements",
    [
        ["UPDATE lessons SET title = x'ff00'"],
        ["UPDATE lessons SET title = CAST(x'ff' AS TEXT)"],
        ["UPDATE lessons SET bytes = 'many'"],
        ["UPDATE lessons SET started_s = 9e999"],
        ["UPDATE lessons SET seconds = 1e300"],
        ["DROP TABLE lessons", "CREATE TABLE lessons (otherwise TEXT)", "PRAGMA user_version = 0"],
        ["DROP TABLE lessons", "CREATE VIEW lessons AS SELECT 1", "PRAGMA user_version = 0"],
    ],
)
def test_an_index_that_holds_what_no_list_does_is_made_anew_once(tmp_path: Path, statements: list[str]) -> None:
    record(tmp_path, "a")
    known = LessonIndex(tmp_path).lessons()
    spoil(tmp_path, *statements)
    assert LessonIndex(tmp_path).lessons() == known
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(index, "open_lesson", None)
        assert LessonIndex(tmp_path).lessons() == known, "the second time it is not read again"


NO_TEXT = os.fsdecode(b"t\xfcrnen")


@pytest.mark.parametrize("suffix", [".mcap", PART_SUFFIX])
def test_a_lesson_whose_files_name_is_no_text_is_listed_with_what_to_do(tmp_path: Path, suffix: str) -> None:
    record(tmp_path, "good")
    file = record(tmp_path, "other", finish=suffix == ".mcap")
    file.rename(tmp_path / f"{NO_TEXT}{suffix}")
    for _ in range(2):
        rows = {row.lesson: row for row in LessonIndex(tmp_path).lessons()}
        assert {name: row.state for name, row in rows.items()} == {"good": "finished", "t\\xfcrnen": "damaged"}
        assert "the name of lesson t\\xfcrnen is not UTF-8; rename the file" in rows["t\\xfcrnen"].problem


@pytest.mark.parametrize("seconds", [10**11, -(10**11)])
def test_a_damaged_file_of_an_impossible_date_is_listed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, seconds: int) -> None:
    (tmp_path / "a.mcap").write_bytes(b"nothing")
    real = Path.stat

    def stat(path: Path, *, follow_symlinks: bool = True) -> os.stat_result | SimpleNamespace:
        status = real(path, follow_symlinks=follow_symlinks)
        return (
            SimpleNamespace(st_mode=status.st_mode, st_size=7, st_mtime_ns=seconds * SECOND_NS) if path.name == "a.mcap" else status
        )

    monkeypatch.setattr(Path, "stat", stat)
    (row,) = LessonIndex(tmp_path).lessons()
    assert row.state == "damaged"
    assert dt.datetime.fromtimestamp(row.started_s, tz=dt.UTC).year in {1677, 2262}


def test_a_link_in_a_circle_is_listed_as_damaged(tmp_path: Path) -> None:
    (tmp_path / "a.mcap").symlink_to(tmp_path / "a.mcap")
    (row,) = LessonIndex(tmp_path).lessons()
    assert row.state == "damaged"
    assert "cannot be read: Too many levels of symbolic links" in row.problem


@pytest.mark.parametrize("field", ["started_ns", "wall_minus_monotonic_ns", "run_ns"])
@pytest.mark.parametrize("value", [10**30, -(10**30), 10**400], ids=["late", "early", "beyond all floats"])
def test_a_lesson_of_an_impossible_time_is_listed_as_damaged(tmp_path: Path, field: str, value: int) -> None:
    LessonWriter.create(tmp_path, "a", replace(header(), **{field: value})).finish()  # type: ignore[arg-type]
    (row,) = LessonIndex(tmp_path).lessons()
    assert row.state == "damaged"
    assert f"{field} is no time" in row.problem


def test_the_lesson_that_is_being_recorded_is_listed_as_such_and_when_its_recorder_died_as_unfinished(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lessons = LessonIndex(tmp_path)
    writer = LessonWriter.create(tmp_path, "a", header("7b"))
    for k in range(4):
        writer.append(part(BEGIN_NS, k))
    os.utime(writer.path, ns=(0, 1_900_000_065 * SECOND_NS))  # The machine got the time of day meanwhile.
    monkeypatch.setattr("services.lesson.index.time.monotonic_ns", lambda: writer.header.started_ns + 60 * SECOND_NS)
    (row,) = lessons.lessons()
    assert (row.title, row.state) == ("7b", "recording")
    assert row.seconds == pytest.approx(60.0)
    recorded_s = writer.recorded_s
    writer.close()
    (row,) = lessons.lessons()
    assert (row.title, row.state, row.segments) == ("7b", "unfinished", 1)
    assert row.seconds == pytest.approx(recorded_s)


def test_a_lesson_that_recovery_goes_on_with_is_being_recorded(tmp_path: Path) -> None:
    writer = reopen(record(tmp_path, "a", finish=False))
    assert [row.state for row in LessonIndex(tmp_path).lessons()] == ["recording"]
    writer.finish()
    assert [row.state for row in LessonIndex(tmp_path).lessons()] == ["finished"]


def test_a_cut_of_a_lesson_is_as_long_as_what_recovery_brings_back(tmp_path: Path) -> None:
    whole = record(tmp_path, "whole", parts=2).read_bytes()
    (tmp_path / "whole.mcap").unlink()
    cut = tmp_path / f"cut{PART_SUFFIX}"
    cut.write_bytes(whole[: len(whole) // 2])
    (before,) = LessonIndex(tmp_path).lessons()
    assert before.state == "unfinished"
    assert recover(tmp_path, run_ns=0) is None
    (recovered,) = LessonIndex(tmp_path).lessons()
    assert recovered.state == "finished"
    assert before.seconds == pytest.approx(recovered.seconds)


def test_a_file_that_cannot_be_read_is_listed_with_its_problem(tmp_path: Path) -> None:
    file = record(tmp_path, "a")
    file.write_bytes(file.read_bytes()[:-40])
    (tmp_path / f"b{PART_SUFFIX}").write_bytes(b"nothing")
    damaged = {row.lesson: row for row in LessonIndex(tmp_path).lessons()}
    assert {row.state for row in damaged.values()} == {"damaged"}
    assert "is damaged" in damaged["a"].problem
    assert "is no lesson" in damaged["b"].problem


def test_a_lesson_on_a_disk_that_fails_is_listed_with_what_to_do(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = record(tmp_path, "a")

    def fail(_: Path) -> None:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr(index, "open_lesson", fail)
    (row,) = LessonIndex(tmp_path).lessons()
    assert row.state == "damaged"
    assert row.problem == f"lesson {file} cannot be read: Input/output error; correct its owner and rights, or mend its disk"


@pytest.mark.parametrize("error", [PermissionError(errno.EACCES, "Permission denied"), OSError(errno.EIO, "Input/output error")])
@pytest.mark.parametrize("finish", [True, False])
def test_a_lesson_that_could_not_be_read_once_is_listed_as_it_is_when_it_can_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: OSError, finish: bool
) -> None:
    file = record(tmp_path, "a", finish=finish)
    real = Path.open

    def refuse(path: Path, *how: Any, **more: Any) -> Any:
        if path == file:
            raise error
        return real(path, *how, **more)

    with monkeypatch.context() as closed:
        closed.setattr(Path, "open", refuse)
        assert [row.state for row in LessonIndex(tmp_path).lessons()] == ["damaged"]
    (row,) = LessonIndex(tmp_path).lessons()
    assert (row.state, row.problem, row.segments) == ("finished" if finish else "unfinished", "", 2)


@pytest.mark.parametrize("finish", [True, False])
def test_a_lesson_of_a_newer_kinebox_is_listed_as_it_is_after_the_update(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, finish: bool
) -> None:
    with monkeypatch.context() as newer:
        newer.setattr(lesson_header, "FORMAT", lesson_header.FORMAT + 1)
        record(tmp_path, "a", finish=finish)
    (row,) = LessonIndex(tmp_path).lessons()
    assert "recorded by a newer KineBox" in row.problem
    monkeypatch.setattr(lesson_header, "FORMAT", lesson_header.FORMAT + 1)
    (row,) = LessonIndex(tmp_path).lessons()
    assert (row.state, row.problem) == ("finished" if finish else "unfinished", "")


def test_a_lesson_that_is_damaged_for_good_is_not_read_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = record(tmp_path, "a")
    file.write_bytes(file.read_bytes()[:-40])
    known = LessonIndex(tmp_path).lessons()
    monkeypatch.setattr(index, "open_lesson", None)
    assert LessonIndex(tmp_path).lessons() == known


@pytest.mark.parametrize("begun", ["created", "reopened"])
def test_a_lesson_that_a_list_looked_at_as_it_began_is_listed_as_recording_from_its_next_part_on(
    tmp_path: Path, begun: str
) -> None:
    left = record(tmp_path, "a", parts=1, finish=False)
    with ExitStack() as stack:
        list_file = stack.enter_context(left.open("rb"))
        fcntl.flock(list_file, fcntl.LOCK_SH)
        if begun == "created":
            real = Path.open

            def seen_at_once(path: Path, *how: Any, **more: Any) -> Any:
                file = real(path, *how, **more)
                fcntl.flock(stack.enter_context(real(path, "rb")), fcntl.LOCK_SH)
                return file

            with pytest.MonkeyPatch.context() as looking:
                looking.setattr(Path, "open", seen_at_once)
                writer = LessonWriter.create(tmp_path, "b", header())
        else:
            writer = reopen(left)
    writer.append(part(BEGIN_NS, 0 if begun == "created" else 1))
    states = {row.lesson: row.state for row in LessonIndex(tmp_path).lessons()}
    assert states[writer.path.name.removesuffix(PART_SUFFIX)] == "recording"
    writer.close()


@pytest.mark.parametrize("trouble", ["malformed", "locked", "folder gone"])
def test_an_index_that_cannot_be_written_stops_nobody_who_has_finished_a_lesson(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, trouble: str
) -> None:
    folder = tmp_path / "lessons"
    folder.mkdir()
    writer = LessonWriter.create(folder, "a", header())
    writer.append(part(BEGIN_NS, 0))
    lessons, path = LessonIndex(folder), writer.finish()
    lessons.lessons()
    if trouble == "malformed":
        break_index(folder)
    elif trouble == "locked":
        monkeypatch.setattr(index, "_PATIENCE_S", 0.01)
        other = sqlite3.connect(folder / index.NAME, isolation_level=None)
        other.execute("BEGIN EXCLUSIVE")
    else:
        path.unlink()
        for left in folder.iterdir():
            left.unlink()
        folder.rmdir()
    lessons.note(writer, path)
    if trouble == "locked":
        other.close()
    if trouble != "folder gone":
        assert [row.lesson for row in lessons.lessons()] == ["a"]


def test_where_no_index_can_be_written_the_lessons_are_listed_all_the_same(tmp_path: Path) -> None:
    record(tmp_path, "a")
    (tmp_path / index.NAME).mkdir()
    assert [row.lesson for row in LessonIndex(tmp_path).lessons()] == ["a"]


def test_the_index_is_kept_so_that_reading_and_writing_do_not_wait_for_one_another(tmp_path: Path) -> None:
    record(tmp_path, "a")
    LessonIndex(tmp_path).lessons()
    connection = sqlite3.connect(tmp_path / index.NAME)
    assert connection.execute("PRAGMA journal_mode").fetchone() == ("wal",)
    connection.close()
