import io
import re
import time
from collections.abc import Iterator
from pathlib import Path

import msgspec
import pytest

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
    assert console.getvalue() == ""
    journal.child_said("edge-cam02", WARNING)
    assert console.getvalue() == "05:04:05  camera cam02  refused topic=gym/x\n"
    journal.close()
    assert journal.path.read_text().splitlines() == [INFO, WARNING]


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


@pytest.mark.parametrize("time", ['"noon"', "null", "7"])
def test_a_line_with_no_time_that_can_be_read_is_shown_all_the_same(tmp_path: Path, time: str) -> None:
    console = io.StringIO()
    journal = Journal(tmp_path, console)
    journal.child_said("fusion", f'{{"level": "error", "event": "lost", "time": {time}}}')
    journal.close()
    assert without_time(console) == ["?             lost"]


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
        (tmp_path / "logs" / "kinebox.log").mkdir(parents=True)
    console = io.StringIO()
    journal = Journal(tmp_path / "logs", console)
    journal.child_said("fusion", INFO)
    journal.say("still here")
    journal.close()
    lines = without_time(console)
    assert lines[0].startswith(f"supervisor    nothing is kept in {journal.path}: ")
    assert lines[1:] == ["fusion        governor rate_hz=15", "supervisor    still here"]
