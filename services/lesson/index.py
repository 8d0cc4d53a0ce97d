"""The list of lessons. The files are the truth: the index only saves reading them all, and is made anew if it is lost or broken."""

import sqlite3
import time
from collections.abc import Iterator
from dataclasses import astuple, dataclass, fields
from pathlib import Path
from typing import Annotated

import msgspec
import structlog
from msgspec import Meta

from models.errors import UserError
from models.regular_file import require_regular
from services.lesson.layout import PART_SUFFIX, SUFFIX
from services.lesson.lesson_file import LessonWriter, is_being_written
from services.lesson.lesson_reader import NewerLessonError, open_lesson, read_header
from services.lesson.readable_names import readable
from services.lesson.survey import survey

NAME = "index.sqlite"
_VERSION = 4
_PATIENCE_S = 1.0
"""How long to wait for another process that writes. A recorder may be the one that waits; a list that is not kept is made again."""

_LATEST_NS = 2**63 - 1
"""Of a file's date; a file system may know later ones, SQLite and calendars do not."""
_READ_AGAIN_NS = 0
"""In place of a file's date: what was wrong may pass without a change of the file."""
_Seconds = Annotated[float, Meta(ge=-2e10, le=2e10)]
"""Some centuries; every time that a lesson can hold."""

log = structlog.get_logger()


@dataclass(frozen=True)
class LessonRow:
    """One lesson of the list.

    Attributes:
        file: the name of its file; `readable` if that is not UTF-8. A finished lesson and one that was cut short may differ by no
            more than the suffix, as when a copy was brought back beside what a crash left.
        title: what people call it.
        started_s: seconds since 1970 (UTC).
        seconds: from the first entry to the last; while it is being recorded, since its start.
        bytes: of the file.
        gaps: interruptions.
        segments: stretches that replay in one go.
        state: "finished"; "recording"; "unfinished", of which the recorder died or the disk was full at its end; "damaged".
        problem: what a person is told who opens it; empty if nothing is wrong.
        changed_ns: when the file was changed last, by which a changed file is known; 0 of one that could not be read for a reason
            that may pass without a change of the file: it is read each time.
    """

    file: str
    title: str
    started_s: _Seconds
    seconds: _Seconds
    bytes: int
    gaps: int
    segments: int
    state: str
    problem: str
    changed_ns: int

    @property
    def lesson(self) -> str:
        """Its name, which is the file's without suffix."""
        return self.file.removesuffix(PART_SUFFIX).removesuffix(SUFFIX)


_NAMES = tuple(field.name for field in fields(LessonRow))
_TABLE = """lessons (
    file TEXT NOT NULL PRIMARY KEY,
    title TEXT NOT NULL,
    started_s REAL NOT NULL,
    seconds REAL NOT NULL,
    bytes INTEGER NOT NULL,
    gaps INTEGER NOT NULL,
    segments INTEGER NOT NULL,
    state TEXT NOT NULL,
    problem TEXT NOT NULL,
    changed_ns INTEGER NOT NULL
)"""
_SELECT = "SELECT * FROM lessons"
_CREATED = "SELECT sql FROM sqlite_master WHERE name = 'lessons'"
_REPLACE = "INSERT OR REPLACE INTO lessons VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)"


class LessonIndex:
    """The index of one folder, in the file `index.sqlite` there.

    Any number of processes may use it. If the folder cannot be written to, the list is made in memory each time.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._memory: sqlite3.Connection | None = None

    def lessons(self) -> list[LessonRow]:
        """Every lesson in the folder as its file is now, the newest first; a file that is new or was changed is read."""
        connection = self._connect()
        try:
            known = {row.file: row for row in _rows(connection)}
            found = {row.file: row for row in self._found(known)}
            gone = [(file,) for file in known.keys() - found.keys()]
            new = [astuple(row) for file, row in found.items() if row != known.get(file)]
            if gone or new:
                self._write(connection, gone, new)
        finally:
            if connection is not self._memory:
                connection.close()
        return sorted(found.values(), key=lambda row: (row.started_s, row.file), reverse=True)

    def note(self, writer: LessonWriter, path: Path) -> None:
        """A lesson was finished: list it without reading its file. If that fails, the next list reads the file."""
        try:
            status = path.stat()
        except OSError as error:
            self._cannot_write(error)
            return
        header = writer.header
        row = LessonRow(
            file=path.name,
            title=header.title,
            started_s=header.started_s,
            seconds=writer.recorded_s,
            bytes=status.st_size,
            gaps=writer.gaps,
            segments=writer.segments,
            state="finished",
            problem="",
            changed_ns=status.st_mtime_ns,
        )
        connection = self._connect()
        try:
            self._write(connection, [], [astuple(row)])
        finally:
            if connection is not self._memory:
                connection.close()

    def _write(self, connection: sqlite3.Connection, gone: list[tuple[str]], new: list[tuple[object, ...]]) -> None:
        try:
            with connection:
                connection.executemany("DELETE FROM lessons WHERE file = ?", gone)
                connection.executemany(_REPLACE, new)
        except sqlite3.OperationalError as error:
            self._cannot_write(error)
        except sqlite3.DatabaseError as error:
            self._remove(error)

    def _found(self, known: dict[str, LessonRow]) -> Iterator[LessonRow]:
        for path in sorted(self.folder.glob(f"*{SUFFIX}")) + sorted(self.folder.glob(f"*{PART_SUFFIX}")):
            file = readable(path.name)
            try:
                status = path.stat()
            except FileNotFoundError:
                continue  # Finished or removed meanwhile.
            except OSError as error:
                yield LessonRow(file, "", 0.0, 0.0, 0, 0, 0, "damaged", _unreadable(path, error), _READ_AGAIN_NS)
                continue
            row, size, changed_ns = known.get(file), status.st_size, min(max(status.st_mtime_ns, -_LATEST_NS), _LATEST_NS)
            if row is None or _may_differ(row) or (row.bytes, row.changed_ns) != (size, changed_ns):
                row = _read(path, file, size, changed_ns)
            yield row

    def _connect(self) -> sqlite3.Connection:
        if self._memory is None:
            try:
                return self._open_file()
            except sqlite3.DatabaseError as error:
                self._cannot_write(error)
            self._memory = _connect(":memory:")
        return self._memory

    def _open_file(self) -> sqlite3.Connection:
        file = str(self.folder / NAME)
        try:
            return _connect(file)
        except sqlite3.OperationalError:
            raise
        except sqlite3.DatabaseError as error:
            self._remove(error)
            return _connect(file)

    def _remove(self, reason: sqlite3.DatabaseError) -> None:
        """Of a broken index nothing is needed."""
        log.warning("the list of lessons is made anew", folder=str(self.folder), reason=str(reason))
        try:
            for path in self.folder.glob(f"{NAME}*"):
                path.unlink(missing_ok=True)
        except OSError as error:
            self._cannot_write(error)

    def _cannot_write(self, reason: Exception) -> None:
        log.warning("the list of lessons cannot be written", folder=str(self.folder), reason=str(reason))


def _connect(database: str) -> sqlite3.Connection:
    connection = sqlite3.connect(database, timeout=_PATIENCE_S)
    connection.text_factory = _text
    try:
        connection.execute("PRAGMA journal_mode = WAL")
        # After a power cut the last changes may be missing: the files are read again then.
        connection.execute("PRAGMA synchronous = NORMAL")
        (version,) = connection.execute("PRAGMA user_version").fetchone()
        if version not in (0, _VERSION):
            raise sqlite3.DatabaseError(f"it was of version {version}, and this KineBox writes {_VERSION}")
        connection.execute(f"CREATE TABLE IF NOT EXISTS {_TABLE}")
        if connection.execute(_CREATED).fetchone() != (f"CREATE TABLE {_TABLE}",):
            raise sqlite3.DatabaseError("it was another's table of lessons")
        connection.execute(f"PRAGMA user_version = {_VERSION}")
        list(_rows(connection))
    except BaseException:
        connection.close()
        raise
    return connection


def _rows(connection: sqlite3.Connection) -> Iterator[LessonRow]:
    """Every row; sqlite3.DatabaseError if one is none of ours, since SQLite lets anything into any column."""
    for values in connection.execute(_SELECT):
        try:
            yield msgspec.convert(dict(zip(_NAMES, values, strict=True)), LessonRow)
        except msgspec.ValidationError as error:
            raise sqlite3.DatabaseError(f"a row of another kind: {error}") from error


def _text(data: bytes) -> str:
    try:
        return data.decode()
    except UnicodeDecodeError as error:
        raise sqlite3.DatabaseError("a text that is not UTF-8") from error


def _read(path: Path, name: str, size: int, changed_ns: int) -> LessonRow:
    title, started_s, seconds, gaps, segments, state, problem = "", changed_ns * 1e-9, 0.0, 0, 0, "finished", ""
    try:
        if path.name.endswith(PART_SUFFIX):
            require_regular(path.stat())
            with path.open("rb") as file:
                header = read_header(path, file)
                title, started_s = header.title, header.started_s
                if is_being_written(file):
                    # Reading it all each time would take longer and longer.
                    # By the clock that nobody sets: this machine has run on since the lesson began.
                    state, seconds = "recording", max(time.monotonic_ns() - header.started_ns, 0) * 1e-9
                else:
                    contents = survey(file).contents
                    state, seconds, gaps, segments = "unfinished", contents.seconds, contents.gaps, contents.segments
        else:
            with open_lesson(path) as opened:
                title, started_s = opened.header.title, opened.header.started_s
                summary = opened.summary()
            seconds, gaps, segments = summary.seconds, summary.gaps, summary.segments
    except UserError as error:
        state, problem = "damaged", readable(str(error))
        if isinstance(error, NewerLessonError) or isinstance(error.__cause__, OSError):
            changed_ns = _READ_AGAIN_NS
    except OSError as error:
        state, problem, changed_ns = "damaged", _unreadable(path, error), _READ_AGAIN_NS
    return LessonRow(name, title, started_s, seconds, size, gaps, segments, state, problem, changed_ns)


def _may_differ(row: LessonRow) -> bool:
    """Whether a lesson may be otherwise than listed though its file was not changed: a recorder that dies does not change it."""
    return row.state == "recording" or row.changed_ns == _READ_AGAIN_NS


def _unreadable(path: Path, error: OSError) -> str:
    return readable(f"lesson {path} cannot be read: {error.strerror}; correct its owner and rights, or mend its disk")
