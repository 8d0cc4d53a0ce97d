"""What leaves a box in an export of its log, and what does not."""

import datetime as dt
import json
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest
import tomlkit
from hypothesis import given
from hypothesis import strategies as st

from services.logs.export import export
from services.logs.reader import Line
from services.logs.record import LogRecord, encode
from services.logs.redaction import redacted, redacted_text
from tests.log_lines import NOON

SITE = """
name = "School of the token ring"
wifi_password = "hunter2"
[[cameras]]
name = "a"
url = "rtsp://admin:hunter2@10.0.0.7:554/1?x=@y"
[cameras.login]
user = "admin"
api_tokens = ["hunter2"]
max_rate_hz = 15
"""


def test_a_site_file_keeps_its_values_but_no_secret() -> None:
    told = redacted(tomllib.loads(SITE))
    assert "hunter2" not in tomlkit.dumps(told)
    assert told["name"] == "School of the token ring"
    assert told["wifi_password"] == "[secret]"  # noqa: S105 - what stands in for one
    assert told["cameras"][0]["login"] == {"user": "admin", "api_tokens": "[secret]", "max_rate_hz": 15}
    assert told["cameras"][0]["url"].startswith("rtsp://[secret]@")


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("cannot open rtsp://admin:hun/ter2@10.0.0.7/1", "cannot open rtsp://[secret]@10.0.0.7/1"),
        ("cannot open rtsp://10.0.0.7:554/1", "cannot open rtsp://10.0.0.7:554/1"),
        ("PASSWORD: hunter2, user x", "PASSWORD: [secret], user x"),
        ("{'api_token': 'hunter 2'}", "{'api_token': [secret]}"),
        ("lost at 12:03:04.5 after 17 frames of 1920x1080", "lost at 12:03:04.5 after 17 frames of 1920x1080"),
        ("[1, 2, 3, 4, 5]", "[1, 2, 3, 4, 5]"),
        (f"got {'QUJD' * 100} instead", "got [400 characters] instead"),
    ],
)
def test_texts_keep_what_helps(said: str, told: str) -> None:
    assert redacted_text(said) == told


@given(
    st.lists(st.floats(-4000, 4000).map(lambda value: round(value, 3)), min_size=9, max_size=60).map(np.array)
    | st.integers(5, 20).map(lambda rows: np.linspace(1111.1, 2222.2, 2 * rows).reshape(rows, 2))
)
def test_keypoints_that_a_traceback_quotes_do_not_leave_the_box(keypoints: np.ndarray) -> None:
    for said in (repr(keypoints), str(keypoints), str(keypoints.tolist()), json.dumps(keypoints.tolist())):
        told = redacted_text(f"ValueError: {said} is wrong in frame 3")
        assert "numbers]" in told
        assert told.startswith("ValueError: ")
        assert told.endswith(" is wrong in frame 3")
        assert sum(character.isdigit() for character in told) <= 5


@pytest.mark.timeout(20)
@pytest.mark.parametrize(
    "said", [f"1{' ' * 20000}x", "1" * 20000, "1 " * 7 + "x", "1.1" * 7000, "://" * 7000, "token" * 4000, "1,;[" * 5000]
)
def test_no_text_holds_up_an_export(said: str) -> None:
    assert len(redacted_text(said)) <= len(said) + 20


def test_nothing_secret_is_in_any_part_of_an_export(tmp_path: Path) -> None:
    exception = "Traceback:\n  open('rtsp://u:hunter2@cam')\nValueError: " + repr(np.linspace(777.1, 778.9, 34))
    fields = {"password": "hunter2", "url": "http://x:hunter2@cam/", "path": ["token=hunter2"]}
    record = LogRecord(NOON, "edge-a", "error", "refused: password=hunter2", fields, exception)
    lines = [Line("f", 1, encode(record)[:-1], record), Line("f", 2, b'{"secret": "hunter2"', None)]
    file = tmp_path / "logs.zip"
    export(file, lines, tomlkit.dumps(redacted(tomllib.loads(SITE))), {}, dt.datetime.now(dt.UTC))
    with zipfile.ZipFile(file) as archive:
        everything = b"".join(archive.read(name) for name in archive.namelist())
        first, second = (json.loads(line) for line in archive.read("log.jsonl").splitlines())
    assert b"hunter2" not in everything
    assert b"777" not in everything
    assert (first["event"], first["level"], first["process"]) == ("refused: password=[secret]", "error", "edge-a")
    assert first["exception"].startswith("Traceback:\n")
    assert second["damaged"] == '{"secret": [secret]'
