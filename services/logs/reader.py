"""Reads the log's files in order, and follows them while they are written, over the beginning of new ones."""

import os
from collections.abc import Generator, Iterator
from pathlib import Path
from typing import NamedTuple

from services.logs.files import changed_ns, log_numbers, log_path
from services.logs.record import LogRecord, decode

_CHUNK_BYTES = 2**20


class Line(NamedTuple):
    """One line of a file.

    Attributes:
        file: name of the file.
        number: counts the file's lines from 1.
        raw: its bytes, without its end.
        record: what it says; None if it is damaged.
    """

    file: str
    number: int
    raw: bytes
    record: LogRecord | None


class LogReader:
    """Every line once, in the order in which they were written.

    A part of a line is not read before the whole is there. A damaged line is handed on as such. What people do to the files is told
    as a damaged line: files that were deleted before they could be read, a file that was emptied, a log that was begun anew.

    Args:
        folder: the log's.
        first: number of the file to begin with, or the next that there is.
        last: number of the file to end with; endless if it is None.
    """

    def __init__(self, folder: Path, first: int = 0, last: int | None = None) -> None:
        self._folder = folder
        self._first = first
        self._last = last
        self._file: int | None = None
        self._number = 0
        self._offset = 0
        self._lines = 0

    def poll(self) -> Iterator[Line]:
        """All whole lines that were not read yet."""
        while self._file is not None or (yield from self._open_next()):
            yield from self._whole_lines()
            anew = self._begun_anew()
            if not anew and not self._is_left_behind():
                return
            # Nobody writes to a file once there is a newer one: what is read now is its end.
            yield from self._whole_lines()
            yield from self.torn()
            if anew:
                yield Line(self._name(), 0, b"the log was deleted and begun anew", None)
                self._first, self._number = anew[0], 0
            self.close()

    def torn(self) -> Iterator[Line]:
        """What stands after the last whole line, if anything: a line that was cut off, or is being written this moment."""
        if self._file is not None and (rest := os.pread(self._file, _CHUNK_BYTES, self._offset)):
            yield Line(self._name(), self._lines + 1, rest, decode(rest))

    def close(self) -> None:
        """Let go of the file."""
        if self._file is not None:
            os.close(self._file)
        self._file = None

    def _open_next(self) -> Generator[Line, None, bool]:
        before = self._number
        while newer := [number for number in log_numbers(self._folder) if number > before and self._is_wanted(number)]:
            try:
                self._file = os.open(log_path(self._folder, newer[0]), os.O_RDONLY | os.O_CLOEXEC)
            except FileNotFoundError:
                continue  # It was the oldest, and went.
            self._number, self._offset, self._lines = newer[0], 0, 0
            if before and (gone := newer[0] - before - 1):
                yield Line(self._name(), 0, f"{gone} files were deleted before they could be read".encode(), None)
            return True
        return False

    def _whole_lines(self) -> Iterator[Line]:
        assert self._file is not None  # noqa: S101 - callers have opened one
        if os.fstat(self._file).st_size < self._offset:
            yield Line(self._name(), 0, b"the file was emptied; what it held before is gone", None)
            self._offset = self._lines = 0
        name, position, rest = self._name(), self._offset, b""
        while chunk := os.pread(self._file, _CHUNK_BYTES, position):
            position += len(chunk)
            *whole, rest = (rest + chunk).split(b"\n")
            for raw in whole:
                self._offset += len(raw) + 1
                self._lines += 1
                yield Line(name, self._lines, raw, decode(raw))

    def _is_wanted(self, number: int) -> bool:
        return number >= self._first and (self._last is None or number <= self._last)

    def _begun_anew(self) -> list[int]:
        """The files of another log that stands where ours was deleted: numbered no higher, and changed no earlier."""
        assert self._file is not None  # noqa: S101 - callers have opened one
        own = os.fstat(self._file)
        if own.st_nlink:
            return []
        lower = [number for number in log_numbers(self._folder) if number <= self._number]
        return [number for number in lower if changed_ns(log_path(self._folder, number)) >= own.st_mtime_ns]

    def _is_left_behind(self) -> bool:
        return any(number > self._number for number in log_numbers(self._folder))

    def _name(self) -> str:
        return log_path(self._folder, self._number).name
