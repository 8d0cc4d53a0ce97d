"""The form of a line of the log.

One JSON object a line, its keys always in this order: `time` (UTC, ISO 8601, microseconds), `process`, `level` (one of `LEVELS`),
`event` (what happened, in words), then the fields by name, and `exception` (a whole traceback) last, where there is one.

A line is at most `LONGEST_LINE_BYTES` long. Arrays are told by their shape and never by their content, so that neither pictures
nor keypoints enter a log; what is too long is cut, and says so.
"""

import datetime as dt
from collections.abc import Collection, Mapping
from typing import Any

import msgspec

LEVELS = ("debug", "info", "warning", "error", "critical")
LONGEST_LINE_BYTES = 32768
"""Shorter than what the supervisor takes for one line of a process (64 KiB)."""

_HEAD = ("time", "process", "level", "event")
_RESERVED = frozenset({*_HEAD, "exception"})
_LONGEST_EVENT, _LONGEST_TEXT, _LONGEST_EXCEPTION = 2000, 500, 12000
_MOST_FIELDS, _MOST_ITEMS, _DEEPEST = 24, 16, 3
_LARGEST_NUMBER = 2**63
_ROOM_FOR_REMARK = 40
"""What was cut is no longer than its limit, so that it is not cut again on its way into the log."""


class LogRecord(msgspec.Struct, frozen=True):
    """One line, read.

    Attributes:
        time: aware, in UTC.
        process: name of the process, as on the bus.
        level: one of `LEVELS`.
        event: what happened.
        fields: JSON values by name; none of the names above.
        exception: traceback, several lines; empty if there is none.
    """

    time: dt.datetime
    process: str
    level: str
    event: str
    fields: dict[str, Any] = {}
    exception: str = ""


def record_of(said: Mapping[str, Any], process: str, now: dt.datetime) -> LogRecord:
    """A record from whatever a process said: what is missing or wrong is filled in, what is no JSON or too long is described.

    Args:
        said: keys as in a line of the log.
        process: who said it, if it does not say so itself.
        now: aware; the time, if it has none.
    """
    named, level = said.get("process"), said.get("level")
    return LogRecord(
        time=_time(said.get("time")) or now.astimezone(dt.UTC),
        process=_text(named if isinstance(named, str) and named else process, 64),
        level=level if level in LEVELS else "info",
        # Libraries end some of theirs with a line's end, which would be shown as what it is to whoever reads it.
        event=_text(said.get("event", ""), _LONGEST_EVENT).strip(),
        fields=_fields({key: value for key, value in said.items() if key not in _RESERVED}),
        exception=_end_of_text(said.get("exception") or ""),
    )


def encode(record: LogRecord) -> bytes:
    """The line, with its end."""
    line = _encode(record)
    if len(line) <= LONGEST_LINE_BYTES:
        return line
    cut = msgspec.structs.replace(
        record, event=_text(record.event, 500), fields={"fields_left_out": len(record.fields)}, exception=record.exception[-2000:]
    )
    return _encode(cut)


def decode(line: bytes) -> LogRecord | None:
    """A line, with or without its end; None if it is damaged, or no line of a log."""
    try:
        said = msgspec.json.decode(line, type=dict[str, Any])
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return None
    time, exception = _time(said.get("time")), said.get("exception", "")
    texts = [said.get(key) for key in _HEAD[1:]] + [exception]
    if time is None or not all(isinstance(text, str) for text in texts) or said["level"] not in LEVELS:
        return None
    fields = {key: value for key, value in said.items() if key not in _RESERVED}
    return LogRecord(time, said["process"], said["level"], said["event"], fields, exception)


def time_text(time: dt.datetime) -> str:
    """A time as a line has it."""
    return time.astimezone(dt.UTC).isoformat(timespec="microseconds").replace("+00:00", "Z")


def _encode(record: LogRecord) -> bytes:
    head = (time_text(record.time), record.process, record.level, record.event)
    end = {"exception": record.exception} if record.exception else {}
    ordered = {key: record.fields[key] for key in sorted(record.fields)}
    return msgspec.json.encode(dict(zip(_HEAD, head, strict=True)) | ordered | end) + b"\n"


def _time(value: object) -> dt.datetime | None:
    try:
        time = dt.datetime.fromisoformat(value) if isinstance(value, str) else None
        return None if time is None or time.tzinfo is None else time.astimezone(dt.UTC)
    except (ValueError, OverflowError):
        return None


def _fields(fields: dict[str, Any]) -> dict[str, Any]:
    kept = {_text(key, 64): _plain(fields[key]) for key in sorted(fields, key=str)[:_MOST_FIELDS]}
    return {key: value for key, value in kept.items() if key not in _RESERVED}


def _plain(value: Any, depth: int = 0) -> object:
    """A JSON value that says what `value` is, and is short."""
    if hasattr(value, "shape") and hasattr(value, "dtype") and value.shape == ():
        value = value.item()
    if isinstance(value, int) and abs(value) >= _LARGEST_NUMBER:
        return _text(hex(value), _LONGEST_TEXT)
    if value is None or isinstance(value, bool | int | float):
        return value
    if isinstance(value, Mapping | list | tuple | set | frozenset):
        return _plain_items(value, depth)
    return _text(_described(value), _LONGEST_TEXT)


def _plain_items(value: Mapping[Any, Any] | Collection[Any], depth: int) -> object:
    if len(value) > _MOST_ITEMS or depth == _DEEPEST:
        return f"({type(value).__name__} of {len(value)})"
    if isinstance(value, Mapping):
        return {_text(key, 64): _plain(item, depth + 1) for key, item in value.items()}
    return [_plain(item, depth + 1) for item in value]


def _described(value: Any) -> object:
    if isinstance(value, bytes | bytearray | memoryview):
        return f"({len(value)} bytes)"
    if hasattr(value, "shape") and hasattr(value, "dtype"):
        return f"(array {value.shape} of {value.dtype})"
    return value


def _text(value: object, longest: int) -> str:
    text = _whole_characters(value)
    kept = longest - _ROOM_FOR_REMARK
    return text if len(text) <= longest else f"{text[:kept]}... ({len(text) - kept} more characters)"


def _end_of_text(value: object) -> str:
    """The end of a traceback says what happened and where."""
    text = _whole_characters(value)
    kept = _LONGEST_EXCEPTION - _ROOM_FOR_REMARK
    return text if len(text) <= _LONGEST_EXCEPTION else f"({len(text) - kept} more characters) ...{text[-kept:]}"


def _whole_characters(value: object) -> str:
    """A text without halves of surrogate pairs, which names of files may hold and JSON does not."""
    try:
        text = str(value)
    except Exception as error:  # noqa: BLE001 - whatever is logged, a log must not fail
        text = f"({type(value).__name__} that cannot be printed: {type(error).__name__})"
    return text.encode("utf-8", "backslashreplace").decode()
