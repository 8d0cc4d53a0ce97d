"""Whether a folder can be used."""

import os
import stat
import tempfile
from pathlib import Path

KNOWN_BY = "writing a small file there"


def try_folder(folder: Path) -> str:
    """Why nothing can be read from or written to the folder; empty if both can. Nothing is left there."""
    try:
        if not stat.S_ISDIR(folder.stat().st_mode):
            return "is no folder"
        list(folder.iterdir())
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"doctor" * 1000)
            file.flush()
            os.fsync(file.fileno())
    except FileNotFoundError:
        if folder.is_symlink():
            return f"is a link to {folder.readlink()}, which does not exist"
        return "does not exist"
    except OSError as error:
        return f"cannot be used: {error.strerror}"
    return ""
