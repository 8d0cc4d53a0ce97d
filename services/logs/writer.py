"""Writes the log's files.

Every line is one `write`, so a process that is killed leaves whole lines; if a disc is full and takes a part of a line, the part is
cut off again. What a loss of power leaves of a line is ended at the next start and shown as damaged, not lost. Nothing here raises
for a disc that fails: lines that could not be kept are counted, and the first one that can be kept again is told so.
"""

import contextlib
import datetime as dt
import errno
import fcntl
import os
from pathlib import Path

from services.logs.files import LATEST, log_numbers, log_path
from services.logs.record import LogRecord, encode

IN_USE = "another KineBox writes its log there; start this one with a data folder of its own"
_SUPERVISOR = "supervisor"


class LogWriter:
    """Appends to the newest file and begins another when that is full; the oldest are deleted.

    At most `max_files` times `max_file_bytes` is ever kept. Only one writer at a time has a folder.

    Attributes:
        problem: why the last line was not kept; empty if it was.
    """

    def __init__(self, folder: Path, max_file_bytes: int, max_files: int) -> None:
        self._folder = folder
        self._max_file_bytes = max_file_bytes
        self._max_files = max_files
        self._lock: int | None = None
        self._file: int | None = None
        self._number = 0
        self._lost = 0
        self.problem = ""
        try:
            self._open()
        except OSError as error:
            self._fail(error)

    def write(self, record: LogRecord) -> None:
        """Keep a record, or count it as lost."""
        self._keep(record.time, encode(record), 1)

    def try_again(self, time: dt.datetime) -> None:
        """If there is a problem, see whether it is over, by telling of the lines that were lost."""
        if self.problem:
            self._keep(time, b"", 0)

    def lose(self, lines: int, reason: str) -> None:
        """Count lines that were lost before they came here."""
        self._lost += lines
        self.problem = reason

    def close(self) -> None:
        """Let go of the files."""
        for descriptor in (self._file, self._lock):
            if descriptor is not None:
                os.close(descriptor)
        self._file = self._lock = None

    def _keep(self, time: dt.datetime, data: bytes, lines: int) -> None:
        try:
            self._open()
            self._append(self._told_of_loss(time) + data)
        except OSError as error:
            self._lost += lines
            self._fail(error)
        else:
            self._lost, self.problem = 0, ""

    def _told_of_loss(self, time: dt.datetime) -> bytes:
        if not self._lost:
            return b""
        event = "lines of the log could not be kept"
        return encode(LogRecord(time, _SUPERVISOR, "warning", event, {"lines": self._lost, "reason": self.problem}))

    def _fail(self, error: OSError) -> None:
        self.problem = error.strerror or str(error)
        self.close()

    def _open(self) -> None:
        """The newest file, or another if that was deleted under us."""
        if self._file is not None:
            if os.fstat(self._file).st_nlink:
                return
            self._number += 1  # Whoever follows the log knows the deleted one by its number.
        self.close()
        self._folder.mkdir(parents=True, exist_ok=True)
        self._lock = os.open(self._folder, os.O_RDONLY | os.O_DIRECTORY)
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise OSError(errno.EBUSY, IN_USE) from error
        self._adopt()
        self._begin(max(1, self._number, *log_numbers(self._folder)))
        self._end_torn_line()

    def _adopt(self) -> None:
        """A log of a KineBox that did not number its files becomes the newest of them."""
        latest = self._folder / LATEST
        if latest.is_file() and not latest.is_symlink():
            latest.rename(log_path(self._folder, max(log_numbers(self._folder), default=0) + 1))

    def _begin(self, number: int) -> None:
        """Make room, then go on with the file of that number."""
        kept = 0
        old = [log_path(self._folder, other) for other in log_numbers(self._folder) if other != number]
        for place, path in enumerate(reversed(old), start=2):
            kept += path.stat().st_size
            if place > self._max_files or kept > (self._max_files - 1) * self._max_file_bytes:
                path.unlink()
        path = log_path(self._folder, number)
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND | os.O_CLOEXEC, 0o644)
        if self._file is not None:
            os.close(self._file)
        self._file, self._number = descriptor, number
        with contextlib.suppress(OSError):  # A convenience; some file systems have no links.
            temporary = self._folder / f".{LATEST}.tmp"
            temporary.unlink(missing_ok=True)
            temporary.symlink_to(path.name)
            temporary.replace(self._folder / LATEST)

    def _append(self, data: bytes) -> None:
        assert self._file is not None  # noqa: S101 - `_open` came before
        if (size := os.fstat(self._file).st_size) and size + len(data) > self._max_file_bytes:
            self._begin(self._number + 1)
            size = 0
        written = os.write(self._file, data)
        if written < len(data):
            os.ftruncate(self._file, size)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def _end_torn_line(self) -> None:
        assert self._file is not None  # noqa: S101 - `_open` came before
        size = os.fstat(self._file).st_size
        if size and os.pread(self._file, 1, size - 1) != b"\n":
            os.write(self._file, b"\n")
