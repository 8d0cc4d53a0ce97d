"""Where a lesson is rendered: nobody's files are removed, nothing empty stays, and whoever is killed goes on.

The pictures are drawn here; `tests/integration/test_simulated_lesson.py` renders.
"""

from collections.abc import Callable, Iterable, Sequence
from contextlib import nullcontext
from pathlib import Path

import msgspec
import numpy as np
import pytest

from edge.footage.index import INDEX_NAME, Index
from edge.footage.transcode import encode_jpeg
from edge.simulation.lesson.cameras import rig_of
from edge.simulation.lesson.files import PLAN_NAME, TRUTH_NAME, film_path
from edge.simulation.lesson.plan import BumpPlan, LightPlan, Plan
from edge.simulation.lesson.presets import tiny
from edge.simulation.lesson.stage import Stage
from edge.simulation.picture.scene import Scene
from edge.simulation.picture.shutter import Shutter
from edge.simulation.rendering import render_lesson as rendering
from edge.simulation.rendering.pieces import JOB_NAME, Job, keep_pictures, keep_truth
from edge.simulation.truth.truth import LessonTruth
from models.errors import UserError
from tests.small_video import plain_picture

PLAN = tiny(2, 0.1)
SIZE_PX = (320, 180)


class Killed(BaseException):
    """The process ends, here and now."""


def draw(command: Sequence[str], pieces: Iterable[int], _processes: int, step_done: Callable[[], None]) -> None:
    folder = Path(command[-1])
    job = msgspec.json.decode((folder / JOB_NAME).read_bytes(), type=Job)
    for piece in pieces:
        for camera in job.cameras:
            keep_pictures(folder, camera, piece, [encode_jpeg(plain_picture(100, SIZE_PX)) for _ in job.numbers(piece)])
        keep_truth(
            folder, piece, LessonTruth(job.fingerprint, ("pupil",), np.zeros((1, 16)), np.zeros((1, 24, 3)), Shutter(), {}, {})
        )
        step_done()


@pytest.fixture(autouse=True)
def _drawn(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rendering, "graphics", lambda: None)
    monkeypatch.setattr(rendering, "do_pieces", draw)
    monkeypatch.setattr(rendering, "recipe", lambda: "drawn")
    monkeypatch.setattr(rendering, "set_stage", lambda _: Stage(Scene((), (), (), ()), rig_of(PLAN), 0.1, {"pupil": ()}))


def render(folder: Path, plan: Plan = PLAN) -> bool:
    return rendering.render_lesson(plan, folder, lambda *_: None)


def is_whole(folder: Path) -> bool:
    index = Index.read(folder)
    assert index is not None
    assert not index.damaged(folder)
    return {path.name for path in folder.iterdir()} == {INDEX_NAME, *index.files}


def refuse(folder: Path, said: str) -> None:
    before = {path: path.read_bytes() for path in folder.parent.rglob("*") if path.is_file()}
    with pytest.raises(UserError, match=said):
        render(folder)
    assert {path: path.read_bytes() for path in folder.parent.rglob("*") if path.is_file()} == before


def test_a_folder_in_which_somebody_keeps_his_plan_is_no_lesson_to_be_replaced(tmp_path: Path) -> None:
    own = tmp_path / "mine"
    own.mkdir()
    (own / PLAN_NAME).write_text("version = 1\n")
    (own / "diary.txt").write_text("dear diary")
    refuse(own, "mine is there already and is no rendered lesson")
    Index.of("footage", [own / "diary.txt"]).write(own)
    refuse(own, "mine is there already and is no rendered lesson")


@pytest.mark.parametrize("name", ["lesson", "lesson.part"])
def test_files_that_somebody_has_put_to_a_lesson_are_named_and_kept(name: str, tmp_path: Path) -> None:
    assert render(tmp_path / "lesson")
    film_path(tmp_path / "lesson", "cam01").write_bytes(b"damage")
    (tmp_path / name).mkdir(exist_ok=True)
    (tmp_path / name / "notes.txt").write_text("mine")
    refuse(tmp_path / "lesson", rf"{name}/notes\.txt would be lost")


def test_an_older_lesson_is_replaced_also_by_way_of_a_link(tmp_path: Path) -> None:
    assert render(tmp_path / "lesson")
    film_path(tmp_path / "lesson", "cam02").unlink()
    (tmp_path / "link").symlink_to("lesson")
    assert render(tmp_path / "link")
    assert is_whole(tmp_path / "lesson")
    assert (tmp_path / "link").is_symlink()
    assert not render(tmp_path / "link")


def test_the_folder_that_one_is_in_has_a_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    assert render(Path())
    assert is_whole(tmp_path / "here")
    assert [path.name for path in tmp_path.iterdir()] == ["here"]
    with pytest.raises(UserError, match="/ is there already"):
        render(Path("/"))


def test_a_machine_that_cannot_render_is_left_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing() -> None:
        raise UserError("rendering needs moderngl")

    monkeypatch.setattr(rendering, "graphics", missing)
    with pytest.raises(UserError, match="needs moderngl"):
        render(tmp_path / "lesson")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("key", "change"), [("bumps", BumpPlan(camera="cam01", at_s=0.1)), ("lights", LightPlan(at_s=60.0, for_s=1.0, level=0.0))]
)
def test_what_would_happen_after_the_lessons_end_is_refused_and_nothing_is_left(key: str, change: object, tmp_path: Path) -> None:
    plan = msgspec.structs.replace(PLAN, **{key: [change]})
    with pytest.raises(UserError, match=rf"lesson plan tiny: {key}\[0\]\.at_s is .*, but the lesson is over after 0\.10 s"):
        render(tmp_path / "lesson", plan)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("step", ["unlink", "rmdir", "rename"])
@pytest.mark.parametrize("older", [False, True])
def test_who_is_killed_when_all_is_rendered_need_not_render_again(
    step: str, older: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "lesson"
    if older:
        render(folder)
        film_path(folder, "cam01").unlink()

    def kill(*_: object, **__: object) -> None:
        raise Killed

    with monkeypatch.context() as patched:
        wrote = Index.write

        def write(index: Index, part: Path) -> None:
            wrote(index, part)
            patched.setattr(Path, step, kill)

        patched.setattr(Index, "write", write)
        patched.setattr(rendering, "_nothing_empty", lambda _: nullcontext())
        if step == "rmdir" and not older:
            patched.setattr(Path, "rename", kill)
        with pytest.raises(Killed):
            render(folder)
    monkeypatch.setattr(rendering, "do_pieces", kill)
    assert render(folder)
    assert is_whole(folder)
    assert [path.name for path in tmp_path.iterdir()] == ["lesson"]


@pytest.mark.parametrize("name", ["cam02.000000.pictures", "000000.truth"])
def test_pieces_that_a_power_cut_has_damaged_are_said_in_one_line(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def cut(command: Sequence[str], pieces: Iterable[int], processes: int, step_done: Callable[[], None]) -> None:
        draw(command, pieces, processes, step_done)
        (Path(command[-1]) / name).write_bytes(b"")

    monkeypatch.setattr(rendering, "do_pieces", cut)
    with pytest.raises(UserError, match=r"lesson\.part: what was rendered is damaged \(.*\); delete that folder"):
        render(tmp_path / "lesson")
    assert not (tmp_path / "lesson").exists()
    assert not (tmp_path / "lesson.part" / TRUTH_NAME).exists()
