"""Troubles of what is taught: of KineBox's own files, and of a school's."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path

import pytest

import models.teaching
from services.doctor.finding import Examined
from services.support import teaching_files
from tests.integration.doctor_troubles.trouble import Stage, Trouble, broken, examined, flip_byte
from tests.integration.house import House, build_house, replace_text


def shipped_broken(name: str, break_it: Callable[[Path], None]) -> Stage:
    """KineBox's own files elsewhere, and one of them broken."""

    @contextmanager
    def stage(folder: Path) -> Iterator[Examined]:
        house = build_house(folder)
        shipped = _copied(folder / "shipped")
        break_it(shipped / name)
        with pytest.MonkeyPatch.context() as patched:
            patched.setattr(teaching_files, "_SHIPPED", shipped)
            yield examined(house)

    return stage


def own_broken(name: str, break_it: Callable[[Path], None]) -> Stage:
    """A school that has copied what KineBox teaches, and broken a file of it."""

    def school(house: House) -> None:
        break_it(_copied(house.data / "school") / name)

    return broken(school)


def _copied(folder: Path) -> Path:
    with resources.as_file(resources.files(models.teaching)) as shipped:
        for kind in (teaching_files.ACTIONS, teaching_files.STANDARDS):
            shutil.copytree(shipped / kind, folder / kind)
    return folder


def _cut_off(file: Path) -> None:
    file.write_bytes(file.read_bytes()[:-100])


def _as_another_action(file: Path) -> None:
    other = file.with_name("lunge.toml")
    other.write_text(file.read_text())
    replace_text(other, '"squat"', '"lunge"')


TAUGHT: dict[str, Trouble] = {
    "an action of KineBox's own is cut off": Trouble(
        shipped_broken("actions/squat.toml", _cut_off), "action squat", r"shipped/actions/squat\.toml", "put back the file"
    ),
    "a standard of KineBox's own has one wrong byte": Trouble(
        shipped_broken("standards/squat.npz", flip_byte), "standard squat", r"shipped/standards/squat\.npz", "put back the file"
    ),
    "an action of the school's own says what cannot be": Trouble(
        own_broken("actions/squat.toml", lambda file: replace_text(file, 'signal = "', 'signal = "no_')),
        "action squat",
        r"school/actions/squat\.toml: .*there is no signal 'no_",
        r"docs/measures\.md",
    ),
    "a standard of the school's own has one wrong byte": Trouble(
        own_broken("standards/squat.npz", flip_byte),
        "standard squat",
        r"school/standards/squat\.npz",
        "run `kinebox standard restore squat`",
    ),
    "an action of the school's own has no standard": Trouble(
        own_broken("actions/squat.toml", _as_another_action),
        "what is taught",
        "action 'lunge' has no standard",
        "add it, or remove the action",
    ),
}
