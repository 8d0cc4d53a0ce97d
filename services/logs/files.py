"""The files of the log: numbered, each written once from beginning to end and never renamed, so that a reader cannot miss one."""

import re
from pathlib import Path

from models.process import REPLAY

LATEST = "kinebox.log"
"""A link to the file that is written now, for people and their tools."""
STARTED = "the box starts"
"""The event of the record with which every run begins; its field `site` is the site file."""
_NAME = re.compile(r"kinebox-(\d{6,})\.log")


def log_folder(data: Path, *, replay: bool = False) -> Path:
    """Where the log of the box is kept, or that of replays, which may run beside a box on the same data folder."""
    return data / "logs" / REPLAY if replay else data / "logs"


def log_path(folder: Path, number: int) -> Path:
    """The file of a number."""
    return folder / f"kinebox-{number:06}.log"


def log_numbers(folder: Path) -> list[int]:
    """The files that there are, oldest first; none if there is no folder.

    Raises:
        OSError: the folder cannot be read.
    """
    try:
        names = [entry.name for entry in folder.iterdir()]
    except FileNotFoundError:
        return []
    return sorted(int(found[1]) for name in names if (found := _NAME.fullmatch(name)))


def changed_ns(file: Path) -> int:
    """When a file was written to last, on the wall clock; 0 if it was the oldest, and went."""
    try:
        return file.stat().st_mtime_ns
    except FileNotFoundError:
        return 0
