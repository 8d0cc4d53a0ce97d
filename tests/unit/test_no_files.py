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


@pytest.mark.parametrize("name", ["7b.mcap", "7b.mcap.part"])
def test_a_pipe_among_the_lessons_does_not_hold_up_the_list(tmp_path: Path, name: str) -> None:
    os.mkfifo(tmp_path / name)
    (row,) = LessonIndex(tmp_path).lessons()
    assert row.state == "damaged"
    assert "it is a pipe or a device" in row.problem
