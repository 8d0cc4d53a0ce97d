"""A school's data folder for tests of `kinebox standard`: lessons in it, files of other programs beside it, and what counts."""

from pathlib import Path
from typing import Final

import pytest

from models.errors import UserError
from models.motions.motion import Handed
from models.teaching.standard import Standard
from services.cli import new_standards
from services.cli.new_standards import Import, Record
from services.evaluation.attempt import FoundAttempt
from services.evaluation.track import Track
from services.lesson.export import bvh, c3d, trc
from services.lesson.export.take import Take
from services.support.teaching_files import load_standards
from tests.demonstrations import recorded, shown
from tests.installed import ROOT

SITE: Final = ROOT / "deploy/sites/simulated/site.toml"
WRITERS: Final = {"trc": trc.encode, "c3d": c3d.encode, "bvh": bvh.encode}


def lesson_of(
    data: Path, action: str = "badminton_clear", handed: Handed = "right", site_toml: str = ""
) -> tuple[Path, FoundAttempt]:
    """A lesson with one attempt, and the true attempt."""
    track, attempt = shown(action, handed)
    return recorded(data / "lessons", track, attempt, site_toml=site_toml or SITE.read_text()), attempt


def file_of(folder: Path, kind: str, track: Track, name: str = "coach") -> Path:
    """A motion as another program has it."""
    folder.mkdir(exist_ok=True)
    file = folder / f"{name}.{kind}"
    file.write_bytes(WRITERS[kind](Take(Track(track.t_s - track.t_s[0], track.joints_m, track.covariance_m2, track.states), name)))
    return file


def counting(data: Path, action: str = "badminton_clear") -> Standard:
    """As a box with this data folder reads it."""
    return load_standards(data / "school")[action]


def holds(folder: Path) -> dict[str, bytes | None]:
    """All files with what is in them, and all folders."""
    return {str(path.relative_to(folder)): path.read_bytes() if path.is_file() else None for path in sorted(folder.rglob("*"))}


def record_refused(data: Path, lesson: Path, order: Record, site: Path | None = None) -> str:
    """Why an attempt does not become the standard; nothing is changed then, and no folder made."""
    before = holds(data)
    with pytest.raises(UserError) as caught:
        new_standards.record(lesson, data, site, order)
    assert holds(data) == before, "something was written"
    assert "\n" not in str(caught.value)
    return str(caught.value)


def import_refused(data: Path, file: Path, order: Import) -> str:
    """The same of a file."""
    before = holds(data)
    with pytest.raises(UserError) as caught:
        new_standards.bring_in(file, data, None, order)
    assert holds(data) == before, "something was written"
    assert "\n" not in str(caught.value)
    return str(caught.value)
