"""Names that no file of the folder of lessons has yet, so that nothing is ever overwritten."""

from collections.abc import Iterator
from itertools import count
from pathlib import Path


def numbered(name: str) -> Iterator[str]:
    """The name itself, then with "-2", "-3" and so on behind it."""
    yield name
    yield from (f"{name}-{number}" for number in count(2))


def reserve(folder: Path, name: str, suffix: str) -> Path:
    """An empty file with the first of the numbered names that is free, to be replaced by what shall be called that.

    It is made first and then replaced, since a rename overwrites silently what another has put there meanwhile. (A second link to
    the file would do the same, but a memory stick's file system knows none.) A name whose file is empty is free: a crash came
    between the two.

    Raises:
        OSError: nothing can be written there.
    """
    for free in numbered(name):
        path = folder / f"{free}{suffix}"
        try:
            path.open("xb").close()
        except FileExistsError:
            if not _is_empty(path):
                continue
        return path
    raise AssertionError("the numbers are endless")


def rename_free(path: Path, name: str, suffix: str) -> Path:
    """Give a file the first of the numbered names that is free; its new path.

    Raises:
        OSError: it cannot be renamed, and has its old name still.
    """
    target = reserve(path.parent, name, suffix)
    try:
        return path.replace(target)
    except OSError:
        target.unlink(missing_ok=True)
        raise


def _is_empty(path: Path) -> bool:
    return path.is_file() and path.lstat().st_size == 0
