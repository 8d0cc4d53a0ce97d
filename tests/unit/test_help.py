"""What `kinebox --help` says of each command."""

import pytest
from typer.testing import CliRunner

from services.cli.main import app


@pytest.mark.parametrize("words", [(), ("lessons",), ("logs",), ("config",), ("standard",)], ids=" ".join)
def test_no_summary_of_a_command_is_cut_off(words: tuple[str, ...]) -> None:
    told = CliRunner().invoke(app, [*words, "--help"], env={"COLUMNS": "100"}).stdout
    _, summaries = told.split("Commands:")
    assert [line for line in summaries.splitlines() if line.endswith("...")] == []
