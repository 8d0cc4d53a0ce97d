"""Lesson files: what was appended is read back, by us and by others, and what is no lesson is refused."""

import errno
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.records import Message, Metadata

from models.errors import UserError
from models.messages.lesson import FusionLog
from services.cli.lessons import delete, find
from services.lesson import lesson_header
from services.lesson.contents import chunk_of
from services.lesson.layout import MARK, PART_SUFFIX
from services.lesson.lesson_file import LessonWriter
from services.lesson.lesson_reader import PartDecoder, open_lesson
from services.lesson.mcap_records import MAGIC, DamageError, OpenChunk, encode
from tests.synthetic.lesson import BEGIN_NS, SECOND_NS, header, part

LATER_NS = BEGIN_NS + 10 * SECOND_NS
PARTS = (part(BEGIN_NS, 0), part(BEGIN_NS, 1), part(LATER_NS, 0), part(LATER_NS, 1))


def write(folder: Path, parts: tuple[FusionLog, ...] = PARTS, name: str = "lesson") -> Path:
    writer = LessonWriter.create(folder, name, header())
    for index, item in enumerate(parts):
        writer.append(item, "a part was lost" if index and item.sequence == 0 else "")
    return writer.finish()


def test_a_lesson_is_read_back_as_it_was_logged(tmp_path: Path) -> None:
    with open_lesson(write(tmp_path)) as lesson:
        assert lesson.header == header()
        parts = list(lesson.parts())
        assert [FusionLog(p.segment_ns, p.sequence, p.entries) for p in parts] == list(PARTS)
        assert [p.begins_segment for p in parts] == [True, False, True, False]
        assert [p.gap for p in parts] == ["", "", "a part was lost", ""]
        summary = lesson.summary()
    assert (summary.segments, summary.gaps, summary.parts) == (2, 1, 4)
    assert summary.entries == {"observation": 16, "tick": 16, "motion": 16, "health": 4}
    assert summary.seconds == pytest.approx(11.0, abs=1e-4)


def test_an_empty_part_and_an_empty_lesson_are_no_exception(tmp_path: Path) -> None:
    with open_lesson(write(tmp_path, (FusionLog(BEGIN_NS, 0, ()),), "empty-part")) as lesson:
        assert [p.entries for p in lesson.parts()] == [()]
        assert lesson.summary().seconds == 0.0
    with open_lesson(write(tmp_path, (), "empty")) as lesson:
        assert lesson.summary().parts == 0


def test_any_reader_of_mcap_finds_every_message_in_fusions_order(tmp_path: Path) -> None:
    with write(tmp_path).open("rb") as file:
        reader = make_reader(file, validate_crcs=True)
        assert reader.get_header().profile == "kinebox"
        found = [
            (channel.topic.rsplit("/", 1)[-1], message.publish_time, message.data)
            for _, channel, message in reader.iter_messages()
            if not channel.topic.endswith("/mark")
        ]
        assert found == [(entry.kind, entry.t_ns, entry.payload) for item in PARTS for entry in item.entries]
        summary = reader.get_summary()
        assert summary is not None
        assert summary.statistics is not None
        assert (summary.statistics.chunk_count, summary.statistics.message_count) == (4, 52 + 4)
        assert {schema.name for schema in summary.schemas.values()} >= {"kinebox.Observation", "kinebox.Motion", "kinebox.Mark"}
        later = list(reader.iter_messages(topics=["gym/fusion/log/tick"], starting_at=LATER_NS))
        assert len(later) == 8
        assert [metadata.metadata["title"] for metadata in reader.iter_metadata()] == ["7b, throwing"]


def test_an_unfinished_lesson_is_not_mistaken_for_a_whole_one(tmp_path: Path) -> None:
    writer = LessonWriter.create(tmp_path, "running", header())
    writer.append(PARTS[0])
    with pytest.raises(UserError, match="is not finished; end its recording"):
        open_lesson(tmp_path / f"running{PART_SUFFIX}")
    writer.close()


def test_of_a_lesson_that_a_full_disk_left_unfinished_nobody_is_told_to_start_a_box_that_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = LessonWriter.create(tmp_path, "full", header())

    def no_space(_: int) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as full:
        full.setattr("services.lesson.lesson_file.os.fsync", no_space)
        with pytest.raises(OSError, match="No space"):
            writer.finish()
    writer.close()
    words = "lesson .*full.* is not finished; .*'kinebox doctor' .*what a full disk left once there is room"
    with pytest.raises(UserError, match=words):
        open_lesson(find("full", tmp_path))
    with pytest.raises(UserError, match=words):
        delete("full", tmp_path, sure=True)


def test_a_file_that_is_not_there_and_one_that_is_no_lesson_are_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"no\.mcap does not exist"):
        open_lesson(tmp_path / "no.mcap")
    for content in (b"", b"PK\x03\x04 a zip", MAGIC + encode()):
        foreign = tmp_path / "foreign.mcap"
        foreign.write_bytes(content)
        with pytest.raises(UserError, match=r"foreign\.mcap is"):
            open_lesson(foreign)


def test_a_lesson_of_a_newer_kinebox_asks_for_an_update(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lesson_header, "FORMAT", lesson_header.FORMAT + 1)
    path = write(tmp_path)
    monkeypatch.undo()
    with pytest.raises(UserError, match=r"recorded by a newer KineBox: it is of KineBox 0\.1\.0; update"):
        open_lesson(path)


def test_a_name_that_is_taken_is_not_overwritten(tmp_path: Path) -> None:
    writer = LessonWriter.create(tmp_path, "lesson", header())
    with pytest.raises(FileExistsError):
        LessonWriter.create(tmp_path, "lesson", header())
    writer.close()


def test_a_finished_file_is_finished_even_if_its_new_name_cannot_be_made_safe(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = LessonWriter.create(tmp_path, "lesson", header())
    writer.append(PARTS[0])

    def fail(_folder: Path) -> None:
        raise OSError(errno.EIO, "Input/output error")

    monkeypatch.setattr("services.lesson.lesson_file.sync_folder", fail)
    with open_lesson(writer.finish()) as lesson:
        assert lesson.summary().parts == 1


def test_a_mark_that_a_stranger_nested_deeper_than_the_stack_is_damage() -> None:
    mark = b'{"of_tomorrow":' + b"[" * 20_000 + b"]" * 20_000 + b',"segment_ns":1,"sequence":0}'
    messages = [Message(MARK, BEGIN_NS, mark, BEGIN_NS, 0)]
    with pytest.raises(DamageError, match="message 0 holds what no lesson does"):
        PartDecoder().decode(OpenChunk(chunk_of(messages), tuple(messages)))


def test_a_header_holds_any_title(tmp_path: Path) -> None:
    title = 'ä "7b"\n\\ \x7f'
    writer = LessonWriter.create(tmp_path, "odd", header(title))
    with open_lesson(writer.finish()) as lesson:
        assert lesson.header.title == title


def test_metadata_of_others_are_no_header() -> None:
    with pytest.raises(lesson_header.HeaderError):
        lesson_header.LessonHeader.from_metadata(Metadata("x", {"format": "1"}).metadata)
