"""A folder for the files of one replay, which goes with it; of a replay that was killed the next one clears it away."""

import fcntl
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_PREFIX = "kinebox-replay-"


@contextmanager
def replay_folder() -> Iterator[Path]:
    """An empty folder, locked until the end of the block or of this process."""
    _clear_what_was_left(Path(tempfile.gettempdir()))
    with tempfile.TemporaryDirectory(prefix=_PREFIX) as folder:
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX)
            yield Path(folder)
        finally:
            os.close(descriptor)


def _clear_what_was_left(folder: Path) -> None:
    for left in folder.glob(f"{_PREFIX}*"):
        try:
            descriptor = os.open(left, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
        except OSError:  # Of another user, or no folder.
            continue
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if any(left.iterdir()):  # An empty one may be of a replay that has yet to lock it.
                shutil.rmtree(left, ignore_errors=True)
        except OSError:  # Its replay runs.
            continue
        finally:
            os.close(descriptor)
