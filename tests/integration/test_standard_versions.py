"""`kinebox standard list` and `restore`: every version is listed and can count again, and what cannot is one line."""

import shutil
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import pytest
from typer.testing import CliRunner

from models.errors import UserError
from models.teaching.standard import encode
from services.cli import standards
from services.cli.new_standards import Import, Record, bring_in, record
from services.cli.standard_commands import standard_app
from services.cli.standards import restore
from services.support.own_standards import OwnStandards
from tests.installed import ROOT
from tests.integration.school import SITE, counting, holds, lesson_of, record_refused
from tests.taught import shipped


def put(data: Path, *origins: str) -> OwnStandards:
    """Squats that count one after the other, known by their origins."""
    data.mkdir(parents=True, exist_ok=True)
    own = OwnStandards(data / "school")
    for origin in origins:
        own.put(replace(shipped().standards["squat"], origin=origin))
    return own


def squats(data: Path, capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    """As they are listed."""
    capsys.readouterr()
    standards.listed(data, None, json=True)
    return [row for row in msgspec.json.decode(capsys.readouterr().out) if row["action"] == "squat"]


@pytest.mark.slow
def test_every_version_is_listed_and_can_count_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lesson, _ = lesson_of(tmp_path, "squat")
    for _ in range(3):
        record(lesson, tmp_path, None, Record(1))
    assert counting(tmp_path, "squat").version == 4
    restore("squat", None, tmp_path, None)
    assert counting(tmp_path, "squat").version == 3
    restore("squat", None, tmp_path, None)
    assert counting(tmp_path, "squat").version == 2
    restore("squat", None, tmp_path, None)
    assert counting(tmp_path, "squat").version == 1
    restore("squat", "4", tmp_path, None)
    assert counting(tmp_path, "squat").version == 4
    restore("squat", "shipped", tmp_path, None)
    restore("squat", "3", tmp_path, None)
    rows = squats(tmp_path, capsys)
    assert [(row["version"], row["counts"], row["whose"]) for row in rows] == [
        (3, True, "own"),
        (4, False, "own"),
        (2, False, "own"),
        (1, False, "shipped"),
    ]
    assert all(row["seconds"] > 1 and row["stature_m"] > 1 and row["origin"] for row in rows)
    standards.listed(tmp_path, None, json=False)
    lines = [line.split() for line in capsys.readouterr().out.splitlines() if line.startswith("squat ")]
    assert [line[1] for line in lines] == ["3", "4", "2", "1"]
    assert [line[2] for line in lines] == ["yes", "own", "own", "shipped"]


@pytest.mark.slow
def test_the_list_fits_on_a_page_without_trailing_blanks_and_names_no_part_of_the_code(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lesson, _ = lesson_of(tmp_path, "badminton_clear")
    record(lesson, tmp_path, None, Record(1))
    put(tmp_path, "imported from a C3D file on 2026-11-20")
    capsys.readouterr()
    standards.listed(tmp_path, None, json=False)
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 100
    assert [line for line in lines if line != line.rstrip()] == []
    assert "models." not in "".join(lines)


def test_without_a_number_the_next_lower_one_comes_back_and_that_is_what_is_promised(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    put(tmp_path, "by a pupil")
    restore("squat", "shipped", tmp_path, None)
    put(tmp_path, "of another school")
    restore("squat", None, tmp_path, None)
    assert "squat: version 2 counts again (by a pupil)" in capsys.readouterr().out
    told = CliRunner().invoke(standard_app, ["restore", "--help"], env={"COLUMNS": "200"}).stdout
    assert "if left out, the next lower number than counts now" in " ".join(told.split())
    assert "# the next lower number;" in (ROOT / "docs" / "teaching.md").read_text(encoding="utf-8")


def with_a_copied_one(data: Path) -> OwnStandards:
    """Of two of the school's own the second counted, and somebody copied a file of another school over it: its version 2."""
    own = put(data, "ours", "ours, too")
    theirs = put(data / "theirs", "of another school")
    assert theirs.counts("squat").version == 2
    shutil.copy(theirs.file("squat"), own.file("squat"))
    return own


def test_what_was_kept_can_count_again_though_a_copied_file_has_its_number(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with_a_copied_one(tmp_path)
    rows = squats(tmp_path, capsys)
    found = [(row["version"], row["counts"], row["origin"]) for row in rows[:2]]
    assert found == [(2, True, "of another school"), (2, False, "ours")]
    restore("squat", "2", tmp_path, None)
    assert "squat: version 2 counts again (ours)" in capsys.readouterr().out
    assert counting(tmp_path, "squat").origin == "ours"
    rows = squats(tmp_path, capsys)
    assert [(row["counts"], row["origin"]) for row in rows[:2]] == [(True, "ours"), (False, "of another school")]
    assert len({row["version"] for row in rows[:2]}) == 2, "the copied one got a number of its own"
    restore("squat", str(rows[1]["version"]), tmp_path, None)
    assert counting(tmp_path, "squat").origin == "of another school"


def test_a_new_one_in_the_place_of_a_copied_file_says_by_which_number_and_options_that_one_comes_back(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    data = tmp_path / "two words"
    own = with_a_copied_one(data)
    new = put(tmp_path / "new", "new").file("squat")
    bring_in(new, data, None, Import("squat"))
    told = capsys.readouterr().out.splitlines()[3]
    assert told == f"bring back what counted before (of another school): kinebox standard restore squat 3 --data '{data}'"
    restore("squat", "3", data, None)
    assert own.counts("squat").origin == "of another school"


def test_what_is_said_to_bring_a_standard_back_names_the_site_file_by_which_it_was_kept(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    site = tmp_path / "site.toml"
    shutil.copy(SITE.parent / "rig.toml", tmp_path)
    (tmp_path / "elsewhere").mkdir()
    site.write_text(SITE.read_text() + '\n[evaluation]\nteaching = "elsewhere"\n')
    new = put(tmp_path / "new", "new").file("squat")
    bring_in(new, tmp_path, site, Import("squat"))
    told = capsys.readouterr().out.splitlines()[3]
    assert told.endswith(f": kinebox standard restore squat shipped --data {tmp_path} --site {site}")


def test_the_one_before_a_copied_file_is_the_newest_that_is_kept(tmp_path: Path) -> None:
    with_a_copied_one(tmp_path)
    restore("squat", None, tmp_path, None)
    assert counting(tmp_path, "squat").origin == "ours"


def test_the_very_one_that_counts_is_listed_once_and_counts_already(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    put(tmp_path, "a", "b")
    restore("squat", "2", tmp_path, None)
    assert [row["origin"] for row in squats(tmp_path, capsys)[:2]] == ["a", "b"]
    restore("squat", "2", tmp_path, None)
    assert "version 2 counts already; nothing was changed" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("version", "told"),
    [
        ("7", "'squat' has no version '7'; there are 2, 3, shipped"),
        ("last", "'squat' has no version 'last'; there are 2, 3, shipped"),
        ("-1", "'squat' has no version '-1'; there are 2, 3, shipped"),
        ("٣", "'squat' has no version '٣'; there are 2, 3, shipped"),
    ],
)
def test_a_version_that_there_is_not_is_refused(tmp_path: Path, version: str, told: str) -> None:
    put(tmp_path, "a", "b")
    before = holds(tmp_path)
    with pytest.raises(UserError) as caught:
        restore("squat", version, tmp_path, None)
    assert str(caught.value) == told
    assert holds(tmp_path) == before


def test_where_nothing_is_to_be_brought_back_that_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(UserError, match="KineBox's own standard counts already; no other is kept"):
        restore("squat", None, tmp_path, None)
    with pytest.raises(UserError, match="there is no action 'handstand'; there are: badminton_clear"):
        restore("handstand", None, tmp_path, None)
    restore("squat", "shipped", tmp_path, None)
    assert "KineBox's own standard counts already; nothing was changed" in capsys.readouterr().out
    with pytest.raises(UserError, match="there is no data folder"):
        restore("squat", None, tmp_path / "nowhere", None)
    assert holds(tmp_path) == {}


def test_a_damaged_standard_is_listed_as_that_and_can_be_replaced(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lesson, _ = lesson_of(tmp_path, "squat")
    own = put(tmp_path, "a", "b")
    own.file("squat").write_bytes(b"damaged")
    assert "squat.npz: is no standard's file, or is damaged" in record_refused(tmp_path, lesson, Record(1))
    capsys.readouterr()
    standards.listed(tmp_path, None, json=False)
    listed = capsys.readouterr()
    assert "cannot be read" in listed.out
    assert listed.err.count("squat.npz: is no standard's file") == 1
    restore("squat", None, tmp_path, None)
    assert counting(tmp_path, "squat").version == 2
    (tmp_path / "school/standards/versions/squat-3.npz").write_bytes(b"damaged, too")
    before = holds(tmp_path)
    with pytest.raises(UserError, match=r"squat-3\.npz: is no standard's file"):
        restore("squat", "3", tmp_path, None)
    assert holds(tmp_path) == before


def test_a_file_in_the_place_of_the_schools_folder_is_named(tmp_path: Path) -> None:
    (tmp_path / "school").write_text("")
    with pytest.raises(UserError, match=f"{tmp_path / 'school'} is a file, and no folder; move it away"):
        standards.listed(tmp_path, None, json=False)


def test_one_that_was_copied_to_the_versions_is_listed_with_the_number_of_its_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    put(tmp_path, "a", "b")
    copied = replace(shipped().standards["squat"], version=40, origin="copied")
    (tmp_path / "school/standards/versions/squat-9.npz").write_bytes(encode(copied))
    assert [(row["version"], row["origin"]) for row in squats(tmp_path, capsys)] == [
        (3, "b"),
        (9, "copied"),
        (2, "a"),
        (1, shipped().standards["squat"].origin),
    ]


@pytest.mark.parametrize("version", ["9" * 5000, "0" * 5000, "\u0662", "-1"])
def test_a_number_that_no_standard_has_is_refused_with_those_that_there_are(tmp_path: Path, version: str) -> None:
    put(tmp_path, "by a pupil")
    with pytest.raises(UserError, match=f"^'squat' has no version '{version}'; there are 2, shipped$"):
        restore("squat", version, tmp_path, None)
