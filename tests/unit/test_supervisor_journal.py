import errno
import io
import os
import re
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest

from services.logs.writer import IN_USE, LogWriter
from services.supervisor.journal import Journal


class GoneConsole(io.StringIO):
    def write(self, _text: str) -> int:
        raise BrokenPipeError


INFO = '{"process": "fusion", "level": "info", "event": "governor", "rate_hz": 15, "time": "2026-01-02T03:04:05Z"}'
WARNING = '{"process": "edge-cam02", "level": "warning", "event": "refused", "topic": "gym/x", "time": "2026-01-02T03:04:05Z"}'


@pytest.fixture(autouse=True)
def in_the_zone_of_the_school(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("TZ", "XXX-2")
    time.tzset()
    yield
    monkeypatch.undo()
    time.tzset()


def without_time(console: io.StringIO) -> list[str]:
    lines = console.getvalue().splitlines()
    assert all(re.match(r"\d\d:\d\d:\d\d  ", line) for line in lines)
    return [line[10:] for line in lines]


def test_people_get_plain_lines_in_their_own_time_and_are_not_bothered_with_information(tmp_path: Path) -> None:
    console = io.StringIO()
    journal = Journal(tmp_path, console)
    journal.child_said("fusion", INFO)
    journal.child_said("edge-cam02", WARNING)
    journal.close()
    assert console.getvalue() == "05:04:05  camera cam02  refused topic=gym/x\n"
    first, second = (msgspec.json.decode(line) for line in journal.path.read_text().splitlines())
    assert (first["event"], first["rate_hz"], second["event"], second["topic"]) == ("governor", 15, "refused", "gym/x")
    assert list(first) == ["time", "process", "level", "event", "rate_hz"]


def test_the_file_has_every_line_as_json(tmp_path: Path) -> None:
    console = io.StringIO()
    journal = Journal(tmp_path, console)
    journal.child_said("fusion", INFO)
    journal.child_said("edge-a", "kinebox: camera 'a': film.avi is missing")
    journal.say("ended")
    journal.close()
    entries = [msgspec.json.decode(line) for line in journal.path.read_text().splitlines()]
    assert [(entry["process"], entry["level"], entry["event"]) for entry in entries] == [
        ("fusion", "info", "governor"),
        ("edge-a", "error", "camera 'a': film.avi is missing"),
        ("supervisor", "info", "ended"),
    ]
    assert without_time(console) == ["camera a      camera 'a': film.avi is missing", "supervisor    ended"]


def test_a_line_that_ends_with_a_lines_end_is_shown_without_it(tmp_path: Path) -> None:
    console = io.StringIO()
    journal = Journal(tmp_path, console)
    # As Uvicorn logs what an application raises.
    said = {"process": "tablet", "level": "error", "event": "Exception in ASGI application\n", "exception": "Traceback\nValueError"}
    journal.child_said("tablet", msgspec.json.encode(said).decode())
    journal.close()
    assert without_time(console) == ["tablet        Exception in ASGI application ('kinebox logs' has the traceback)"]
    assert msgspec.json.decode(journal.path.read_text())["event"] == "Exception in ASGI application"


@pytest.mark.parametrize("time", ['"noon"', "null", "7"])
def test_a_line_with_no_time_that_can_be_read_is_shown_all_the_same(tmp_path: Path, time: str) -> None:
    console = io.StringIO()
    journal = Journal(tmp_path, console)
    journal.child_said("fusion", f'{{"level": "error", "event": "lost", "time": {time}}}')
    journal.close()
    assert without_time(console) == ["fusion        lost"]


@pytest.mark.parametrize("line", ["{not json", '["a list"]', "Traceback (most recent call last):", "\ufffd\ufffd"])
def test_a_line_that_is_no_log_entry_is_kept_as_an_error(tmp_path: Path, line: str) -> None:
    console = io.StringIO()
    journal = Journal(tmp_path, console)
    journal.child_said("edge-a", line)
    journal.close()
    assert without_time(console) == [f"camera a      {line}"]
    assert msgspec.json.decode(journal.path.read_text())["event"] == line


def test_a_console_that_is_gone_does_not_stop_the_box(tmp_path: Path) -> None:
    journal = Journal(tmp_path, GoneConsole())
    journal.say("still here")
    journal.close()
    assert "still here" in journal.path.read_text()


@pytest.mark.parametrize("fault", ["folder", "file"])
def test_a_log_file_that_cannot_be_opened_is_said_once_and_does_not_stop_the_box(tmp_path: Path, fault: str) -> None:
    if fault == "folder":
        (tmp_path / "logs").write_text("a file where the folder should be")
    else:
        (tmp_path / "logs" / "kinebox-000001.log").mkdir(parents=True)
    console = io.StringIO()
    journal = Journal(tmp_path / "logs", console)
    journal.child_said("fusion", INFO)
    journal.say("still here")
    journal.close()
    lines = without_time(console)
    assert lines[0].startswith(f"supervisor    nothing is kept in {journal.path}: ")
    assert lines[1:] == ["fusion        governor rate_hz=15", "supervisor    still here"]


TRACEBACK = """\
Traceback (most recent call last):
  File "fusion.py", line 3, in main
    step(state)
ValueError: broken
During handling of the above exception, another exception occurred:
Traceback (most recent call last):
  File "fusion.py", line 7, in main
    end()
RuntimeError: crashed
as ordered
"""


def entries_of(journal: Journal) -> list[dict[str, Any]]:
    return [msgspec.json.decode(line) for line in journal.path.read_text().splitlines()]


@pytest.mark.parametrize("ending", ["a log line", "the supervisor's word", "the end", "silence"])
def test_a_printed_traceback_is_one_record_whatever_ends_it(tmp_path: Path, ending: str, monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = time.monotonic()
    console = io.StringIO()
    journal = Journal(tmp_path, console)
    monkeypatch.setattr(time, "monotonic", lambda: now_s)
    for line in TRACEBACK.splitlines():
        journal.child_said("fusion", line)
        journal.child_said("edge-a", INFO)
        journal.settle()
    assert {entry["level"] for entry in entries_of(journal)} == {"info"}, "nothing of the traceback yet"
    if ending == "a log line":
        journal.child_said("fusion", INFO)
    elif ending == "the supervisor's word":
        journal.say("fusion is started again")
    elif ending == "silence":
        now_s += 1.0
        journal.settle()
    if ending == "silence":
        assert "crashed" in journal.path.read_text()
    journal.close()
    found = [entry for entry in entries_of(journal) if "exception" in entry]
    assert [(entry["process"], entry["level"], entry["event"]) for entry in found] == [
        ("fusion", "critical", "RuntimeError: crashed")
    ]
    assert found[0]["exception"] == TRACEBACK.rstrip()
    assert list(found[0])[-1] == "exception"
    shown = next(line for line in console.getvalue().splitlines() if "crashed" in line)
    assert shown.endswith("fusion        RuntimeError: crashed ('kinebox logs' has the traceback)")


def test_an_abort_in_native_code_is_one_record_that_begins_with_its_cause(tmp_path: Path) -> None:
    journal = Journal(tmp_path, io.StringIO())
    said = 'Fatal Python error: Segmentation fault\nCurrent thread 0x0a (most recent call first):\n  File "x.py", line 1 in f'
    for line in said.splitlines():
        journal.child_said("edge-a", line)
    journal.close()
    (entry,) = entries_of(journal)
    assert (entry["event"], entry["exception"]) == ("Fatal Python error: Segmentation fault", said)


def test_what_a_process_says_for_people_is_no_part_of_its_traceback(tmp_path: Path) -> None:
    journal = Journal(tmp_path, io.StringIO())
    journal.child_said("edge-a", "Traceback (most recent call last):")
    journal.child_said("edge-a", "kinebox: camera 'a': film.avi is missing")
    journal.close()
    assert "camera 'a': film.avi is missing" in [entry["event"] for entry in entries_of(journal)]


def test_while_nothing_can_be_kept_people_get_the_tracebacks_too(tmp_path: Path) -> None:
    (tmp_path / "logs").write_text("a file where the folder should be")
    console = io.StringIO()
    journal = Journal(tmp_path / "logs", console)
    for line in TRACEBACK.splitlines():
        journal.child_said("fusion", line)
    journal.close()
    assert '  File "fusion.py", line 7, in main' in console.getvalue()


def test_a_second_box_on_a_folder_says_what_to_do_and_shows_everything(tmp_path: Path) -> None:
    console = io.StringIO()
    first, second = Journal(tmp_path), Journal(tmp_path, console)
    second.child_said("fusion", INFO)
    second.close()
    first.close()
    assert without_time(console) == [
        f"supervisor    nothing is kept in {second.path}: {IN_USE}",
        "fusion        governor rate_hz=15",
    ]


def test_a_log_whose_disk_is_full_says_how_much_room_it_takes_and_nothing_of_rights(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> int:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(LogWriter, "_append", full)
    journal = Journal(tmp_path / "logs", io.StringIO())
    journal.note("a line")
    journal.settle()
    assert journal.trouble is not None
    assert journal.trouble.remedy == "make room on its disk: the log takes up to 64 MB"
    journal.close()


def test_a_quiet_log_notices_that_it_can_be_kept_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = time.monotonic()
    monkeypatch.setattr(time, "monotonic", lambda: now_s)
    (tmp_path / "logs").write_text("a file where the folder should be")
    journal = Journal(tmp_path / "logs", io.StringIO())
    assert journal.trouble is not None
    assert (journal.trouble.code, journal.trouble.words) == ("log_not_kept", f"nothing is kept in {journal.path}: File exists")
    assert "what lies in its place" in journal.trouble.remedy
    (tmp_path / "logs").unlink()
    now_s += 1.0
    journal.settle()
    assert journal.trouble is None
    journal.close()


def test_a_log_that_can_be_kept_again_is_said(tmp_path: Path) -> None:
    (tmp_path / "logs").write_text("a file where the folder should be")
    console = io.StringIO()
    journal = Journal(tmp_path / "logs", console)
    journal.child_said("fusion", INFO)
    (tmp_path / "logs").unlink()
    journal.child_said("fusion", INFO)
    journal.close()
    assert without_time(console)[-1] == f"supervisor    what is said is kept in {journal.path} again"
    told, kept = entries_of(journal)
    assert (told["event"], told["lines"], kept["event"]) == ("lines of the log could not be kept", 1, "governor")
