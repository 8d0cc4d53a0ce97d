"""What a log holds already, without reading more of its files than it takes."""

from collections import deque
from collections.abc import Iterator
from pathlib import Path

from services.logs.files import changed_ns, log_numbers, log_path
from services.logs.query import Query
from services.logs.reader import Line, LogReader


def wanted_lines(folder: Path, query: Query) -> Iterator[Line]:
    """All lines that are wanted, oldest first; a line that is cut off, too."""
    reader = LogReader(folder, _files(folder, query)[0])
    yield from query.select(_past(reader, torn=True))
    reader.close()


def last_lines(folder: Path, query: Query, most: int, *, torn: bool) -> tuple[list[Line], LogReader]:
    """The newest lines that are wanted, oldest first, and a reader that goes on after them.

    Args:
        folder: the log's.
        query: what is wanted.
        most: so many lines at most.
        torn: a line that is cut off at the end, too, which may be one that is being written.
    """
    *older, newest = _files(folder, query)
    reader = LogReader(folder, newest)
    lines = deque(query.select(_past(reader, torn=torn)), maxlen=most)
    while older and len(lines) < most:
        number = older.pop()
        before = LogReader(folder, number, number)
        lines.extendleft(reversed(deque(query.select(before.poll()), maxlen=most - len(lines))))
        before.close()
    return list(lines), reader


def _files(folder: Path, query: Query) -> list[int]:
    """The files that may hold something wanted, the newest in any case: nothing is later than the last change of its file."""
    numbers = log_numbers(folder) or [0]
    if query.since is None:
        return numbers
    since_s = query.since.timestamp()
    return [number for number in numbers[:-1] if changed_ns(log_path(folder, number)) >= since_s * 1e9] + numbers[-1:]


def _past(reader: LogReader, *, torn: bool) -> Iterator[Line]:
    yield from reader.poll()
    if torn:
        yield from reader.torn()
