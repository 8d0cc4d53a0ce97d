"""A defect in the supervisor itself: whoever gets the log sees what it was."""

import io
import sys
from collections.abc import Callable
from pathlib import Path
from threading import Event

import pytest

from models.errors import UserError
from services.logs.files import log_folder
from services.logs.reader import LogReader
from services.logs.record import LogRecord
from services.site_file.reading import read_site
from services.supervisor import supervise as module
from services.supervisor.supervise import Supervisor, supervise
from tests.installed import ROOT


def log_of(run: Callable[[object, Event], None], data: Path, monkeypatch: pytest.MonkeyPatch) -> list[LogRecord]:
    """What the log has of a supervisor whose `run` ends with an exception."""
    monkeypatch.setattr(module, "check_everything", lambda site_file, _data, _checks: read_site(site_file))
    monkeypatch.setattr(module, "stop_on_signals", Event)
    monkeypatch.setattr(Supervisor, "run", run)
    monkeypatch.setattr(sys, "stderr", io.StringIO())
    with pytest.raises((LookupError, UserError)):
        supervise(ROOT / "deploy/sites/footage/site.toml", data, [])
    reader = LogReader(log_folder(data))
    records = [line.record for line in reader.poll()]
    reader.close()
    return [record for record in records if record is not None]


def test_what_ended_the_supervisor_is_in_the_log_with_its_traceback(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def breaks(_supervisor: object, _stop: Event) -> None:
        raise LookupError("no such process")

    last = log_of(breaks, tmp_path, monkeypatch)[-1]
    assert (last.process, last.level) == ("supervisor", "critical")
    assert last.event == "the supervisor ended by a defect: LookupError: no such process"
    assert last.exception.startswith("Traceback")
    assert "in breaks" in last.exception


def test_what_a_person_must_do_is_no_defect(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuses(_supervisor: object, _stop: Event) -> None:
        raise UserError("the lesson is empty; name another")

    assert not [record for record in log_of(refuses, tmp_path, monkeypatch) if record.exception]
