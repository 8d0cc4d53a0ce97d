"""Keeps a school's own standards on the disk: those that count, and every one that counted before.

    standards/<action>.npz                counts in the place of what KineBox brings
    standards/versions/<action>-<n>.npz   counted before, as version n

Only files directly in `standards` count. Before one of them is replaced or removed it is copied to `versions`, where nothing is
ever overwritten or removed; so at every instant, also of a power cut, each version is in one of both places as a whole. Version
numbers only grow, over those that KineBox brings, too; only a file that was copied there by hand may have the number of another.
"""

import errno
import fcntl
import os
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from models.errors import UserError
from models.regular_file import require_text
from models.teaching.showing import decode_own
from models.teaching.standard import LAST_VERSION, Standard, encode
from services.support.new_file import write_new, write_over
from services.support.sync import sync_folder
from services.support.teaching_files import STANDARD_SUFFIX, STANDARDS, is_folder, load_standards

VERSIONS: Final = "versions"
PATIENCE_S: Final = 5.0
"""Whoever else is at work in the folder is waited for so long; to keep a standard takes a moment."""
_NAME: Final = re.compile(r"(?P<action>[a-z][a-z0-9_]*)-(?P<number>[1-9]\d*)")
_AGAIN_S: Final = 0.02
_UNREADABLE: Final = "unreadable"


@dataclass(frozen=True, eq=False)
class Kept:
    """A standard that counted before.

    Attributes:
        number: its version.
        file: where it is.
    """

    number: int
    file: Path

    def read(self) -> Standard:
        """What it holds; UserError if it cannot be read."""
        return decode_own(_read(self.file), str(self.file))


@dataclass(frozen=True, eq=False)
class Placed:
    """A standard that counts from now on.

    Attributes:
        standard: with the version that it got.
        before: the version under which the own one that counted before is kept; None if there was none, or it cannot be read.
    """

    standard: Standard
    before: int | None


@dataclass(frozen=True)
class _Copy:
    """What counted, in the versions.

    Attributes:
        number: its version there; None if it cannot be read, or nothing counted.
        made: the file that had to be written for it; None if it was there already.
    """

    number: int | None = None
    made: Path | None = None


class OwnStandards:
    """The standards in a school's own folder, which need not be there before something is put into it."""

    def __init__(self, own: Path) -> None:
        self.folder = own / STANDARDS
        self._versions = self.folder / VERSIONS
        self._shipped = load_standards(None)

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of all actions that there is a standard of, shipped or own, in their order."""
        own = {file.stem for file in _files(self.folder) if file.suffix == STANDARD_SUFFIX}
        kept = {name["action"] for _, name in self._all_kept()}
        return tuple(sorted(own | kept | self._shipped.keys()))

    def file(self, action: str) -> Path:
        """Where the own standard of an action is that counts, if there is one."""
        return self.folder / f"{action}{STANDARD_SUFFIX}"

    def shipped(self, action: str) -> Standard | None:
        """What KineBox brings."""
        return self._shipped.get(action)

    def own(self, action: str) -> Standard | None:
        """The own standard that counts; None if there is none; UserError if it cannot be read."""
        file = self.file(action)
        return _standard(_read(file), file) if file.exists() else None

    def require(self, action: str) -> None:
        """Raise UserError, which names all that there are, if nobody has a standard of an action."""
        if action not in self.actions:
            raise UserError(f"there is no action '{action}'; there are: {', '.join(self.actions)}")

    def counts(self, action: str) -> Standard:
        """The standard that counts; UserError if there is none, or it cannot be read."""
        self.require(action)
        standard = self.own(action) or self.shipped(action)
        if standard is None:
            raise UserError(f"no standard of '{action}' counts; 'kinebox standard restore {action}' brings back the newest one")
        return standard

    def kept(self, action: str) -> tuple[Kept, ...]:
        """Those that counted before, the oldest first."""
        found = (Kept(int(name["number"]), file) for file, name in self._all_kept() if name["action"] == action)
        return tuple(sorted(found, key=lambda one: one.number))

    def is_counting(self, action: str, kept: Kept) -> bool:
        """Whether one that counted before counts again: whether it is the same, whatever its number; not if it cannot be read."""
        try:
            return _read(self.file(action)) == _read(kept.file)
        except UserError:
            return False

    def _all_kept(self) -> Iterator[tuple[Path, "re.Match[str]"]]:
        for file in _files(self._versions):
            if file.suffix == STANDARD_SUFFIX and (name := _NAME.fullmatch(file.stem)) is not None:
                yield file, name

    def put(self, standard: Standard) -> Placed:
        """Make a standard the one that counts for its action; the one before is kept.

        Raises:
            UserError: it cannot be written; all is as it was.
        """
        with self._at_work():
            return self._put(standard)

    def bring_back(self, action: str, version: int) -> None:
        """Make a version that is kept count again, as it was; UserError if there is none, or it cannot be read or written."""
        with self._at_work():
            chosen = next((one for one in self.kept(action) if one.number == version), None)
            if chosen is None:
                raise UserError(f"version {version} of '{action}' is not kept any more; 'kinebox standard list' shows what is")
            if chosen.read().action != action:
                raise UserError(f"standard {chosen.file} is of another action; move it away, and name another version")
            with self._kept_before(action):
                write_over(self.file(action), _read(chosen.file))
            sync_folder(self.folder)

    def bring_back_shipped(self, action: str) -> None:
        """Let what KineBox brings count again; UserError if the own one cannot be kept or removed."""
        with self._at_work():
            with self._kept_before(action):
                self.file(action).unlink(missing_ok=True)
            sync_folder(self.folder)

    def _put(self, standard: Standard) -> Placed:
        with self._kept_before(standard.action) as before:
            numbered = replace(standard, version=self._next(standard.action))
            data = encode(numbered)
            decode_own(data, self.file(standard.action).name)
            write_over(self.file(standard.action), data)
        sync_folder(self.folder)
        return Placed(numbered, before)

    def _next(self, action: str) -> int:
        numbers = [one.number for one in self.kept(action)]
        if (shipped := self.shipped(action)) is not None:
            numbers.append(shipped.version)
        with suppress(UserError):
            numbers += [] if (own := self.own(action)) is None else [own.version]
        last = max(numbers, default=0)
        if last >= LAST_VERSION:
            raise UserError(f"a standard of '{action}' has the last number that there is, {last}; move its file away")
        return last + 1

    @contextmanager
    def _kept_before(self, action: str) -> Iterator[int | None]:
        """Keep what counts, as the version that is given; if what is done then does not succeed, all is as it was."""
        copy = self._keep(action)
        try:
            yield copy.number
        except (OSError, UserError):
            if copy.made is not None:
                self._forget(copy.made)
            raise

    def _keep(self, action: str) -> _Copy:
        """Copy what counts to the versions, unless it is there already."""
        file = self.file(action)
        if not file.exists() or _holds_nothing(file):
            return _Copy()
        data, number = _read(file), None
        try:
            standard = _standard(data, file)
        except UserError:
            copy = self._free(data, f"{action}-{_UNREADABLE}")
        else:
            copy = self._version(action, standard.version)
            if copy.exists() and _read(copy) != data:
                # A file that somebody brought has the number of another one.
                standard = replace(standard, version=self._next(action))
                copy, data = self._version(action, standard.version), encode(standard)
            number = standard.version
        if copy is None or copy.exists():
            return _Copy(number)
        try:
            self._versions.mkdir(exist_ok=True)
            write_new(copy, data)
            for folder in (self._versions, self.folder):
                sync_folder(folder)
        except OSError:
            self._forget(copy)
            raise
        return _Copy(number, copy)

    def _forget(self, copy: Path) -> None:
        copy.unlink(missing_ok=True)
        with suppress(OSError):
            self._versions.rmdir()  # it holds no other

    def _version(self, action: str, number: int) -> Path:
        return self._versions / f"{action}-{number}{STANDARD_SUFFIX}"

    def _free(self, data: bytes, name: str) -> Path | None:
        """A name that no file has; None if one has this content."""
        number = 1
        while (file := self._versions / f"{name}-{number}{STANDARD_SUFFIX}").exists():
            if _read(file) == data:
                return None
            number += 1
        return file

    @contextmanager
    def _at_work(self) -> Iterator[None]:
        """Alone in the folder, which is made; UserError if something there cannot be read or written."""
        try:
            with _made(self.folder), _alone(self.folder):
                yield
        except OSError as error:
            remedy = "make room there" if error.errno in {errno.ENOSPC, errno.EDQUOT} else "correct its permissions"
            raise UserError(f"{error.filename or self.folder} cannot be written: {error.strerror}; {remedy}") from error


@contextmanager
def _made(folder: Path) -> Iterator[None]:
    """Make a folder; if what is done then does not succeed, those that were made for it are gone again."""
    missing = [each for each in (folder, *folder.parents) if not each.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        for each in missing:
            sync_folder(each.parent)
        yield
    except BaseException:
        for each in missing:
            with suppress(OSError):
                each.rmdir()
        raise


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Whoever else is at work in a folder is waited for, but not for ever: UserError."""
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        _lock(descriptor, folder)
        yield
    finally:
        os.close(descriptor)


def _lock(descriptor: int, folder: Path) -> None:
    until_s = time.monotonic() + PATIENCE_S
    while True:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            if time.monotonic() > until_s:
                raise UserError(
                    f"another 'kinebox standard' has been at work in {folder} for {PATIENCE_S:.0f} s; end it, and try again"
                ) from error
            time.sleep(_AGAIN_S)
        else:
            return


def _files(folder: Path) -> list[Path]:
    try:
        return sorted(folder.iterdir()) if is_folder(folder) else []
    except OSError as error:
        raise UserError(f"{folder} cannot be read: {error.strerror}; correct its permissions") from error


def _holds_nothing(file: Path) -> bool:
    """Whether it is a pipe or a device, of which nothing can be kept."""
    return not file.is_file() and not file.is_dir()


def _read(file: Path) -> bytes:
    try:
        require_text(file.stat())
        return file.read_bytes()
    except OSError as error:
        raise UserError(f"{file} cannot be read: {error.strerror}; correct its permissions, or remove it") from error


def _standard(data: bytes, file: Path) -> Standard:
    """What a file holds that has an action's name; UserError if that is none, or another action's."""
    standard = decode_own(data, str(file))
    if standard.action != file.stem:
        raise UserError(f"standard {file} is of the action '{standard.action}'; name the file after it")
    return standard
