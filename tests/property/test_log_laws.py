"""What holds for whatever is logged, and for whatever is looked for in a log."""

import datetime as dt
import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from services.logs.past import last_lines
from services.logs.query import Query
from services.logs.readable import as_json, readable
from services.logs.reader import Line, LogReader
from services.logs.record import LEVELS, LONGEST_LINE_BYTES, LogRecord, decode, encode, record_of, time_text
from services.logs.writer import LogWriter
from tests.log_lines import NOON, RECORDS, TEXTS, TIMES, VALUES, numbered, numbers, raw_lines, whole_log

DAMAGED = st.binary(max_size=30).map(lambda data: b"{" + data.replace(b"\n", b" "))


@pytest.mark.slow
@given(st.dictionaries(TEXTS | st.sampled_from(["time", "process", "level", "event", "exception"]), VALUES, max_size=30))
def test_whatever_is_said_becomes_one_short_line_of_the_one_form(said: dict[str, Any]) -> None:
    line = encode(record_of(said, "fusion", NOON))
    assert line.index(b"\n") == len(line) - 1
    assert len(line) <= LONGEST_LINE_BYTES
    read = json.loads(line)
    head, fields = list(read)[:4], [key for key in list(read)[4:] if key != "exception"]
    assert head == ["time", "process", "level", "event"]
    assert fields == sorted(fields)
    assert "exception" not in read or list(read)[-1] == "exception"
    assert read["level"] in LEVELS
    assert dt.datetime.fromisoformat(read["time"]).utcoffset() == dt.timedelta(0)
    assert len(read["time"]) == len("2026-11-22T12:00:00.000000Z")
    record = decode(line)
    assert record is not None
    # Its form is stable: said again, it is the same line.
    assert encode(record_of(read, "nobody", NOON)) == line


@given(st.integers(0, 50000), st.sampled_from(["x", "\x00", "\U0001f600", '"']), st.integers(0, 40))
def test_a_line_is_never_longer_than_a_reader_takes(length: int, character: str, fields: int) -> None:
    text = character * length
    said = {"event": text, "exception": text, **{f"{character}{number}": text for number in range(fields)}}
    line = encode(record_of(said, text or "fusion", NOON))
    assert len(line) <= LONGEST_LINE_BYTES
    # The supervisor passes on a line as its process made it.
    assert encode(record_of(json.loads(line), "nobody", NOON)) == line


@given(st.integers(1, 40), st.integers(1, 3))
def test_no_array_enters_a_log(rows: int, columns: int) -> None:
    keypoints = np.full((rows, columns), 123.456)
    line = encode(
        record_of({"event": "seen", "keypoints": keypoints, "nested": [keypoints], "raw": keypoints.tobytes()}, "edge", NOON)
    )
    assert b"123.4" not in line
    assert f"(array ({rows}, {columns}) of float64)".encode() in line


@given(RECORDS)
def test_a_line_that_is_read_says_what_was_written(record: LogRecord) -> None:
    assert decode(encode(record)) == record


@pytest.mark.slow
@given(st.lists(st.integers(0, 400), max_size=60), st.integers(2, 5))
def test_a_log_keeps_its_bound_and_its_newest_lines_in_order(sizes: list[int], max_files: int) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "logs"
        writer = LogWriter(folder, 1000, max_files)
        for number, size in enumerate(sizes):
            writer.write(numbered(number, size))
            files = list(folder.glob("kinebox-*.log"))
            assert len(files) <= max_files
            assert all(file.stat().st_size <= 1000 for file in files)
        writer.close()
        read = [line["number"] for line in raw_lines(folder)]
        assert read == list(range(len(sizes) - len(read), len(sizes)))
        assert numbers(whole_log(folder)) == read
        assert len(read) == len(sizes) or len(files) == max_files


@st.composite
def queries(draw: st.DrawFn) -> Query:
    return Query(
        since=draw(st.none() | TIMES),
        level=draw(st.sampled_from(LEVELS)),
        processes=draw(st.sampled_from([(), ("fusion",), ("edge",), ("edge-cam02", "supervisor")])),
        text=draw(st.sampled_from(["", "GYM", "ärger", "a=1", "red", "traceback:", "number"])),
    )


def is_wanted(said: dict[str, Any], query: Query) -> bool:
    """The filter once more, as simple as can be, over what a line's JSON says."""
    fields = [f"{key}={value}" for key, value in said.items() if key not in ("time", "process", "level", "event", "exception")]
    everything = "\n".join([said["event"], *fields, said.get("exception", "")]).casefold()
    return (
        (query.since is None or said["time"] >= time_text(query.since))
        and said["level"] in LEVELS[LEVELS.index(query.level) :]
        and (not query.processes or any(said["process"] == p or said["process"].startswith(p + "-") for p in query.processes))
        and query.text.casefold() in everything
    )


@pytest.mark.slow
@given(st.lists(RECORDS, max_size=30), queries(), st.integers(0, 40))
def test_a_filter_over_several_files_finds_what_a_naive_one_finds(records: list[LogRecord], query: Query, most: int) -> None:
    with tempfile.TemporaryDirectory() as name:
        writer = LogWriter(Path(name), 700, 1000)
        for record in records:
            writer.write(record)
        writer.close()
        found = [json.loads(as_json(line)) for line in query.select(LogReader(Path(name)).poll())]
        assert len(list(Path(name).glob("kinebox-*.log"))) >= len(records) // 7
        wanted = [said for said in raw_lines(Path(name)) if is_wanted(said, query)]
        assert found == wanted
        last, reader = last_lines(Path(name), query, most, torn=True)
        assert [json.loads(as_json(line)) for line in last] == (wanted[-most:] if most else [])
        assert list(reader.poll()) == []
        reader.close()


@pytest.mark.slow
@given(st.lists(RECORDS.map(encode).map(bytes.rstrip) | DAMAGED, max_size=12), st.booleans())
def test_a_damaged_log_is_shown_whole_and_never_a_traceback(lines: list[bytes], torn: bool) -> None:
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "kinebox-000003.log").write_bytes(b"\n".join(lines) + (b"" if torn else b"\n"))
        read = whole_log(Path(name))
        wanted = lines if lines and not torn else lines[:-1] + [line for line in lines[-1:] if line]
        assert [line.raw for line in read] == (wanted or ([] if torn else [b""]))
        for line in read:
            shown = readable(line, colour=True)
            assert not any(ord(each) == 0x1B for each in shown.replace("\x1b[", "", 2)), shown
            said = json.loads(as_json(line))
            assert ("damaged" in said) == (line.record is None)


@pytest.mark.slow
@given(st.lists(st.tuples(RECORDS, st.booleans()), min_size=1, max_size=12), queries())
def test_a_damaged_line_is_left_out_by_its_text_and_the_time_before_it_only(
    lines: list[tuple[LogRecord, bool]], query: Query
) -> None:
    broken = Line("kinebox-000001.log", 2, b"{gym", None)
    given_lines = []
    for number, (record, followed_by_damage) in enumerate(lines):
        raw = encode(record)[:-1]
        given_lines.append(Line("kinebox-000001.log", number, raw, record))
        if followed_by_damage:
            given_lines.append(broken._replace(number=1000 + number))
    found = {line.number for line in query.select(given_lines) if line.record is None}
    late = {
        1000 + number
        for number, (record, followed_by_damage) in enumerate(lines)
        if followed_by_damage and (query.since is None or record.time >= query.since)
    }
    assert found == (late if query.text.casefold() in "{gym" else set())
