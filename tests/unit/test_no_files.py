"""A pipe, a device or a file without measure that was named by mistake is one line, and nothing that waits or grows for ever."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from edge.simulation.command import find_plan
from edge.simulation.lesson.plan import read_plan
from models.errors import UserError
from models.regular_file import MOST_TEXT_BYTES
from services.lesson.imports.file import read_motion
from services.lesson.index import LessonIndex
from services.lesson.lesson_reader import open_lesson
from services.site_file.reading import read_file
from services.support.own_standards import OwnStandards
from services.support.teaching_files import load_standards, load_teachings
from tests.unit.test_own_standards import SQUAT, named

pytestmark = pytest.mark.timeout(20)

READERS: dict[str, tuple[str, Callable[[Path], object]]] = {
    "site file or calibration": ("site.toml", lambda folder: read_file(folder / "site.toml", "site file")),
    "plan": ("my.toml", lambda folder: find_plan(str(folder / "my.toml"))),
    "plan of a rendered lesson": ("plan.toml", lambda folder: read_plan(folder, "cam01")),
    "teaching": ("actions/squat.toml", lambda folder: load_teachings(folder, None)),
    "standard": ("standards/squat.npz", load_standards),
    "standard of the school": ("standards/squat.npz", lambda folder: OwnStandards(folder).own("squat")),
    "motion": ("squat.bvh", lambda folder: read_motion(folder / "squat.bvh")),
    "lesson": ("7b.mcap", lambda folder: open_lesson(folder / "7b.mcap")),
}
TEXTS = [name for name in READERS if name not in {"motion", "lesson"}]


def place(folder: Path, reader: str) -> tuple[Path, Callable[[Path], object]]:
    name, read = READERS[reader]
    file = folder / name
    file.parent.mkdir(exist_ok=True)
    return file, read


@pytest.mark.parametrize("reader", READERS)
def test_a_pipe_is_not_waited_for(tmp_path: Path, reader: str) -> None:
    file, read = place(tmp_path, reader)
    os.mkfifo(file)
    with pytest.raises(UserError, match=rf"{file.name} cannot be read.*it is a pipe or a device.*; correct "):
        read(tmp_path)


@pytest.mark.parametrize("reader", READERS)
def test_a_device_without_end_does_not_fill_the_memory(tmp_path: Path, reader: str) -> None:
    file, read = place(tmp_path, reader)
    file.symlink_to("/dev/zero")
    with pytest.raises(UserError, match=rf"{file.name} cannot be read.*it is a pipe or a device.*; correct "):
        read(tmp_path)


@pytest.mark.parametrize("reader", TEXTS)
def test_a_file_that_is_too_large_for_its_kind_is_not_read(tmp_path: Path, reader: str) -> None:
    file, read = place(tmp_path, reader)
    with file.open("wb") as film:
        film.truncate(MOST_TEXT_BYTES + 1_000_000)
    with pytest.raises(UserError, match=rf"{file.name} cannot be read.*it has 11 MB, and such a file at most 10.*; correct "):
        read(tmp_path)


CHANGES: dict[str, tuple[Callable[[OwnStandards], object], str]] = {
    "restore shipped": (lambda own: own.bring_back_shipped("squat"), SQUAT.origin),
    "restore 2": (lambda own: own.bring_back("squat", 2), "first"),
    "a new one": (lambda own: own.put(named("third")), "third"),
}


def school(folder: Path) -> OwnStandards:
    """A school whose own standard was replaced once: version 3 counts, and version 2 is kept."""
    own = OwnStandards(folder)
    own.put(named("first"))
    own.put(named("second"))
    return own


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize("kind", ["pipe", "device"])
def test_a_pipe_in_the_place_of_the_standard_that_counts_gives_way_to_another(tmp_path: Path, kind: str, change: str) -> None:
    own, (make, origin) = school(tmp_path), CHANGES[change]
    own.file("squat").unlink()
    if kind == "pipe":
        os.mkfifo(own.file("squat"))
    else:
        own.file("squat").symlink_to("/dev/zero")
    make(own)
    assert own.counts("squat").origin == origin
    assert [one.read().origin for one in own.kept("squat")] == ["first"]


@pytest.mark.parametrize("change", CHANGES)
def test_a_standard_that_is_too_large_to_be_kept_is_named_and_not_its_folder(tmp_path: Path, change: str) -> None:
    own, (make, _) = school(tmp_path), CHANGES[change]
    with own.file("squat").open("r+b") as film:
        film.truncate(MOST_TEXT_BYTES + 1_000_000)
    with pytest.raises(UserError, match=r"standards/squat\.npz cannot be read: it has 11 MB, .*; correct .*, or remove it$"):
        make(own)
    assert own.file("squat").stat().st_size > MOST_TEXT_BYTES
    assert [one.number for one in own.kept("squat")] == [2]


@pytest.mark.parametrize("change", CHANGES)
@pytest.mark.parametrize(("counting", "taken"), [("good", "squat-3.npz"), ("damaged", "squat-unreadable-1.npz")])
def test_a_pipe_where_the_standard_that_counts_would_be_kept_is_named(
    tmp_path: Path, counting: str, taken: str, change: str
) -> None:
    own, (make, _) = school(tmp_path), CHANGES[change]
    if counting == "damaged":
        own.file("squat").write_bytes(b"damaged")
    before = own.file("squat").read_bytes()
    os.mkfifo(own.folder / "versions" / taken)
    with pytest.raises(
        UserError, match=rf"versions/{taken} cannot be read: it is a pipe or a device, .*; correct .*, or remove it$"
    ):
        make(own)
    assert own.file("squat").read_bytes() == before


@pytest.mark.parametrize("name", ["7b.mcap", "7b.mcap.part"])
def test_a_pipe_among_the_lessons_does_not_hold_up_the_list(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    (row,) = LessonIndex(tmp_path).lessons()
    assert row.state == "damaged"
    assert "it is a pipe or a device" in row.problem
