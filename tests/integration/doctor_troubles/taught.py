"""Troubles of what is taught: of KineBox's own files, and of a school's."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

import models.teaching
from models.teaching.standard import LAYOUT
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


def _as_a_copy(file: Path) -> None:
    shutil.copy(file, file.with_name("squat-old.npz"))


def _as_of_a_newer_kinebox(file: Path) -> None:
    with np.load(file) as archive:
        arrays = dict(archive)
    np.savez_compressed(file, allow_pickle=False, **(arrays | {"layout": np.array(LAYOUT + 1)}))


def _as_one_of_a_kind(file: Path) -> None:
    _as_another_action(file.parents[1] / "actions" / "squat.toml")
    file.with_name("lunge.npz").write_bytes(b"damaged")


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
        r"run `kinebox standard restore squat --data \S+/data --site \S+/site\.toml`: the one before counts again",
    ),
    "a standard of the school's own is damaged, and there is none before it": Trouble(
        own_broken("standards/squat.npz", _as_one_of_a_kind),
        "standard lunge",
        r"school/standards/lunge\.npz: is no standard's file, or is damaged",
        "export or record it again",
    ),
    "a standard of the school's own has another name than its action": Trouble(
        own_broken("standards/squat.npz", _as_a_copy),
        "standard squat-old",
        r"school/standards/squat-old\.npz: is of the action 'squat'",
        "name the file after it",
    ),
    "a standard of the school's own is of a newer KineBox": Trouble(
        own_broken("standards/squat.npz", _as_of_a_newer_kinebox),
        "standard squat",
        r"school/standards/squat\.npz: its layout is 2, this KineBox reads 1",
        "update KineBox",
    ),
    "an action of the school's own has no standard": Trouble(
        own_broken("actions/squat.toml", _as_another_action),
        "what is taught",
        "action 'lunge' has no standard",
        "add it, or remove the action",
    ),
}
