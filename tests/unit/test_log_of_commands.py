"""What a command logs never stands in what it prints."""

import json
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import pytest
import structlog
from typer.testing import CliRunner

from services.cli.main import app
from services.lesson import index


@pytest.fixture(autouse=True)
def _log_as_before() -> Iterator[None]:
    yield
    structlog.reset_defaults()


@pytest.fixture
def older(tmp_path: Path) -> Path:
    """A data folder whose list of lessons is an older KineBox's."""
    lessons = tmp_path / "lessons"
    lessons.mkdir()
    with sqlite3.connect(lessons / index.NAME) as connection:
        connection.execute("CREATE TABLE lessons (otherwise TEXT)")
        connection.execute("PRAGMA user_version = 3")
    connection.close()
    return tmp_path


def test_json_of_the_lessons_is_json_where_their_list_is_made_anew(older: Path) -> None:
    done = CliRunner().invoke(app, ["lessons", "--json", "--data", str(older)])
    assert json.loads(done.stdout) == []
    assert done.stderr.startswith("note: the list of lessons is made anew")


def test_a_list_that_is_made_anew_is_told_in_one_plain_line(older: Path) -> None:
    told = CliRunner().invoke(app, ["lessons", "--data", str(older)]).stderr
    reason = "reason: it was of version 3, and this KineBox writes 4"
    assert told == f"note: the list of lessons is made anew (folder: {older / 'lessons'}, {reason})\n"


def test_a_lesson_that_is_removed_tells_of_its_list_beside_what_is_printed(older: Path) -> None:
    (older / "lessons/a.mcap").write_bytes(b"nothing")
    done = CliRunner().invoke(app, ["lessons", "delete", "a", "--yes", "--data", str(older)])
    assert done.stdout.startswith("removed ")
    assert "note: the list of lessons is made anew" in done.stderr
