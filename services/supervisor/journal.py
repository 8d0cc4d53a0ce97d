"""One stream of what all processes say: everything in `logs/kinebox.log` of the data folder, and on the console what matters.

The file has one JSON object a line, for programs. The console (stderr) is for people, at a terminal or in the log of a service: it
has the warnings and errors of the processes and all that the supervisor says, as plain lines with the time of day.
"""

import datetime as dt
import logging
import logging.handlers
import sys
from pathlib import Path
from typing import Any, TextIO

import msgspec

from models.errors import USER_ERROR_PREFIX
from models.process import EDGE

_FILE_BYTES = 8 * 2**20
_OLD_FILES = 3
_LOUD = frozenset({"warning", "error", "critical"})
_NOT_SHOWN = frozenset({"time", "level", "process", "event", "exception"})


class _LogFile(logging.handlers.RotatingFileHandler):
    def handleError(self, record: logging.LogRecord) -> None:  # noqa: N802 - the name is the library's
        """Say nothing: the library would print a traceback for every line."""


class Journal:
    """Writes lines. A console that is gone or a disc that is full or read-only must not stop the box.

    A file that cannot be opened is said once on the console, and the box runs on without one: then the console gets everything.

    Args:
        folder: where the file is kept; it is made if it is missing.
        console: where a person looks.
    """

    def __init__(self, folder: Path, console: TextIO | None = None) -> None:
        self.path = folder / "kinebox.log"
        self._console = console or sys.stderr
        self._file: _LogFile | None = None
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._file = _LogFile(self.path, maxBytes=_FILE_BYTES, backupCount=_OLD_FILES)
        except OSError as error:
            self.say(f"nothing is kept in {self.path}: {error.strerror}; free or mend the disc, then start anew", level="warning")

    def child_said(self, process: str, line: str) -> None:
        """Pass on a line of a process; one that is no JSON (a traceback, a library's print) is wrapped as an error."""
        entry = _parse(line)
        if entry is None:
            entry = _entry(process, "error", line.removeprefix(USER_ERROR_PREFIX))
            line = msgspec.json.encode(entry).decode()
        self._write(line)
        if self._file is None or entry.get("level") in _LOUD:
            self._show(_readable(entry))

    def say(self, event: str, *, level: str = "info", **details: str) -> None:
        """A line of the supervisor's own; a person always sees it."""
        entry = _entry("supervisor", level, event) | details
        self._write(msgspec.json.encode(entry).decode())
        self._show(_readable(entry))

    def welcome(self, block: str) -> None:
        """Lines meant for a person only, on stdout."""
        try:
            sys.stdout.write(block + "\n")
            sys.stdout.flush()
        except OSError:
            pass

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            self._file.close()

    def _write(self, line: str) -> None:
        if self._file is not None:
            self._file.handle(logging.LogRecord("kinebox", logging.INFO, "", 0, line, None, None))

    def _show(self, line: str) -> None:
        try:
            self._console.write(line + "\n")
            self._console.flush()
        except OSError:
            pass


def _entry(process: str, level: str, event: str) -> dict[str, Any]:
    now = dt.datetime.now(dt.UTC)
    return {"process": process, "level": level, "event": event, "time": now.isoformat().replace("+00:00", "Z")}


def _parse(line: str) -> dict[str, Any] | None:
    try:
        return msgspec.json.decode(line, type=dict[str, Any]) if line.startswith("{") else None
    except msgspec.DecodeError:
        return None


def _readable(entry: dict[str, Any]) -> str:
    details = " ".join(f"{key}={value}" for key, value in entry.items() if key not in _NOT_SHOWN)
    line = f"{_clock(entry.get('time'))}  {_speaker(entry.get('process')):12}  {entry.get('event', '')} {details}".rstrip()
    return "\n".join([line, *([str(entry["exception"])] if "exception" in entry else [])])


def _clock(time: object) -> str:
    """The local time of day of an ISO time; now, if the line has none."""
    try:
        return dt.datetime.fromisoformat(str(time)).astimezone().strftime("%H:%M:%S")
    except ValueError:
        return dt.datetime.now().astimezone().strftime("%H:%M:%S")


def _speaker(process: object) -> str:
    name = str(process or "?")
    camera = name.removeprefix(f"{EDGE}-")
    return name if camera == name else f"camera {camera}"
