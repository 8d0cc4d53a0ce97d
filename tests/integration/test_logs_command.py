"""`kinebox logs` as people type it, on the log of a box and on one that is being written."""

import datetime as dt
import hashlib
import json
import os
import pty
import re
import signal
import subprocess
import sys
import tomllib
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import psutil
import pytest

from models.config.site import SITE_VERSION
from services.logs.files import STARTED, log_folder, log_numbers, log_path
from services.logs.record import LogRecord
from services.logs.writer import LogWriter
from tests.integration.box import ROOT, Box
from tests.integration.waiting import until
from tests.log_lines import numbered

pytestmark = pytest.mark.slow

KINEBOX = [sys.executable, "-m", "services.cli.main"]
ENVIRONMENT = dict(os.environ) | {"TZ": "XXX-2", "COLUMNS": "200"}


def kinebox_logs(data: Path, *words: str) -> "subprocess.CompletedProcess[str]":
    command = [*KINEBOX, "logs", *words, "--data", str(data)]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, env=ENVIRONMENT, timeout=60, check=False)


def record(process: str, level: str, event: str, **more: object) -> LogRecord:
    exception = str(more.pop("exception", ""))
    return LogRecord(dt.datetime.now(dt.UTC), process, level, event, more, exception)


GIVEN_UP = "edge-cam03 is given up: hung"


@pytest.fixture
def data(tmp_path: Path) -> Path:
    """A folder with a log of two files."""
    writer = LogWriter(tmp_path / "logs", 20_000, 5)
    old = dt.datetime(2026, 1, 2, 3, 4, 5, 678000, tzinfo=dt.UTC)
    writer.write(LogRecord(old, "fusion", "info", "governor", {"rate_hz": 15}))
    for number in range(180):
        writer.write(numbered(number))
    writer.write(record("supervisor", "error", GIVEN_UP))
    writer.write(record("edge-cam01", "warning", "no picture", camera="cam01"))
    writer.write(record("edge-cam02", "critical", "RuntimeError: broken", exception="Traceback:\n  in f\nRuntimeError: broken"))
    writer.close()
    return tmp_path


def test_people_see_aligned_lines_in_their_own_time(data: Path) -> None:
    first, *_, warning, critical, trace, within, end = kinebox_logs(data, "-n", "1000").stdout.splitlines()
    assert first == "2026-01-02 05:04:05.678  info      fusion        governor rate_hz=15"
    assert re.fullmatch(r"\S{10} \S{12}  warning   edge-cam01    no picture camera=cam01", warning)
    assert re.fullmatch(r"\S{10} \S{12}  critical  edge-cam02    RuntimeError: broken", critical)
    assert (trace, within, end) == ("    Traceback:", "      in f", "    RuntimeError: broken")


@pytest.mark.parametrize(
    ("words", "events"),
    [
        (("--level", "Warning"), [GIVEN_UP, "no picture", "RuntimeError: broken"]),
        (("--process", "edge"), [GIVEN_UP, "no picture", "RuntimeError: broken"]),
        (("--process", "edge-cam01"), ["no picture"]),
        (("--process", "edge-cam01", "--process", "fusion", "--grep", "CAM01"), ["no picture"]),
        (("--process", "edge-cam03"), [GIVEN_UP]),
        (("--process", "edge-cam0"), []),
        (("--process", "supervisor"), [GIVEN_UP]),
        (("--grep", "rate_hz=15"), ["governor"]),
        (("--since", "10m"), [GIVEN_UP, "no picture", "RuntimeError: broken"]),
        (("--since", "2026-01-02T05:04:05", "-n", "1000", "--grep", "governor"), ["governor"]),
        (("--since", "2026-01-02T05:04:06", "-n", "1000", "--grep", "governor"), []),
        (("-n", "1"), ["RuntimeError: broken"]),
        (("-n", "0"), []),
    ],
)
def test_lines_are_chosen_by_options(data: Path, words: tuple[str, ...], events: list[str]) -> None:
    said = [json.loads(line) for line in kinebox_logs(data, "--json", *words).stdout.splitlines()]
    assert [each["event"] for each in said if each["event"] != "counted"] == events


def test_a_filter_that_finds_nothing_says_so_beside_what_is_printed(data: Path) -> None:
    result = kinebox_logs(data, "--grep", "no such words")
    assert (result.returncode, result.stdout) == (0, "")
    assert result.stderr == f"no line of the log in {data / 'logs'} matches\n"


def test_a_process_that_there_is_not_is_told_with_those_that_there_are(data: Path) -> None:
    result = kinebox_logs(data, "--process", "nobody")
    assert (result.returncode, result.stdout) == (0, "")
    there = "edge-cam01, edge-cam02, fusion, supervisor"
    assert result.stderr == f"no line of the log in {data / 'logs'} matches; the processes with lines in it are {there}\n"


def test_no_zip_is_written_of_a_process_that_there_is_not(data: Path) -> None:
    result = kinebox_logs(data, "export", str(data / "nobody.zip"), "--process", "nobody")
    assert (result.returncode, result.stdout) == (2, "")
    there = "edge-cam01, edge-cam02, fusion, supervisor"
    assert result.stderr.startswith("kinebox: nothing is packed: no line of the log in ")
    assert result.stderr.endswith(f" matches; the processes with lines in it are {there}\n")
    assert not (data / "nobody.zip").exists()


def test_two_hundred_lines_are_shown_if_nobody_asks_for_more(data: Path) -> None:
    log_path(data / "logs", 1).write_bytes(b"damaged once\n" * 300)
    lines = kinebox_logs(data).stdout.splitlines()
    assert sum(not line.startswith("    ") for line in lines) == 200


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--since", "yesterday"), "--since: 'yesterday' is no time; write 90s, 10m or 1h30m, or a date and time"),
        (("--since", "99999999999999999999s"), "--since: '99999999999999999999s' is no"),
        (("--level", "loud"), "--level: 'loud' is no level; write one of debug, info, warning, error, critical"),
        (("--data", "/nowhere"), "there is no log in "),
    ],
)
def test_what_makes_no_sense_is_one_line_and_code_2(tmp_path: Path, words: tuple[str, ...], line: str) -> None:
    result = kinebox_logs(tmp_path, *words)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.startswith(f"kinebox: {line}")
    assert result.stderr.count("\n") == 1


def test_the_log_of_replays_is_shown_and_packed_if_asked_for(data: Path) -> None:
    none = kinebox_logs(data, "--replay")
    assert none.returncode == 2
    assert none.stderr.startswith(f"kinebox: there is no log in {data / 'logs' / 'replay'}; 'kinebox replay' writes it there")
    writer = LogWriter(log_folder(data, replay=True), 20_000, 5)
    writer.write(record("replay", "info", "the lesson is over"))
    writer.close()
    assert kinebox_logs(data, "--replay", "--json").stdout.count("the lesson is over") == 1
    assert "the lesson is over" not in kinebox_logs(data).stdout
    packed = kinebox_logs(data, "export", str(data / "replay.zip"), "--replay")
    assert packed.stdout.startswith(f"{data / 'replay.zip'} holds 1 lines and no site file")


def test_a_log_that_cannot_be_read_is_one_line_with_what_to_do(data: Path) -> None:
    file = log_path(data / "logs", log_numbers(data / "logs")[-1])
    file.unlink()
    file.mkdir()
    shown = kinebox_logs(data)
    assert shown.returncode == 2
    assert f"cannot be read: Is a directory ({data}/logs); correct its owner and rights, or mend its disk" in shown.stderr
    assert "Traceback" not in shown.stderr


def test_damaged_lines_are_shown_as_such(data: Path) -> None:
    with log_path(data / "logs", 2).open("ab") as file:
        file.write(b'{"time": "half a li\x00\xff\n{"torn')
    *_, half, torn = kinebox_logs(data).stdout.splitlines()
    assert re.fullmatch(r'kinebox-000002\.log:\d+ +  damaged   \{"time": "half a li\\x00\\xff', half)
    assert torn.endswith('damaged   {"torn')
    assert json.loads(kinebox_logs(data, "--json").stdout.splitlines()[-1])["damaged"] == '{"torn'


def test_a_reader_that_goes_away_is_no_error(data: Path) -> None:
    command = f"{' '.join(KINEBOX)} logs -n 1000 --data {data} | head -1"
    result = subprocess.run(["bash", "-c", command], capture_output=True, text=True, cwd=ROOT, timeout=60, check=True)
    assert "governor" in result.stdout
    assert result.stderr == ""


def test_colours_are_for_terminals_only(data: Path) -> None:
    assert "\x1b" not in kinebox_logs(data).stdout
    ours, theirs = pty.openpty()
    with subprocess.Popen(
        [*KINEBOX, "logs", "-n", "2", "--data", str(data)], cwd=ROOT, stdout=theirs, env=ENVIRONMENT | {"TERM": "xterm"}
    ):
        os.close(theirs)
        shown = b""
        try:
            while chunk := os.read(ours, 4096):
                shown += chunk
        except OSError:  # Linux says so when the other end is closed.
            pass
    os.close(ours)
    assert b"\x1b[33mwarning \x1b[0m" in shown


@contextmanager
def following(data: Path, output: Path, *words: str) -> "Iterator[subprocess.Popen[bytes]]":
    with output.open("wb") as stream:
        process = subprocess.Popen([*KINEBOX, "logs", "--follow", *words, "--data", str(data)], cwd=ROOT, stdout=stream)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def test_following_shows_every_line_over_new_files_until_ctrl_c(data: Path, tmp_path: Path) -> None:
    output = tmp_path / "output"
    with following(data, output, "--json", "-n", "1") as process:
        until(lambda: output.read_bytes().count(b"\n") == 1, "the last line")
        writer = LogWriter(data / "logs", 2000, 1000)
        for number in range(500):
            writer.write(numbered(number, 60))
        writer.close()
        until(lambda: output.read_bytes().count(b"\n") >= 501, "all lines")
        process.send_signal(signal.SIGINT)
        assert process.wait(30.0) == 0
    assert [json.loads(line)["number"] for line in output.read_bytes().splitlines()[1:]] == list(range(500))


def test_the_log_of_a_box_with_a_crash_can_be_looked_at_and_sent(tmp_path: Path) -> None:
    more = "# the password is hunter2\n[logs]\nmax_files = 3\n"
    with Box(tmp_path, {"edge-a": "noise", "edge-b": "crash"}, f"[supervisor]\nmax_restarts = 0\n{more}") as box:
        until(lambda: "edge-b is given up" in box.errors.read_text(), "edge-b to be given up")
        # While it runs, so that reading disturbs no writing.
        crash = kinebox_logs(box.data, "--process", "edge-b", "--json").stdout.splitlines()
        assert box.end() == 0
    records = [json.loads(line) for line in crash]
    (said,) = (each for each in records if each["process"] == "edge-b")
    assert any("edge-b is given up" in each["event"] for each in records if each["process"] == "supervisor")
    assert {each["process"] for each in records} == {"edge-b", "supervisor"}
    assert (said["level"], said["event"]) == ("critical", "RuntimeError: crashed as ordered")
    assert said["exception"].startswith("Traceback (most recent call last):\n")
    assert list(said) == ["time", "process", "level", "event", "exception"]

    zipped = tmp_path / "for-the-coach.zip"
    result = kinebox_logs(box.data, "export", str(zipped))
    assert result.returncode == 0, result.stderr
    assert str(box.site) in result.stdout
    with zipfile.ZipFile(zipped) as archive:
        assert archive.testzip() is None
        assert {member.date_time[0] for member in archive.infolist()} == {dt.datetime.now().astimezone().year}
        assert {member.compress_type for member in archive.infolist()} == {zipfile.ZIP_DEFLATED}
        contents = {name: archive.read(name) for name in archive.namelist()}
    assert sorted(contents) == ["log.jsonl", "manifest.json", "site.toml"]
    manifest = json.loads(contents["manifest.json"])
    lines = [json.loads(line) for line in contents["log.jsonl"].splitlines()]
    assert manifest["lines"]["count"] == len(lines)
    assert (manifest["lines"]["first"], manifest["lines"]["last"]) == (lines[0]["time"], lines[-1]["time"])
    assert lines[0]["event"] == STARTED
    assert any("crashed as ordered" in line.get("exception", "") for line in lines)
    assert manifest["sha256"] == {name: hashlib.sha256(contents[name]).hexdigest() for name in ("log.jsonl", "site.toml")}
    assert manifest["versions"].keys() >= {"kinebox", "python", "numpy", "onnxruntime", "eclipse-zenoh", "typer"}
    assert manifest["versions"]["site_schema"] == str(SITE_VERSION)
    assert manifest["machine"].keys() >= {"system", "cores", "memory_mb"}
    assert manifest["machine"]["memory_mb"] == psutil.virtual_memory().total // 1_000_000, "MB, not MiB"
    assert tomllib.loads(contents["site.toml"].decode()) == tomllib.loads(box.site.read_text())
    assert not any(b"hunter2" in content for content in contents.values())

    again = kinebox_logs(box.data, "export", str(zipped))
    assert (again.returncode, again.stderr) == (2, f"kinebox: {zipped} exists already; choose another name or delete it\n")
    chosen = tmp_path / "chosen.zip"
    assert kinebox_logs(box.data, "export", str(chosen), "--level", "critical", "--site", str(box.site)).returncode == 0
    with zipfile.ZipFile(chosen) as archive:
        assert len(archive.read("log.jsonl").splitlines()) == 1
        assert json.loads(archive.read("manifest.json"))["query"]["level"] == "critical"
    assert not list(tmp_path.glob(".*.tmp"))
