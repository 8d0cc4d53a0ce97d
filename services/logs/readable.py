"""Lines of the log for people."""

import datetime as dt

import msgspec

from models.process import EDGE
from services.logs.printable import printable
from services.logs.reader import Line
from services.logs.record import LogRecord

_COLOURS = {"debug": "2", "warning": "33", "error": "31", "critical": "1;31", "damaged": "35"}
_LEVEL_WIDTH, _PROCESS_WIDTH = 8, 12


def readable(line: Line, *, colour: bool) -> str:
    """A line of the log: local time, level, process, event and fields, aligned; a traceback below it, indented.

    Args:
        line: the line; a damaged one is shown as it is.
        colour: mark its level with the terminal's colours.
    """
    record = line.record
    if record is None:
        head = [f"{line.file}:{line.number}"[:23].ljust(23), _coloured("damaged", colour=colour), printable(line.raw)]
        return "  ".join(head)
    time = local(record.time).replace(tzinfo=None).isoformat(sep=" ", timespec="milliseconds")
    said = " ".join((printable(record.event), *details(record)))
    first = "  ".join(
        [time, _coloured(record.level, colour=colour), printable(record.process).ljust(_PROCESS_WIDTH), said]
    ).rstrip()
    return "\n".join([first, *(f"    {printable(each)}" for each in record.exception.splitlines())])


def as_json(line: Line) -> str:
    """A line of the log for programs; a damaged one as an object with `damaged` (its text), `file` and `line`."""
    if line.record is not None:
        return line.raw.decode()
    return msgspec.json.encode(
        {"damaged": line.raw.decode(errors="backslashreplace"), "file": line.file, "line": line.number}
    ).decode()


def local(time: dt.datetime) -> dt.datetime:
    """An aware time on this machine's clock; in UTC at the ends of the calendar, which the hours of a zone would lead out of."""
    try:
        return time.astimezone()
    except (OverflowError, ValueError):
        return time.astimezone(dt.UTC)


def speaker(process: str) -> str:
    """A process as a teacher calls it."""
    camera = process.removeprefix(f"{EDGE}-")
    return process if camera == process else f"camera {camera}"


def details(record: LogRecord) -> list[str]:
    """The fields, each as `name=value`."""
    return [printable(f"{name}={_value(value)}") for name, value in record.fields.items()]


def _value(value: object) -> str:
    return value if isinstance(value, str) else msgspec.json.encode(value).decode()


def _coloured(level: str, *, colour: bool) -> str:
    text = level.ljust(_LEVEL_WIDTH)
    return f"\x1b[{_COLOURS[level]}m{text}\x1b[0m" if colour and level in _COLOURS else text
