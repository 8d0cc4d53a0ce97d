"""Names in a folder made safe against a power cut."""

import os
from pathlib import Path


def sync_folder(folder: Path) -> None:
    """Make safe which files are in a folder, and under which names; their contents need a sync of their own.

    Raises:
        OSError: it cannot be opened or synced.
    """
    descriptor = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
