"""What `kinebox` prints where it cannot be printed: on a full disk, a closed stream, a terminal that knows no umlauts."""

import csv
import io
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from services.lesson.lesson_file import LessonWriter
from services.logs.files import log_folder, log_path
from tests.installed import ROOT
from tests.integration.box import write_site
from tests.integration.test_report_command import log_of, recorded, said
from tests.ports import free_port
from tests.synthetic.gym import Gym
from tests.synthetic.gym_lesson import gym_header

pytestmark = pytest.mark.slow

COMMAND = (sys.executable, "-m", "services.cli.main")
FULL = Path("/dev/full")
FULL_LINE = b"kinebox: what was to be printed cannot be written: No space left on device; make room there, or print it elsewhere\n"
NO_UTF8 = {"LC_ALL": "C", "PYTHONCOERCECLOCALE": "0", "PYTHONUTF8": "0"}
"""As a terminal of old says it, and Python is told to believe it."""
ASCII = {"PYTHONIOENCODING": "ascii"}


@pytest.fixture(scope="module")
def gym(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a site, a log and lessons; one with what was said in it, and one with a name and a title beyond ASCII."""
    folder = tmp_path_factory.mktemp("gym")
    write_site(folder, free_port(), free_port())
    recorded(folder / "data" / "lessons", log_of(None, *said()))
    LessonWriter.create(folder / "data" / "lessons", "würfe-7b", gym_header(Gym(), title="Würfe 7b")).finish()
    log = log_path(log_folder(folder / "data"), 1)
    log.parent.mkdir()
    log.write_text('{"time":"2026-11-22T10:00:00.000000Z","process":"fusion","level":"info","event":"begun"}\n')
    return folder


def words(gym: Path, command: str) -> list[str]:
    return [*COMMAND, *command.format(data=gym / "data", site=gym / "site.toml").split()]


def kinebox(gym: Path, command: str, environment: dict[str, str]) -> "subprocess.CompletedProcess[bytes]":
    said = dict(os.environ) | environment
    return subprocess.run(words(gym, command), capture_output=True, cwd=ROOT, env=said, timeout=100, check=False)


@pytest.mark.parametrize(
    "command",
    [
        "--help",
        "lessons --data {data} --json",
        "report lesson --data {data} --format csv",
    ],
)
def test_a_full_disk_behind_what_is_printed_is_one_line_and_code_2(gym: Path, command: str) -> None:
    with FULL.open("wb") as full:
        ended = subprocess.run(words(gym, command), stdout=full, stderr=subprocess.PIPE, cwd=ROOT, timeout=100, check=False)
    assert (ended.returncode, ended.stderr) == (2, FULL_LINE)


def test_code_2_tells_of_a_full_disk_also_where_no_line_can(gym: Path) -> None:
    with FULL.open("wb") as full:
        ended = subprocess.run(words(gym, "version"), stdout=full, stderr=full, cwd=ROOT, timeout=100, check=False)
    assert ended.returncode == 2


@pytest.mark.parametrize("command", ["lessons --data {data}", "version"])
@pytest.mark.parametrize("closed", [">&-", ">&- 2>&-"])
def test_whoever_closes_a_stream_does_not_want_to_read_it(gym: Path, command: str, closed: str) -> None:
    shell = ["/bin/sh", "-c", f'"$@" {closed}', "sh", *words(gym, command)]
    ended = subprocess.run(shell, capture_output=True, cwd=ROOT, timeout=100, check=False)
    assert (ended.returncode, ended.stderr) == (0, b"")


def test_a_line_for_people_needs_nobody_who_reads_it(gym: Path) -> None:
    shell = ["/bin/sh", "-c", '"$@" 2>&-', "sh", *words(gym, "report nonsense --data {data}")]
    assert subprocess.run(shell, capture_output=True, cwd=ROOT, timeout=100, check=False).returncode == 2


@pytest.mark.parametrize("command", ["--help", "lessons --data {data}"])
def test_a_pipe_that_nobody_reads_ends_a_command_without_a_word(gym: Path, command: str) -> None:
    reading, writing = os.pipe()
    os.close(reading)
    ended = subprocess.run(words(gym, command), stdout=writing, stderr=subprocess.PIPE, cwd=ROOT, timeout=100, check=False)
    os.close(writing)
    assert (ended.returncode, ended.stderr) == (1, b"")


@pytest.mark.parametrize("environment", [NO_UTF8, ASCII])
def test_letters_that_a_terminal_cannot_show_are_written_out(gym: Path, environment: dict[str, str]) -> None:
    listed = kinebox(gym, "lessons --data {data}", environment)
    assert (listed.returncode, listed.stderr) == (0, b"")
    assert rb"W\xfcrfe 7b" in listed.stdout
    assert listed.stdout.isascii()


@pytest.mark.parametrize("environment", [NO_UTF8, {"PYTHONIOENCODING": "latin-1"}])
def test_a_list_for_programs_is_utf8_whatever_the_terminal_shows(gym: Path, environment: dict[str, str]) -> None:
    told = json.loads(kinebox(gym, "lessons --data {data} --json", environment).stdout.decode())
    assert "Würfe 7b" in {row["title"] for row in told}


def test_the_doctor_tells_programs_in_utf8_whatever_the_terminal_shows(gym: Path) -> None:
    gone = gym / "würfe"
    found = json.loads(kinebox(gym, f"doctor --data {gone} --json", ASCII).stdout.decode())
    assert str(gone) in " ".join(one["what"] for one in found["findings"])


def test_a_locale_that_knows_no_umlauts_keeps_no_lesson_from_being_read(gym: Path) -> None:
    lessons = gym / "data" / "lessons"
    (lessons / "2026-würfe.mcap").write_bytes((lessons / "lesson.mcap").read_bytes())
    told = kinebox(gym, "report 2026-würfe --data {data} --format csv", NO_UTF8)
    assert told.returncode == 0, told.stderr
    rows = list(csv.DictReader(io.StringIO(told.stdout.decode("utf-8-sig"))))
    assert [row["attempt"] for row in rows] == ["1", "2"]
    listed = kinebox(gym, "lessons --data {data}", NO_UTF8)
    assert b"not UTF-8" not in listed.stderr
