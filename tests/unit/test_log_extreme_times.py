"""Lines of the log at the ends of the calendar, where the hours of a time zone lead out of it."""

import io
import json
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from services.logs.past import wanted_lines
from services.logs.query import Query
from services.logs.readable import readable
from services.supervisor.journal import Journal

EXTREMES = ["9999-12-31T23:59:59Z", "0001-01-01T00:00:00Z"]


@pytest.fixture(params=["UTC", "Pacific/Kiritimati", "America/Los_Angeles"])
def zone(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    monkeypatch.setenv("TZ", request.param)
    time.tzset()
    yield request.param
    monkeypatch.undo()
    time.tzset()


def line(when: str) -> str:
    return json.dumps({"time": when, "process": "fusion", "level": "error", "event": "a clock was wrong"})


@pytest.mark.usefixtures("zone")
@pytest.mark.parametrize("when", EXTREMES)
def test_such_a_line_is_shown(when: str, tmp_path: Path) -> None:
    (tmp_path / "kinebox-000001.log").write_text(line(when) + "\n")
    (shown,) = wanted_lines(tmp_path, Query())
    text = readable(shown, colour=False)
    assert text.endswith("error     fusion        a clock was wrong")
    assert len(text.split("  ")[0]) == len("2026-11-22 12:00:00.000")


@pytest.mark.usefixtures("zone")
@pytest.mark.parametrize("when", EXTREMES)
def test_a_process_that_says_such_a_time_ends_no_box(when: str, tmp_path: Path) -> None:
    console = io.StringIO()
    journal = Journal(tmp_path, console)
    journal.child_said("fusion", line(when))
    journal.close()
    assert "a clock was wrong" in console.getvalue()


@pytest.mark.parametrize("zone", ["America/Los_Angeles"], indirect=True)
def test_other_times_are_those_of_the_zone(zone: str, tmp_path: Path) -> None:
    assert zone
    (tmp_path / "kinebox-000001.log").write_text(line("2026-11-22T12:00:00Z") + "\n")
    (shown,) = wanted_lines(tmp_path, Query())
    assert readable(shown, colour=False).startswith("2026-11-22 04:00:00.000  ")
