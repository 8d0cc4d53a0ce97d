"""What `kinebox --help` says of each command."""

import pytest
from typer.testing import CliRunner

from services.cli.main import app


@pytest.mark.parametrize("words", [(), ("lessons",), ("logs",), ("config",), ("standard",)], ids=" ".join)
def test_no_summary_of_a_command_is_cut_off(words: tuple[str, ...]) -> None:
    told = CliRunner().invoke(app, [*words, "--help"], env={"COLUMNS": "100"}).stdout
    _, summaries = told.split("Commands:")
    assert [line for line in summaries.splitlines() if line.endswith("...")] == []


WITH_DATA = (
    "run; process; doctor; record; replay; export; report; simulate; lessons; lessons delete; logs; logs export; "
    "standard list; standard record; standard import; standard restore"
)


def test_the_data_folder_is_the_same_thing_to_every_command() -> None:
    told = set()
    for words in WITH_DATA.split("; "):
        page = " ".join(CliRunner().invoke(app, [*words.split(), "--help"]).stdout.split())
        told.add(page.partition("--data ")[2].partition(" [default: build]")[0])
    assert told == {"<dir> The data folder: networks, footage, lessons, the log and the school's own standards."}
