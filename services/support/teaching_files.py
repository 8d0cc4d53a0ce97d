"""Reads what is taught: the files that KineBox brings, and those of the school's own that count in their place."""

from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Final, TypeVar

import models.teaching
from models.config.site import SCHOOL_FOLDER
from models.errors import UserError
from models.regular_file import require_text
from models.teaching import standard
from models.teaching.schema import Teaching, Vocabulary, decode_teaching
from models.teaching.standard import Standard

ACTIONS: Final = "actions"
STANDARDS: Final = "standards"
TEACHING_SUFFIX: Final = ".toml"
STANDARD_SUFFIX: Final = ".npz"
_SHIPPED: Final = resources.files(models.teaching)

Content = TypeVar("Content")


def own_folder(data: Path, teaching: str) -> Path | None:
    """The school's own folder by the site file's `teaching`; None if that names none, and the usual one is not there.

    Raises:
        UserError: the one that it names does not exist, or is not in the data folder.
    """
    folder = folder_of_own(data, teaching)
    if folder.is_dir():
        return folder
    if not teaching:
        return None
    raise UserError(f"folder {folder} does not exist; make it, or correct 'teaching' under [evaluation] in the site file")


def folder_of_own(data: Path, teaching: str) -> Path:
    """The same, whether it is there or not; UserError if it is not in the data folder.

    A lesson brings the site file of another box along, and by what it names standards are written: never outside the data folder.
    (A link that somebody made in there may lead elsewhere.)
    """
    named = Path(teaching or SCHOOL_FOLDER)
    if named.is_absolute() or ".." in named.parts:
        raise UserError(
            f"folder '{teaching}' is not in the data folder {data}; correct 'teaching' under [evaluation] in the site file"
        )
    return data / named


def load_teachings(own: Path | None, vocabulary: Vocabulary | None) -> dict[str, Teaching]:
    """What is looked for and said, by the action's name.

    Args:
        own: the school's own folder; None for what KineBox brings.
        vocabulary: of what a measure may be made; None for whoever only shows the words.

    Raises:
        UserError: a file cannot be read, with its name.
    """
    return _load(own, ACTIONS, TEACHING_SUFFIX, lambda data, name: decode_teaching(data, name, vocabulary))


def load_standards(own: Path | None) -> dict[str, Standard]:
    """How each action is done well, by its name; UserError as for `load_teachings`, or if a file has another action's name."""
    found = _load(own, STANDARDS, STANDARD_SUFFIX, standard.decode)
    for name, one in found.items():
        if one.action != name:
            raise UserError(f"standard {name}{STANDARD_SUFFIX}: is of the action '{one.action}'; name the file after it")
    return found


def _load(own: Path | None, kind: str, suffix: str, read: Callable[[bytes, str], Content]) -> dict[str, Content]:
    """The shipped ones, and over them the school's own, in the order of their names."""
    files = {file.name: file for file in _SHIPPED.joinpath(kind).iterdir() if file.name.endswith(suffix)}
    if own is not None and (folder := own / kind).is_dir():
        files |= {file.name: file for file in folder.iterdir() if file.name.endswith(suffix)}
    contents = {}
    for name, file in sorted(files.items()):
        try:
            if isinstance(file, Path):
                require_text(file.stat())
            data = file.read_bytes()
        except OSError as error:
            raise UserError(f"{file} cannot be read: {error.strerror}; correct its permissions, or remove it") from error
        contents[name.removesuffix(suffix)] = read(data, name)
    return contents
