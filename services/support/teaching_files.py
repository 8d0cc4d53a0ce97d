"""Reads what is taught: the files that KineBox brings, and those of the school's own that count in their place."""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path, PurePath
from typing import Final, Literal, NamedTuple, TypeVar

import models.teaching
from models.config.site import SCHOOL_FOLDER
from models.errors import UserError
from models.regular_file import require_text
from models.teaching.schema import Teaching, Vocabulary, decode_teaching
from models.teaching.showing import decode_own
from models.teaching.standard import Standard, decode

ACTIONS: Final = "actions"
STANDARDS: Final = "standards"
TEACHING_SUFFIX: Final = ".toml"
STANDARD_SUFFIX: Final = ".npz"
_SHIPPED: Final = resources.files(models.teaching)

Content = TypeVar("Content")


class TaughtFile(NamedTuple):
    """A file of what is taught, whether it counts or not.

    Attributes:
        kind: what it holds: what is looked for and said, or how it is done well.
        action: of which it is, by the file's name.
        own: whether it is the school's.
        path: where it is.
        read: reads it, and raises UserError, which names its path, if that cannot be done.
    """

    kind: Literal["action", "standard"]
    action: str
    own: bool
    path: str
    read: Callable[[], object]


def own_folder(data: Path, teaching: str) -> Path | None:
    """The school's own folder by the site file's `teaching`; None if that names none, and the usual one is not there.

    Raises:
        UserError: the one that it names does not exist, or is not in the data folder; or something else has its name.
    """
    folder = folder_of_own(data, teaching)
    if is_folder(folder):
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
    if is_outside(teaching):
        raise UserError(
            f"folder '{teaching}' is not in the data folder {data}; correct 'teaching' under [evaluation] in the site file"
        )
    return data / named


def is_outside(teaching: str) -> bool:
    """Whether what the site file names cannot be in any data folder."""
    named = Path(teaching)
    return named.is_absolute() or ".." in named.parts


def is_folder(place: Path) -> bool:
    """Whether a folder of the school's own is there; UserError if something else is, which somebody took for one."""
    try:
        place.lstat()
    except FileNotFoundError:
        return False
    except OSError as error:
        raise UserError(f"{place} cannot be looked at: {error.strerror}; correct its permissions") from error
    try:
        if place.is_dir():
            return True
        problem = "a link that leads nowhere" if place.is_symlink() else "a file"
    except OSError as error:
        problem = f"a link that cannot be followed ({error.strerror})"
    raise UserError(f"{place} is {problem}, and no folder; move it away")


def load_teachings(own: Path | None, vocabulary: Vocabulary | None) -> dict[str, Teaching]:
    """What is looked for and said, by the action's name.

    Args:
        own: the school's own folder; None for what KineBox brings.
        vocabulary: of what a measure may be made; None for whoever only shows the words.

    Raises:
        UserError: a file cannot be read, with its name.
    """
    files = _shipped_files(ACTIONS, TEACHING_SUFFIX) | _own_files(own, ACTIONS, TEACHING_SUFFIX)
    return _contents(files, lambda data, name: decode_teaching(data, name, vocabulary))


def load_words(data: Path, teaching: str) -> tuple[dict[str, Teaching], tuple[str, ...]]:
    """The same for whoever has more to do than to show words: in the place of what cannot be read, what KineBox brings counts.

    Args:
        data: the data folder.
        teaching: of the site file.

    Returns:
        What counts, by the action's name, and a line for people of each file, or folder, that cannot be read.
    """
    found, damaged = load_teachings(None, None), []
    try:
        files = _own_files(own_folder(data, teaching), ACTIONS, TEACHING_SUFFIX)
    except UserError as error:
        return found, (str(error),)
    for name, file in files.items():
        try:
            found[PurePath(name).stem] = decode_teaching(_read(file), name, None)
        except UserError as error:
            damaged.append(str(error))
    return dict(sorted(found.items())), tuple(damaged)


def load_standards(own: Path | None) -> dict[str, Standard]:
    """How each action is done well, by its name; UserError as for `load_teachings`, or if a file has another action's name."""
    found = _contents(_shipped_files(STANDARDS, STANDARD_SUFFIX), partial(_decode_standard, decode))
    found |= _contents(_own_files(own, STANDARDS, STANDARD_SUFFIX), partial(_decode_standard, decode_own))
    return dict(sorted(found.items()))


def taught_files(own: Path | None, vocabulary: Vocabulary) -> Iterator[TaughtFile]:
    """Every file that KineBox brings, also where one of the school's own counts in its place, and every one of those.

    Raises:
        UserError: a folder cannot be read.
    """
    teaching = partial(decode_teaching, vocabulary=vocabulary)
    yield from _taught("action", False, _shipped_files(ACTIONS, TEACHING_SUFFIX), teaching)
    yield from _taught("standard", False, _shipped_files(STANDARDS, STANDARD_SUFFIX), partial(_decode_standard, decode))
    yield from _taught("action", True, _own_files(own, ACTIONS, TEACHING_SUFFIX), teaching)
    yield from _taught("standard", True, _own_files(own, STANDARDS, STANDARD_SUFFIX), partial(_decode_standard, decode_own))


def _taught(
    kind: Literal["action", "standard"], own: bool, files: Mapping[str, Traversable], decoder: Callable[[bytes, str], object]
) -> Iterator[TaughtFile]:
    for name, file in sorted(files.items()):

        def read(file: Traversable = file) -> object:
            # Unlike elsewhere its errors name the path, for there may be two of a name.
            return decoder(_read(file), str(file))

        yield TaughtFile(kind, PurePath(name).stem, own, str(file), read)


def _contents(files: Mapping[str, Traversable], read: Callable[[bytes, str], Content]) -> dict[str, Content]:
    """Of files by their names, in the order of these; by what the names are without their endings."""
    return {PurePath(name).stem: read(_read(file), name) for name, file in sorted(files.items())}


def _shipped_files(kind: str, suffix: str) -> dict[str, Traversable]:
    """Those of a kind that KineBox brings, by their names."""
    return {file.name: file for file in _SHIPPED.joinpath(kind).iterdir() if file.name.endswith(suffix)}


def _own_files(own: Path | None, kind: str, suffix: str) -> dict[str, Traversable]:
    """The school's own of a kind, by their names."""
    if own is None or not is_folder(own / kind):
        return {}
    try:
        return {file.name: file for file in sorted((own / kind).iterdir()) if file.name.endswith(suffix)}
    except OSError as error:
        raise UserError(f"folder {own / kind} cannot be read: {error.strerror}; correct its permissions") from error


def _read(file: Traversable) -> bytes:
    try:
        if isinstance(file, Path):
            require_text(file.stat())
        return file.read_bytes()
    except OSError as error:
        raise UserError(f"{file} cannot be read: {error.strerror}; correct its permissions, or remove it") from error


def _decode_standard(decoder: Callable[[bytes, str], Standard], data: bytes, name: str) -> Standard:
    """As the decoder; UserError, too, if the file has another action's name."""
    one = decoder(data, name)
    if one.action != PurePath(name).stem:
        raise UserError(f"standard {name}: is of the action '{one.action}'; name the file after it")
    return one
