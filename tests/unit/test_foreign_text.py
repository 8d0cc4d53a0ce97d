"""Text that somebody else wrote does nothing to the terminal of who reads it: it is shown, not obeyed."""

import json
from pathlib import Path

import pytest

from models.config.site import TabletConfig
from models.errors import USER_ERROR_CODE, UserError
from services.cli import check_lesson, config, lessons
from services.cli.user_error import exit_with_line
from services.lesson import origin
from services.lesson.index import LessonIndex, LessonRow
from services.supervisor.page import welcome
from tests.integration.box import write_site

EVIL = "Turnen\x1b]0;owned\x07\x1b[2J\nin \x9b31mred\u202e"
SHOWN = r"Turnen\x1b]0;owned\x07\x1b[2J\nin \x9b31mred\u202e"


def assert_harmless(text: str, lines: int) -> None:
    assert SHOWN in text
    assert all(each.isprintable() for each in text.split("\n")), ascii(text)
    assert len(text.rstrip("\n").split("\n")) == lines


@pytest.mark.parametrize("field", ["title", "file", "problem"])
def test_the_list_of_lessons_keeps_its_lines(
    field: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    row = LessonRow("2026-11-22T100000.mcap", "", 0.0, 60.0, 1_000_000, 0, 1, "finished", "", 0)
    evil = LessonRow(**{name: getattr(row, name) for name in LessonRow.__annotations__} | {field: EVIL})
    monkeypatch.setattr(LessonIndex, "lessons", lambda _index: [row, evil])
    lessons.listed(tmp_path, json=False)
    output, errors = capsys.readouterr()
    if field == "problem":
        assert_harmless(errors, 1)
    else:
        assert_harmless(output, 3)
    lessons.listed(tmp_path, json=True)
    # Programs get what was written.
    assert json.loads(capsys.readouterr().out)[1][field].endswith(EVIL)


def test_the_welcome_keeps_its_lines() -> None:
    page = TabletConfig(host="127.0.0.1")
    assert_harmless(welcome(EVIL, page).lstrip("\n"), welcome("Gym", page).lstrip("\n").rstrip("\n").count("\n") + 1)


def test_a_good_site_is_named_in_one_line(tmp_path: Path) -> None:
    site = write_site(tmp_path, 8080, 7447)
    site.write_text(site.read_text().replace('"Test gym"', json.dumps(EVIL)))
    assert_harmless(config.check(site), 1)


def test_an_error_stays_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        exit_with_line(UserError(f"lesson '{EVIL.replace(chr(10), '')}' is damaged; copy it again"))
    assert end.value.code == USER_ERROR_CODE
    errors = capsys.readouterr().err
    assert SHOWN.replace(r"\n", "") in errors
    assert errors[:-1].isprintable()


def test_what_was_different_when_a_lesson_was_recorded_is_one_line_each(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(origin, "machine", lambda: "here")

    class Header:
        kinebox = EVIL
        machine = EVIL

    lines = check_lesson.what_changed(Header())  # type: ignore[arg-type]
    assert len(lines) == 2
    assert all(line.isprintable() and SHOWN in line for line in lines)
