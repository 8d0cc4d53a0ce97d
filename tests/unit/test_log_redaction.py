"""What leaves a box in an export of its log, and what does not."""

import datetime as dt
import json
import re
import tomllib
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import tomlkit
from hypothesis import given
from hypothesis import strategies as st

from services.logs.export import export
from services.logs.reader import Line
from services.logs.record import LogRecord, encode
from services.logs.redaction import redacted, redacted_remains, redacted_text
from tests.log_lines import NOON, TEXTS

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
        (f"got {b'AB' * 200 + bytes(range(128, 256))!r} instead", "got [915 characters] instead"),
        ('{"password": "hunter2', '{"password": [secret]'),
        ('{"password": "ab\\"cd ef", "rate": 3}', '{"password": [secret], "rate": 3}'),
        ('{"event": "got {\\"password\\": \\"hun ter2\\"}", "rate": 3}', '{"event": "got {\\"password\\": [secret]}", "rate": 3}'),
        ("Authorization: Basic aHVudGVyMg==\nAccept: */*", "Authorization: [secret]\nAccept: */*"),
        ("asked with Bearer hunter2 and refused", "asked with Bearer [secret] and refused"),
        ("apiToken=hunter2&rate=3 X-Api-Key: hunter2 API key: hunter2", "apiToken=[secret] X-Api-Key: [secret] API key: [secret]"),
        ("login(password=b'hunter 2', tokens=['hunter', '2'])", "login(password=[secret], tokens=[secret])"),
        (
            "rtspsrc location=rtsp://cam/1 user-id=admin user-pw=hunter2 !",
            "rtspsrc location=rtsp://cam/1 user-id=admin user-pw=[secret] !",
        ),
        ("cannot open rtsp://cam:554/?user=admin&pass=hunter2", "cannot open rtsp://cam:554/?user=admin&pass=[secret]"),
        ("http://cam/snapshot.cgi?usr=admin&pwd=hunter2 refused", "http://cam/snapshot.cgi?usr=admin&pwd=[secret] refused"),
        ("play --password hunter2 --token hunter2 --rate 3", "play --password [secret] --token [secret] --rate 3"),
        ("play --ask-password --token hunter2", "play --ask-password --token [secret]"),
        ("login of 'admin' using password 'hunter 2' failed", "login of 'admin' using password [secret] failed"),
        ('{"event": "password \\"hunter 2\\" is wrong"}', '{"event": "password [secret] is wrong"}'),
        ("the token ring: 3 pinned, compass: north", "the token ring: 3 pinned, compass: north"),
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


KEYS = st.sampled_from(["password", "wifi_password", "apiToken", "ACCESS_TOKEN", "X-Api-Key", "privateKey", "Credentials", "pin2"])
# What a password may have between its letters, spaces left out: without quotes nobody could tell where it ends.
PUNCTUATION = st.text(st.characters(min_codepoint=33, max_codepoint=126, exclude_categories=["L", "N"]), max_size=4)
WRITTEN: list[Callable[[str, str], str]] = [
    lambda key, secret: json.dumps({"a": 1, key: secret, "z": [3]}),
    lambda key, secret: json.dumps({"a": 1, key: secret, "z": [3]}, separators=(",", ":")),
    lambda key, secret: json.dumps({"event": json.dumps({key: secret})}),
    lambda key, secret: json.dumps({"event": json.dumps({"said": json.dumps({key: secret, "z": 3})}), "z": 3}),
    lambda key, secret: json.dumps({"deep": {key: [secret, secret], "z": 3}}),
    lambda key, secret: repr({"a": 1, key: secret, "z": 3}),
    lambda key, secret: repr({"a": 1, key: secret.encode(), "z": (3, secret)[:1]}),
    lambda key, secret: json.dumps({"event": f"called with { ({key: [secret]})!r}"}),
    lambda _, secret: f"GET / HTTP/1.1\nAuthorization: Digest {secret} {secret}\nHost: cam",
]


@given(KEYS, st.lists(PUNCTUATION, min_size=3, max_size=3), st.sampled_from(WRITTEN), TEXTS, st.data())
def test_no_secret_survives_wherever_it_stands_and_wherever_its_line_was_torn(
    key: str, marks: list[str], written: Callable[[str, str], str], said: str, data: st.DataObject
) -> None:
    """A secret has letters that nothing else has, and anything between; three of them in a row are too many."""
    secret = f"{marks[0]}QXJQZQXJ{marks[1]} QZXJQXZ{marks[2]}"
    line = written(key, secret)
    told = redacted_text(f"{said} {line}")
    assert not re.search("[QXJZ]{3}", told.replace(key, "")), told
    begin = data.draw(st.integers(0, len(line)))
    end = data.draw(st.integers(begin, len(line)))
    torn = redacted_remains(line[:end])
    assert not re.search("[QXJZ]{3}", torn), torn
    if line.startswith("{"):
        torn = redacted_remains(line[begin:end])
        assert not re.search("[QXJZ]{3}", torn) or line[begin:end].startswith("{"), torn


@given(KEYS, st.lists(PUNCTUATION, min_size=2, max_size=2))
def test_no_word_behind_the_name_of_a_secret_survives(key: str, marks: list[str]) -> None:
    secret = f"QXJ{marks[0].replace(chr(34), '').replace(chr(39), '')}QZX"
    for text in (f"{key}={secret} x", f"({key}: {secret})", f"bearer {secret}", f"rtsp://u:{secret}@cam/1"):
        assert not re.search("[QXJZ]{3}", redacted_text(text).removeprefix(key)), text


@pytest.mark.parametrize("torn", ["rtsp://admin:hunter2", '{"event": "cannot open rtsp://admin:123456'])
def test_an_address_that_was_torn_before_its_host_keeps_its_password(torn: str) -> None:
    assert not re.search("hunter2|123456", redacted_remains(torn))


@pytest.mark.parametrize(
    "keypoints",
    [
        [[612.5, 340.25]] * 12,
        [["nose", 612.5, 340.25, 0.9]] * 4,
        {"nose": [612.5, 340.25], **{f"joint_{i}": [612.5, 340.25] for i in range(8)}},
    ],
)
def test_nested_keypoints_in_the_fields_of_a_record_do_not_leave_the_box(keypoints: object) -> None:
    told = json.dumps(redacted({"camera": "a", "seen": keypoints, "sizes": [[640, 480], [320, 240]]}))
    assert "612" not in told
    assert "340" not in told
    assert json.loads(told)["sizes"] == [[640, 480], [320, 240]]


@pytest.mark.timeout(20)
@pytest.mark.parametrize(
    "said",
    [
        f"1{' ' * 20000}x",
        "1" * 20000,
        "1 " * 7 + "x",
        "1.1" * 7000,
        "://" * 7000,
        "token" * 4000,
        "1,;[" * 5000,
        "token=" * 5000,
        "token='" * 5000,
        "token: [" * 5000,
        '\\"' * 9000,
        "token '" * 4000,
        "--token " * 4000,
        f"--token{' ' * 20000}--",
    ],
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
