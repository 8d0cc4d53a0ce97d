"""Files that are there as a whole or not at all."""

import os
from pathlib import Path


def write_new(path: Path, data: bytes) -> None:
    """Write a file under another name, sync it, and give it its own name only then.

    Raises:
        FileExistsError: there is one of that name, which is left as it is.
        OSError: it cannot be written; nothing is left of it.
    """
    if path.exists():
        raise FileExistsError(path)
    write_over(path, data)


def write_over(path: Path, data: bytes) -> None:
    """The same, in the place of the file of that name if there is one.

    Raises:
        OSError: it cannot be written; what was there is left as it was.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        with part.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise
