"""One recorder a folder: recovery takes every unfinished file there for one that nobody writes."""

import fcntl
from pathlib import Path
from typing import BinaryIO

from models.errors import UserError

_NAME = ".recorder"


def lock(folder: Path) -> BinaryIO:
    """Make the folder and keep every other recorder out of it for as long as the file is open.

    Raises:
        UserError: it cannot be made or written to, or another recorder is at work there.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        file = (folder / _NAME).open("wb")
    except OSError as error:
        raise UserError(f"folder of lessons {folder}: {error.strerror}; correct lessons.folder or its permissions") from error
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:
        file.close()
        raise UserError(f"another recorder works in {folder}; end that KineBox or change lessons.folder") from error
    return file


def is_locked(folder: Path) -> bool:
    """Whether what `lock` made is still there; False after the folder was moved away or emptied."""
    return (folder / _NAME).exists()
