import io
from pathlib import Path

import msgspec
import pytest

from services.supervisor.journal import Journal


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


class GoneConsole(io.StringIO):
    def write(self, _text: str) -> int:
        raise BrokenPipeError


INFO = '{"process": "fusion", "level": "info", "event": "governor", "rate_hz": 15}'
WARNING = '{"process": "fusion", "level": "warning", "event": "message refused", "topic": "gym/x"}'


def test_a_person_at_a_terminal_is_not_bothered_with_information(tmp_path: Path) -> None:
    console = Terminal()
    journal = Journal(tmp_path, console)
    journal.child_said("fusion", INFO)
    assert console.getvalue() == ""
    journal.child_said("fusion", WARNING)
    assert console.getvalue() == "fusion: message refused topic=gym/x\n"
    journal.close()
    assert journal.path.read_text().splitlines() == [INFO, WARNING]


def test_a_service_manager_gets_every_line_as_it_is(tmp_path: Path) -> None:
    console = io.StringIO()
    journal = Journal(tmp_path, console)
    journal.child_said("fusion", INFO)
    journal.child_said("edge-a", "kinebox: camera 'a': film.avi is missing")
    journal.say("ended")
    journal.close()
    entries = [msgspec.json.decode(line) for line in console.getvalue().splitlines()]
    assert [(entry["process"], entry["level"], entry["event"]) for entry in entries] == [
        ("fusion", "info", "governor"),
        ("edge-a", "error", "camera 'a': film.avi is missing"),
        ("supervisor", "info", "ended"),
    ]
    assert journal.path.read_text() == console.getvalue()


@pytest.mark.parametrize("line", ["{not json", '["a list"]', "Traceback (most recent call last):", "\ufffd\ufffd"])
def test_a_line_that_is_no_log_entry_is_kept_as_an_error(tmp_path: Path, line: str) -> None:
    console = Terminal()
    journal = Journal(tmp_path, console)
    journal.child_said("edge-a", line)
    journal.close()
    assert console.getvalue() == f"edge-a: {line}\n"
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
    events = [msgspec.json.decode(line)["event"] for line in console.getvalue().splitlines()]
    assert events[0].startswith(f"nothing is kept in {journal.path}: ")
    assert events[1:] == ["governor", "still here"]
