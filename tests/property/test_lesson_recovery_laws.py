"""Laws of damaged lessons: whatever is cut off or changed, what was safe before comes back, and nothing false is ever read."""

import copy
import errno
import os
import threading
from collections.abc import Iterator
from functools import cache
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace
from typing import NamedTuple

import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.opcode import Opcode
from structlog.testing import capture_logs

from models.errors import UserError
from models.messages.lesson import FusionLog
from services.lesson import index, lesson_header
from services.lesson.contents import Contents
from services.lesson.folder_lock import lock
from services.lesson.layout import PART_SUFFIX, SUFFIX
from services.lesson.lesson_file import LessonWriter, mark_ended
from services.lesson.lesson_reader import LessonPart, open_lesson
from services.lesson.mcap_records import walk
from services.lesson.recovery import DAMAGED_SUFFIX, RETRY_S, Left, reopen
from services.lesson.survey import survey
from tests.synthetic.lesson import BEGIN_NS, SECOND_NS, header, part
from tests.synthetic.recovery import recover

PARTS = (*(part(BEGIN_NS, k) for k in range(3)), *(part(BEGIN_NS + 9 * SECOND_NS, k) for k in range(3)))


class Written(NamedTuple):
    """A finished lesson as bytes, and what it held after its beginning and after every part."""

    data: bytes
    stages: list[Contents]


@cache
def written() -> Written:
    with TemporaryDirectory() as folder:
        writer = LessonWriter.create(Path(folder), "lesson", header())
        stages = [copy.deepcopy(writer._contents)]
        for index, item in enumerate(PARTS):
            writer.append(item, "a part was lost" if index == 3 else "")
            stages.append(copy.deepcopy(writer._contents))
        return Written(writer.finish().read_bytes(), stages)


@pytest.fixture(scope="module")
def folder() -> Iterator[Path]:
    with TemporaryDirectory() as name:
        yield Path(name)


def as_logged(parts: list[LessonPart]) -> list[FusionLog]:
    return [FusionLog(item.segment_ns, item.sequence, item.entries) for item in parts]


@pytest.mark.slow
def test_whatever_a_crash_cuts_off_every_part_that_was_safe_is_found_again() -> None:
    data, stages = written()
    (ended,) = (place.end for place in walk(BytesIO(data)) if place.opcode == Opcode.DATA_END)
    for cut in range(stages[0].end, len(data)):
        safe = max((stage for stage in stages if stage.end <= cut), key=lambda stage: stage.end)
        assert survey(BytesIO(data[:cut])) == (safe, "", cut >= ended), f"cut at byte {cut}"


@settings(max_examples=60, deadline=None)
@given(cut=st.integers(0, len(written().data)))
def test_a_recovered_lesson_is_a_whole_file_and_can_be_gone_on_with(folder: Path, cut: int) -> None:
    data, stages = written()
    left = folder / f"lesson{PART_SUFFIX}"
    left.write_bytes(data[:cut])
    safe = sum(stage.end <= cut for stage in stages[1:])
    try:
        writer = reopen(left)
    except UserError:
        assert cut < stages[0].end
        return
    writer.append(part(BEGIN_NS + 99 * SECOND_NS, 0), "the recorder was started again")
    with open_lesson(writer.finish()) as lesson:
        parts = list(lesson.parts())
    assert as_logged(parts) == [*PARTS[:safe], part(BEGIN_NS + 99 * SECOND_NS, 0)]
    assert parts[-1].gap == "the recorder was started again"


@pytest.mark.slow
@settings(max_examples=300, deadline=None)
@given(at=st.integers(0, len(written().data) - 1), flip=st.integers(1, 255))
def test_a_changed_byte_is_noticed_or_does_not_matter(folder: Path, at: int, flip: int) -> None:
    data = bytearray(written().data)
    data[at] ^= flip
    path = folder / f"changed{SUFFIX}"
    path.write_bytes(data)
    read = []
    try:
        with open_lesson(path) as lesson:
            for item in lesson.parts():
                read.append(item)
                assert as_logged(read) == list(PARTS[: len(read)])
    except UserError:
        return
    assert len(read) == len(PARTS)
    assert at >= written().stages[-1].end, "a change of the data was not noticed"


@pytest.mark.slow
@settings(max_examples=150, deadline=None)
@given(at=st.integers(0, len(written().data) - 1), flip=st.integers(1, 255), cut=st.integers(0, 400))
def test_recovery_of_a_changed_file_keeps_all_before_the_change_and_the_changed_file(at: int, flip: int, cut: int) -> None:
    data, stages = bytearray(written().data), written().stages
    data[at] ^= flip
    left_bytes = bytes(data[: len(data) - cut])
    with TemporaryDirectory() as name:
        left = Path(name) / f"changed{PART_SUFFIX}"
        left.write_bytes(left_bytes)
        try:
            writer = reopen(left)
        except UserError:
            assert at < stages[0].end
            assert left.read_bytes() == left_bytes
            return
        with open_lesson(writer.finish()) as lesson:
            parts = as_logged(list(lesson.parts()))
        kept = [path.read_bytes() for path in Path(name).glob(f"*{DAMAGED_SUFFIX}")]
    assert parts == list(PARTS[: len(parts)])
    assert len(parts) >= sum(stage.end <= min(at, len(left_bytes)) for stage in stages[1:])
    if len(parts) < sum(stage.end <= len(left_bytes) for stage in stages[1:]):
        assert kept == [left_bytes], "parts were lost without a copy"


def test_at_the_start_every_lesson_that_was_left_is_finished_but_the_one_of_this_run(tmp_path: Path) -> None:
    data, stages = written()
    for name, run_ns in (("of-before", 1), ("of-this-run", 2)):
        writer = LessonWriter.create(tmp_path, name, header(run_ns=run_ns))
        writer.append(PARTS[0])
        writer.close()
    (tmp_path / f"cut{PART_SUFFIX}").write_bytes(data[: stages[2].end + 3])
    (tmp_path / f"no-lesson{PART_SUFFIX}").write_bytes(b"nothing")
    goes_on = recover(tmp_path, run_ns=2)
    assert goes_on is not None
    goes_on.close()
    assert sorted(path.name for path in tmp_path.iterdir() if not path.name.startswith(index.NAME)) == [
        f"cut{SUFFIX}",
        f"no-lesson{DAMAGED_SUFFIX}",
        f"of-before{SUFFIX}",
        f"of-this-run{PART_SUFFIX}",
    ]
    with open_lesson(tmp_path / f"cut{SUFFIX}") as lesson:
        assert as_logged(list(lesson.parts())) == list(PARTS[:2])


def test_the_lesson_that_goes_on_waits_for_no_other_to_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, run_ns in (("a-of-before", 1), ("b-of-this-run", 2), ("c-of-before", 1)):
        writer = LessonWriter.create(tmp_path, name, header(run_ns=run_ns))
        writer.append(PARTS[0])
        writer.close()
    read: list[Path] = []

    def watched(path: Path, stop: threading.Event | None = None) -> LessonWriter:
        read.append(path)
        return reopen(path, stop)

    monkeypatch.setattr("services.lesson.recovery.reopen", watched)
    goes_on = Left(tmp_path).cut_short(run_ns=2)
    assert goes_on is not None
    goes_on.close()
    assert [path.name for path in read] == [f"b-of-this-run{PART_SUFFIX}"]


def test_a_box_that_ends_waits_for_no_lesson_of_before_and_leaves_it_as_it_was(tmp_path: Path) -> None:
    data, stages = written()
    left = tmp_path / f"cut{PART_SUFFIX}"
    left.write_bytes(data[: stages[3].end + 3])
    ends = threading.Event()
    ends.set()
    Left(tmp_path).complete(ends)
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [(left.name, data[: stages[3].end + 3])]
    Left(tmp_path).complete(threading.Event())
    with open_lesson(tmp_path / f"cut{SUFFIX}") as lesson:
        assert as_logged(list(lesson.parts())) == list(PARTS[:3])


def no_space(*_: object) -> Path:
    raise OSError(errno.ENOSPC, "No space left on device")


def test_a_lesson_of_before_that_cannot_be_finished_is_tried_again_told_of_once_and_finished_when_it_can(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data, _ = written()
    for name in ("a", "b"):
        (tmp_path / f"{name}{PART_SUFFIX}").write_bytes(data[:-20])
    left = Left(tmp_path)
    assert left.trouble is None
    with monkeypatch.context() as full, capture_logs() as logged:
        full.setattr(LessonWriter, "finish", no_space)
        for _ in range(3):
            left.complete(threading.Event())
            assert left.trouble is not None
            assert left.trouble.words == "lesson a and 1 more are not finished yet: No space left on device; they need 1 MB of room"
    assert [line["log_level"] for line in logged] == ["warning"] * 2
    left.complete(threading.Event())
    assert left.trouble is None
    for name in ("a", "b"):
        with open_lesson(tmp_path / f"{name}{SUFFIX}") as lesson:
            assert as_logged(list(lesson.parts())) == list(PARTS)


def test_a_lesson_whose_begun_summary_cannot_be_cut_off_is_tried_again_and_not_taken_for_removed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data, _ = written()
    (tmp_path / f"a{PART_SUFFIX}").write_bytes(data[:-20])
    left = Left(tmp_path)
    with monkeypatch.context() as ill:
        ill.setattr("services.lesson.recovery.survey", lambda *of: (SimpleNamespace(chunks=[1], end=-1), *survey(*of)[1:]))
        for _ in range(3):
            left.complete(threading.Event())
            assert left.trouble is not None
    left.complete(threading.Event())
    assert left.trouble is None
    with open_lesson(tmp_path / f"a{SUFFIX}") as lesson:
        assert as_logged(list(lesson.parts())) == list(PARTS)


@pytest.mark.parametrize("fails", ["lesson_file.os.fsync", "lesson_file.Path.replace"], ids=["its first bytes", "its name"])
def test_the_title_of_a_lesson_without_a_part_outlives_a_disk_on_which_it_cannot_be_begun_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fails: str
) -> None:
    writer = LessonWriter.create(tmp_path, "a", header("Cartwheel, class 7b"))
    writer.finish()
    data = (tmp_path / f"a{SUFFIX}").read_bytes()
    (tmp_path / f"a{SUFFIX}").unlink()
    (tmp_path / f"a.ended{PART_SUFFIX}").write_bytes(data[:-20])
    left = Left(tmp_path)
    with monkeypatch.context() as full:
        full.setattr(f"services.lesson.{fails}", no_space)
        for _ in range(2):
            left.complete(threading.Event())
            assert left.trouble is not None
    (there,) = tmp_path.iterdir()
    assert there.read_bytes() == data[:-20]
    left.complete(threading.Event())
    assert left.trouble is None
    with open_lesson(tmp_path / f"a{SUFFIX}") as lesson:
        assert lesson.header.title == "Cartwheel, class 7b"
    assert [path.name for path in tmp_path.iterdir() if path.name.startswith(".")] == []


def test_a_lesson_that_waits_is_tried_again_until_the_box_ends(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data, _ = written()
    (tmp_path / f"a{PART_SUFFIX}").write_bytes(data[:-20])
    ends, tried = threading.Event(), 0
    finish = LessonWriter.finish

    def third_time(writer: LessonWriter) -> Path:
        nonlocal tried
        tried += 1
        if tried < 3:
            no_space()
        ends.set()
        return finish(writer)

    monkeypatch.setattr("services.lesson.recovery.RETRY_S", 0.01)
    monkeypatch.setattr(LessonWriter, "finish", third_time)
    Left(tmp_path).keep_completing(ends)
    assert tried == 3
    with open_lesson(tmp_path / f"a{SUFFIX}") as lesson:
        assert as_logged(list(lesson.parts())) == list(PARTS)


def test_a_long_lesson_that_can_never_be_finished_is_read_again_the_less_often_the_longer_that_takes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    rests: list[float | None] = []

    class Ends(threading.Event):
        def wait(self, timeout: float | None = None) -> bool:
            rests.append(timeout)
            if len(rests) == 2:
                self.set()
            return self.is_set()

    took = iter((0.1, 100.0))
    left = Left(tmp_path)
    monkeypatch.setattr(left, "complete", lambda _: next(took))
    left.keep_completing(Ends())
    assert rests == [RETRY_S, 2000.0]


@pytest.mark.parametrize("taken", ["file", "disk"])
def test_a_lesson_that_waits_is_forgotten_if_it_was_removed_and_waits_for_its_disk_if_that_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, taken: str
) -> None:
    folder = tmp_path / "lessons"
    lock(folder).close()
    data, _ = written()
    path = folder / f"a.ended{PART_SUFFIX}"
    path.write_bytes(data[:-20])
    left = Left(folder)
    with monkeypatch.context() as full:
        full.setattr(LessonWriter, "finish", no_space)
        left.complete(threading.Event())
    if taken == "file":
        path.unlink()
        left.complete(threading.Event())
        assert left.trouble is None
        return
    away = folder.rename(tmp_path / "away")
    left.complete(threading.Event())
    assert left.trouble is not None
    away.rename(folder)
    left.complete(threading.Event())
    assert left.trouble is None
    assert (folder / f"a{SUFFIX}").is_file()


def test_no_copy_of_a_damaged_file_is_begun_for_which_there_is_no_room(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data, stages = written()
    changed = bytearray(data[: stages[-1].end])
    changed[stages[2].end + 100] ^= 1
    (tmp_path / f"changed{PART_SUFFIX}").write_bytes(changed)
    left = Left(tmp_path)
    with monkeypatch.context() as full:
        full.setattr("services.lesson.recovery.shutil.disk_usage", lambda _: SimpleNamespace(free=len(changed) - 1))
        full.setattr("services.lesson.recovery.shutil.copyfile", die)
        left.complete(threading.Event())
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [changed]
    assert left.trouble is not None
    left.complete(threading.Event())
    assert left.trouble is None
    assert (tmp_path / f"changed{DAMAGED_SUFFIX}").read_bytes() == changed


def test_a_file_whose_summary_was_begun_was_ended_and_stays_so_until_it_is_finished(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data, _ = written()
    (tmp_path / f"a{PART_SUFFIX}").write_bytes(data[:-20])

    with monkeypatch.context() as full:
        full.setattr(LessonWriter, "finish", no_space)
        assert recover(tmp_path, header().run_ns) is None
    assert recover(tmp_path, header().run_ns) is None, "the summary was cut off, and with it the sign of its end"
    with open_lesson(tmp_path / f"a{SUFFIX}") as lesson:
        assert as_logged(list(lesson.parts())) == list(PARTS)


LENGTH_AT = 3
"""Changed there, a record's length says that it goes on beyond the end of the file."""
DATA_LENGTH_AT = 52
"""The highest byte of the length of a chunk's data."""


@pytest.mark.parametrize(
    ("safe", "offset"),
    [(2, 100), (0, 100), (0, LENGTH_AT), (5, LENGTH_AT), (2, DATA_LENGTH_AT)],
    ids=["middle", "first", "first length", "last length", "length of the data"],
)
def test_of_a_file_that_is_damaged_the_whole_is_kept(tmp_path: Path, safe: int, offset: int) -> None:
    data, stages = written()
    require_kept(tmp_path, data, stages, stages[safe].end + offset, safe)


@pytest.mark.parametrize("offset", [0, LENGTH_AT], ids=["kind", "length"])
def test_of_a_file_that_is_damaged_before_its_first_chunk_the_whole_is_kept(tmp_path: Path, offset: int) -> None:
    data, stages = written()
    channel = next(place.start for place in walk(BytesIO(data)) if place.end == stages[0].end)
    require_kept(tmp_path, data, stages, channel + offset, 0)


def require_kept(folder: Path, data: bytes, stages: list[Contents], at: int, safe: int) -> None:
    """Change a byte; the changed file must be kept, and so many parts come back."""
    changed = bytearray(data[: stages[-1].end])
    changed[at] ^= 0xC0
    (folder / f"changed{PART_SUFFIX}").write_bytes(changed)
    assert recover(folder, run_ns=0) is None
    (kept,) = folder.glob(f"*{DAMAGED_SUFFIX}")
    assert kept.read_bytes() == changed
    with open_lesson(folder / f"changed{SUFFIX}") as lesson:
        assert as_logged(list(lesson.parts())) == list(PARTS[:safe])


def test_a_damaged_file_of_which_no_copy_can_be_made_is_left_as_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data, stages = written()
    changed = bytearray(data[: stages[-1].end])
    changed[stages[2].end + 100] ^= 1
    left = tmp_path / f"changed{PART_SUFFIX}"
    left.write_bytes(changed)

    def half(source: Path, target: Path) -> None:
        target.write_bytes(source.read_bytes()[:100])
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as full:
        full.setattr("services.lesson.recovery.shutil.copyfile", half)
        assert recover(tmp_path, run_ns=0) is None
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [changed]
    recover(tmp_path, run_ns=0)
    assert (tmp_path / f"changed{DAMAGED_SUFFIX}").read_bytes() == changed


def test_of_a_lesson_that_was_only_cut_off_no_copy_is_made(tmp_path: Path) -> None:
    data, stages = written()
    (tmp_path / f"cut{PART_SUFFIX}").write_bytes(data[: stages[3].end - 7])
    (tmp_path / f"begun{PART_SUFFIX}").write_bytes(data[: stages[1].end - 7])
    recover(tmp_path, run_ns=0)
    assert sorted(path.name for path in tmp_path.iterdir() if not path.name.startswith(index.NAME)) == [
        f"begun{SUFFIX}",
        f"cut{SUFFIX}",
    ]


def test_nothing_that_was_there_before_is_overwritten_by_what_is_recovered(tmp_path: Path) -> None:
    data, stages = written()
    changed = bytearray(data[: stages[-1].end])
    changed[stages[2].end + 100] ^= 1
    before = {f"a{SUFFIX}": b"copied", f"a{DAMAGED_SUFFIX}": b"of before", f"b{DAMAGED_SUFFIX}": b"too"}
    for name, content in before.items():
        (tmp_path / name).write_bytes(content)
    (tmp_path / f"a{PART_SUFFIX}").write_bytes(changed)
    (tmp_path / f"b{PART_SUFFIX}").write_bytes(b"nothing")
    recover(tmp_path, run_ns=0)
    assert {name: (tmp_path / name).read_bytes() for name in before} == before
    assert (tmp_path / f"a-2{DAMAGED_SUFFIX}").read_bytes() == changed
    assert (tmp_path / f"b-2{DAMAGED_SUFFIX}").read_bytes() == b"nothing"
    with open_lesson(tmp_path / f"a-2{SUFFIX}") as lesson:
        assert as_logged(list(lesson.parts())) == list(PARTS[:2])
    assert not list(tmp_path.glob(f"*{PART_SUFFIX}"))


def die(*_: object) -> None:
    raise KeyboardInterrupt


@pytest.mark.parametrize("renamed_before", [0, 1], ids=["while it is marked as ended", "while it is finished"])
def test_a_crash_between_a_free_name_and_its_file_leaves_one_lesson_with_that_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, renamed_before: int
) -> None:
    writer = LessonWriter.create(tmp_path, "lesson", header())
    writer.append(PARTS[0])
    if renamed_before:
        writer.path = mark_ended(writer.path)
    with monkeypatch.context() as killed:
        killed.setattr(Path, "replace", die)
        with pytest.raises(KeyboardInterrupt):
            writer.finish()
    writer.close()
    assert [path.stat().st_size for path in tmp_path.iterdir()].count(0) == 1
    with capture_logs() as logged:
        assert recover(tmp_path, run_ns=0) is None
    assert [path.name for path in tmp_path.iterdir() if not path.name.startswith(index.NAME)] == [f"lesson{SUFFIX}"]
    with open_lesson(tmp_path / f"lesson{SUFFIX}") as lesson:
        assert as_logged(list(lesson.parts())) == [PARTS[0]]
    assert {line["log_level"] for line in logged} == {"info"}


def test_of_a_lesson_that_died_before_its_first_byte_nothing_is_left_and_nobody_is_warned(tmp_path: Path) -> None:
    (tmp_path / f"lesson{PART_SUFFIX}").touch()
    with capture_logs() as logged:
        assert recover(tmp_path, run_ns=0) is None
    assert list(tmp_path.iterdir()) == []
    assert [line["log_level"] for line in logged] == ["info"]


def test_an_unfinished_lesson_of_a_newer_kinebox_waits_for_the_update(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lesson_header, "FORMAT", lesson_header.FORMAT + 1)
    writer = LessonWriter.create(tmp_path, "newer", header())
    writer.append(PARTS[0])
    writer.close()
    left = writer.path.read_bytes()
    monkeypatch.undo()
    assert recover(tmp_path, run_ns=0) is None
    assert [path.read_bytes() for path in tmp_path.glob("newer*")] == [left]
    assert writer.path.exists()
    monkeypatch.setattr(lesson_header, "FORMAT", lesson_header.FORMAT + 1)
    assert recover(tmp_path, run_ns=0) is None
    with open_lesson(tmp_path / f"newer{SUFFIX}") as lesson:
        assert as_logged(list(lesson.parts())) == [PARTS[0]]


def test_an_unfinished_lesson_whose_name_is_no_text_stays_and_stops_nobody(tmp_path: Path) -> None:
    for name in ("a", "b"):
        writer = LessonWriter.create(tmp_path, name, header())
        writer.append(part(BEGIN_NS, 0))
        writer.close()
    odd = (tmp_path / f"a{PART_SUFFIX}").rename(tmp_path / f"{os.fsdecode(bytes([0xFE]))}{PART_SUFFIX}")
    content = odd.read_bytes()
    with capture_logs() as logged:
        assert recover(tmp_path, run_ns=0) is None
    assert (tmp_path / "b.mcap").is_file()
    assert odd.read_bytes() == content
    (told,) = [line for line in logged if line["log_level"] == "warning"]
    assert (told["lesson"], told["remedy"]) == (rf"\xfe{PART_SUFFIX}", "rename the file")
    odd.rename(tmp_path / f"a{PART_SUFFIX}")
    assert recover(tmp_path, run_ns=0) is None
    assert (tmp_path / "a.mcap").is_file()


def test_a_pipe_with_the_name_of_an_unfinished_lesson_stays_and_stops_nobody(tmp_path: Path) -> None:
    pipe, folder = tmp_path / f"a{PART_SUFFIX}", tmp_path / f"b{PART_SUFFIX}"
    os.mkfifo(pipe)
    folder.mkdir()
    writer = LessonWriter.create(tmp_path, "c", header())
    writer.append(part(BEGIN_NS, 0))
    writer.close()
    with capture_logs() as logged:
        assert recover(tmp_path, run_ns=0) is None
    assert (tmp_path / "c.mcap").is_file()
    assert pipe.is_fifo()
    assert folder.is_dir()
    assert [line["lesson"] for line in logged if line.get("remedy") == "remove it"] == [pipe.name, folder.name]


def test_recovery_unpacks_every_chunk_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    data, stages = written()
    (tmp_path / f"cut{PART_SUFFIX}").write_bytes(data[: stages[-1].end])
    unpacked = 0
    decompressor = zstandard.ZstdDecompressor

    def counting() -> zstandard.ZstdDecompressor:
        nonlocal unpacked
        unpacked += 1
        return decompressor()

    monkeypatch.setattr(zstandard, "ZstdDecompressor", counting)
    recover(tmp_path, run_ns=0)
    assert unpacked == len(PARTS)
