"""Records of a log, made for tests."""

import datetime as dt
import json
import string
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from services.logs.reader import Line, LogReader
from services.logs.record import LEVELS, LogRecord

NOON = dt.datetime(2025, 11, 22, 12, 0, 0, tzinfo=dt.UTC)
# All that a program may hold in a text, halves of surrogate pairs included.
TEXTS = st.text(st.characters(), max_size=20)
NAMES = st.text(string.ascii_lowercase + "_", min_size=1, max_size=6).filter(lambda name: name not in {"time", "level", "event"})
VALUES: st.SearchStrategy[Any] = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | TEXTS | st.binary(max_size=5) | st.builds(object),
    lambda inner: st.lists(inner, max_size=20) | st.dictionaries(TEXTS, inner, max_size=4) | st.tuples(inner, inner),
    max_leaves=30,
)
TIMES = st.integers(-3600, 3600).map(lambda seconds: NOON + dt.timedelta(seconds=seconds))
RECORDS = st.builds(
    LogRecord,
    time=TIMES,
    process=st.sampled_from(["supervisor", "fusion", "edge-cam01", "edge-cam02", "edgy"]),
    level=st.sampled_from(LEVELS),
    event=st.sampled_from(["governor", "Refused", "crashed: ÄRGER", "\x1b[31mred\n"]),
    fields=st.dictionaries(NAMES, st.integers(0, 9) | st.sampled_from(["gym", "Ärger"]), max_size=2),
    exception=st.sampled_from(["", "Traceback:\n  in gym\nError"]),
)


def numbered(number: int, size: int = 0) -> LogRecord:
    """A record that is known by its number, of about `size` bytes more than the least."""
    return LogRecord(
        NOON + dt.timedelta(milliseconds=number), "fusion", "info", "counted", {"number": number, "padding": "x" * size}
    )


def numbers(lines: list[Line]) -> list[int]:
    """Of the records that `numbered` made."""
    return [line.record.fields["number"] for line in lines if line.record is not None and line.record.event == "counted"]


def whole_log(folder: Path) -> list[Line]:
    """Every line of a log, a torn one included."""
    reader = LogReader(folder)
    lines = [*reader.poll(), *reader.torn()]
    reader.close()
    return lines


def raw_lines(folder: Path, *, torn: bool = False) -> list[dict[str, Any]]:
    """Every line of a log's files, read without any of our code; one that is no JSON fails, or is left out where some are torn."""
    files = sorted(folder.glob("kinebox-*.log"))
    lines = [line for file in files for line in file.read_text().split("\n") if line]
    return [json.loads(line) for line in lines if not torn or line.endswith("}")]
