"""What is printed to be copied works where it is pasted."""

import subprocess
import sys
from pathlib import Path

import pytest

from models.errors import UserError
from services.cli.user_error import exit_with_line
from services.support.called import as_called, called
from tests.installed import ROOT

FOR_TEACHERS = sorted(page for page in (ROOT / "docs").glob("*.md") if page.name != "architecture.md")
BESIDE_PYTHON = Path(sys.executable).parent


@pytest.mark.parametrize(
    ("program", "path", "typed"),
    [
        (".venv/bin/kinebox", "/usr/bin", ".venv/bin/kinebox"),
        ("/srv/gym box/.venv/bin/kinebox", "/usr/bin", "'/srv/gym box/.venv/bin/kinebox'"),
        (str(BESIDE_PYTHON / "kinebox"), str(BESIDE_PYTHON), "kinebox"),
        ("services/cli/main.py", "/usr/bin", "kinebox"),
    ],
    ids=["in the checkout", "from the root", "where the shell looks", "as a module"],
)
def test_a_command_begins_as_the_program_was_called(monkeypatch: pytest.MonkeyPatch, program: str, path: str, typed: str) -> None:
    monkeypatch.setattr(sys, "argv", [program, "record"])
    monkeypatch.setenv("PATH", path)
    assert called() == typed


def test_commands_in_quotes_can_be_copied_and_nothing_else_is_changed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", [".venv/bin/kinebox"])
    told = as_called("kinebox is 'KineBox'; see `kinebox doctor`, or 'kinebox record --stop' in kinebox logs")
    assert told == "kinebox is 'KineBox'; see `.venv/bin/kinebox doctor`, or '.venv/bin/kinebox record --stop' in kinebox logs"


def test_the_remedy_of_an_error_can_be_copied(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr(sys, "argv", [".venv/bin/kinebox"])
    with pytest.raises(SystemExit):
        exit_with_line(UserError("site.toml is of version 1; run 'kinebox config migrate site.toml', which keeps a backup"))
    assert "run '.venv/bin/kinebox config migrate site.toml'" in capsys.readouterr().err


def test_make_calls_the_program_as_whoever_ran_make_can() -> None:
    plan = subprocess.run(["make", "--dry-run", "run"], capture_output=True, text=True, cwd=ROOT, check=True)
    assert "exec .venv/bin/kinebox run " in plan.stdout


@pytest.mark.parametrize("page", FOR_TEACHERS, ids=lambda page: page.name)
def test_a_page_that_shows_commands_says_where_the_command_is(page: Path) -> None:
    text = page.read_text()
    assert ".venv/bin/kinebox" in text or not ("    kinebox " in text or "`kinebox " in text)
