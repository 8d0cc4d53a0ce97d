"""Whether a folder can be used."""

import os
import stat
import tempfile
from pathlib import Path
from typing import NamedTuple

from services.support.no_room import is_no_room

KNOWN_BY = "writing a small file there"


class FolderProblem(NamedTuple):
    """Why nothing can be read from or written to a folder.

    Attributes:
        words: what is behind the folder's name in a sentence.
        full: its disk has no room, and nothing else is known to be wrong.
    """

    words: str
    full: bool = False


def try_folder(folder: Path) -> FolderProblem | None:
    """Why nothing can be read from or written to the folder; None if both can. Nothing is left there."""
    try:
        if not stat.S_ISDIR(folder.stat().st_mode):
            return FolderProblem("is no folder")
        list(folder.iterdir())
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"doctor" * 1000)
            file.flush()
            os.fsync(file.fileno())
    except FileNotFoundError:
        if folder.is_symlink():
            return FolderProblem(f"is a link to {folder.readlink()}, which does not exist")
        return FolderProblem("does not exist")
    except OSError as error:
        return FolderProblem(f"cannot be used: {error.strerror}", is_no_room(error))
    return None
