"""A site file of an older version: refused by name, migrated with a backup, never half written."""

import codecs
import datetime as dt
import errno
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

from models.config.migrations import FIRST_VERSION, MIGRATIONS
from models.config.site import SITE_VERSION, decode_site, site_version
from models.errors import UserError
from services.site_file import migration
from services.site_file.migration import migrate_file, migrated_text, rewritten
from services.site_file.reading import read_file
from tests.installed import ROOT

GOLDEN = sorted((ROOT / "tests/golden/sites").glob("*.toml"))
NOW = dt.datetime(2026, 11, 22, 10, 0, 0, tzinfo=dt.UTC)
BACKUP = "site.toml.bak-1-20261122T100000Z"


@pytest.fixture
def old(tmp_path: Path) -> Path:
    file = tmp_path / "site.toml"
    file.write_bytes((ROOT / "tests/golden/sites/every-key-1.toml").read_bytes())
    return file


def test_there_is_one_step_to_every_version_and_a_file_of_every_old_one() -> None:
    assert [step.version for step in MIGRATIONS] == list(range(FIRST_VERSION + 1, SITE_VERSION + 1))
    assert {int(file.stem.rsplit("-", 1)[1]) for file in GOLDEN} == set(range(FIRST_VERSION, SITE_VERSION))


@pytest.mark.parametrize("file", GOLDEN, ids=lambda file: file.stem)
def test_files_of_old_versions_migrate_and_load(file: Path) -> None:
    texts = migrated_text(file.read_bytes(), file)
    assert decode_site(texts.new.encode(), file).version == SITE_VERSION
    comments = [line[line.index("#") :] for line in texts.old.splitlines() if "#" in line]
    assert [line[line.index("#") :] for line in texts.new.splitlines() if "#" in line] == comments


def test_version_2_keeps_every_line_where_it_was(old: Path) -> None:
    texts = migrated_text(old.read_bytes(), old)
    wanted = texts.old.replace("version = 1", "version = 2").replace("offset_ms", "shutter_delay_ms")
    assert texts.new == wanted
    assert [camera.shutter_delay_ms for camera in decode_site(texts.new.encode(), old).cameras] == [12.5, -3.0]


def test_the_old_file_is_kept_beside_the_new_one(old: Path) -> None:
    old.chmod(0o640)
    before = old.read_bytes()
    texts, backup = migrate_file(old, NOW)
    assert backup == old.with_name(BACKUP)
    assert backup.read_bytes() == before
    assert old.read_text() == texts.new
    assert {file.name: file.stat().st_mode & 0o777 for file in old.parent.iterdir()} == {"site.toml": 0o640, BACKUP: 0o640}
    assert migrate_file(old, NOW)[1] is None


def test_the_old_file_is_named_as_the_site_file_was(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(old.parent)
    assert migrate_file(Path("site.toml"), NOW)[1] == Path(BACKUP)


def test_of_a_link_the_old_file_is_named_where_it_is(old: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "links").mkdir()
    (tmp_path / "links/site.toml").symlink_to(old)
    monkeypatch.chdir(tmp_path / "links")
    assert migrate_file(Path("site.toml"), NOW)[1] == old.with_name(BACKUP)


def test_a_link_to_a_site_file_stays_a_link(old: Path, tmp_path: Path) -> None:
    link = tmp_path / "link.toml"
    link.symlink_to(old)
    migrate_file(link, NOW)
    assert link.is_symlink()
    assert decode_site(link.read_bytes(), link).version == SITE_VERSION


def test_windows_line_ends_stay(old: Path) -> None:
    old.write_bytes(old.read_bytes().replace(b"\n", b"\r\n"))
    migrate_file(old, NOW)
    data = old.read_bytes()
    assert data.count(b"\r\n") == data.count(b"\n") > 40


@pytest.mark.parametrize(
    ("right", "wrong", "line"),
    [
        ("[fusion]", "[fusian]", r"^site file .*, once migrated, would be refused and was left as it is: fusian: .*'fusion'"),
        ("offset_ms  =  12.5", 'offset_ms = "late"', r"left as it is: \[\[cameras\]\] no\. 1 .* shutter_delay_ms: "),
        (
            'kind = "video"',
            'kind = "simulated"',
            r"^site file .*site\.toml: cameras\[0\] is simulated, and its lesson says how late it exposes; delete offset_ms$",
        ),
        ('"offset_ms" = -3', "offset_ms = -3\nshutter_delay_ms = 4", r"cameras\[1\] has both offset_ms and shutter_delay_ms"),
        ("version = 1", "version = 99", r"version 99 is for a newer KineBox"),
        ("version = 1", "version = 0", r"version: found 0, "),
        ("version = 1", "version = true", r"version: found true, "),
        ("version = 1", "", r"key 'version' is missing"),
        ("version = 1", "version = ", r"site file .*site\.toml"),
    ],
)
def test_a_file_that_cannot_be_migrated_is_named_and_left_alone(old: Path, right: str, wrong: str, line: str) -> None:
    old.write_text(old.read_text().replace(right, wrong))
    before = old.read_bytes()
    with pytest.raises(UserError, match=line):
        migrate_file(old, NOW)
    assert old.read_bytes() == before
    assert list(old.parent.iterdir()) == [old]


@pytest.mark.parametrize("cameras", ["3", "[]", "[1, 2]", '["a"]', "{}"])
def test_cameras_that_are_none_are_named_by_the_schema(cameras: str) -> None:
    with pytest.raises(UserError, match=r": cameras: found "):
        migrated_text(f'version = 1\nname = "x"\ncalibration = "rig.toml"\ncameras = {cameras}\n'.encode(), "site.toml")


def test_a_backup_is_never_overwritten(old: Path) -> None:
    backup = old.with_name(BACKUP)
    backup.write_text("the only copy of something")
    with pytest.raises(UserError, match=f"File exists .*{BACKUP}"):
        migrate_file(old, NOW)
    assert backup.read_text() == "the only copy of something"
    assert tomllib.loads(old.read_text())["version"] == 1


FULL_DISK = """
import datetime as dt, resource, sys
from pathlib import Path
from models.errors import UserError
from services.site_file.reading import read_file
from services.site_file.migration import migrate_file
resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
try:
    migrate_file(Path(sys.argv[1]), dt.datetime.now(dt.UTC))
except UserError as error:
    print(error)
"""


@pytest.mark.slow
def test_a_disc_without_room_leaves_the_file_and_nothing_else(old: Path) -> None:
    before = old.read_bytes()
    result = subprocess.run([sys.executable, "-c", FULL_DISK, str(old)], cwd=ROOT, capture_output=True, text=True, check=True)
    assert "cannot be migrated: File too large" in result.stdout
    assert old.read_bytes() == before
    assert list(old.parent.iterdir()) == [old]


@pytest.mark.parametrize("safe_names", [0, 1, 2])
def test_what_a_failing_disk_left_is_told_as_it_is(old: Path, monkeypatch: pytest.MonkeyPatch, safe_names: int) -> None:
    """The names of the backup, of the new file and of the migrated one are made safe, in this order."""
    before, synced = old.read_bytes(), list[Path]()

    def sync_folder(folder: Path) -> None:
        if len(synced) == safe_names:
            raise OSError(errno.EIO, "Input/output error")
        synced.append(folder)

    monkeypatch.setattr(migration, "sync_folder", sync_folder)
    with pytest.raises(UserError) as refused:
        migrate_file(old, NOW)
    told = str(refused.value)
    assert "Input/output error" in told
    if safe_names < 2:
        assert "was left as it is; make room on its disk" in told
        assert old.read_bytes() == before
    else:
        assert re.search(rf"was migrated, .*; mend its disk, .*'version = {SITE_VERSION}' \(the old one is .*{BACKUP}\)", told)
        assert (site_version(old.read_bytes(), old), (old.parent / BACKUP).read_bytes()) == (SITE_VERSION, before)


def test_an_end_before_the_new_file_takes_its_place_leaves_the_old_one(old: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The new file is whole under another name before it takes the place of the old one, which is safe by then."""
    before = old.read_bytes()
    rename = Path.replace
    seen: list[bool] = []

    def replace(temporary: Path, file: Path) -> Path:
        seen.append(old.with_name(BACKUP).read_bytes() == before == file.read_bytes())
        seen.append(decode_site(temporary.read_bytes(), temporary).version == SITE_VERSION)
        return rename(temporary, file)

    monkeypatch.setattr(Path, "replace", replace)
    migrate_file(old, NOW)
    assert seen == [True, True]


TEXT = """\
# of the gym
gone = 1 # why
name = "x" # said aloud

[table] # heading
old = 2 # two
stays = 3
# before the list
[[list]]
a = 1 # first
# before the second
[[list]]
a = 2
"""


def test_a_text_is_changed_only_where_it_says_something_else() -> None:
    new = {"name": "y", "table": {"new": 2, "stays": 3, "more": [4]}, "list": [{"a": 1}, {"a": 5, "b": True}]}
    assert rewritten(TEXT, new).splitlines() == [
        "# of the gym",
        'name = "y" # said aloud',
        "",
        "[table] # heading",
        "new = 2 # two",
        "stays = 3",
        "# before the list",
        "more = [4]",
        "[[list]]",
        "a = 1 # first",
        "# before the second",
        "[[list]]",
        "a = 5",
        "b = true",
    ]


def test_a_list_of_tables_with_another_table_in_between_loses_no_value() -> None:
    text = "[[list]]\nold = 1 # first\n[table]\na = 1\n[[list]]\nold = 2\n"
    new = {"list": [{"new": 1}, {"new": 2}], "table": {"a": 1}}
    assert tomllib.loads(rewritten(text, new)) == new


def test_a_mark_of_the_byte_order_is_read_over_and_not_written(old: Path) -> None:
    # As Windows' editor saves a text.
    marked = codecs.BOM_UTF8 + old.read_bytes()
    plain = migrated_text(old.read_bytes(), old)
    old.write_bytes(marked)
    texts, backup = migrate_file(old, NOW)
    assert texts == plain
    assert old.read_bytes() == plain.new.encode()
    assert backup is not None
    assert backup.read_bytes() == marked
    old.write_bytes(codecs.BOM_UTF8 + old.read_bytes())
    assert read_file(old, "site file") == plain.new.encode()
    assert migrate_file(old, NOW)[1] is None
