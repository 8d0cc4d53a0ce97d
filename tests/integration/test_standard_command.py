"""`kinebox standard` as people type it: records, imports, brings back and lists, and every refusal is one line and exit code 2."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from services.support.own_standards import OwnStandards
from tests.demonstrations import shown
from tests.installed import ROOT
from tests.integration.school import SITE, file_of, lesson_of


@pytest.mark.slow
@pytest.mark.timeout(300)
def test_as_people_type_it(tmp_path: Path) -> None:
    data = tmp_path / "data"
    lesson_of(data, handed="left")

    def kinebox(*words: str) -> "subprocess.CompletedProcess[str]":
        line = [sys.executable, "-m", "services.cli.main", "standard", *words, "--data", str(data)]
        return subprocess.run(line, capture_output=True, text=True, cwd=ROOT, timeout=100, check=False)

    done = kinebox("record", "lesson", "--attempt", "1")
    assert (done.returncode, done.stderr) == (0, "")
    assert "badminton_clear: version 2 counts now" in done.stdout
    file = file_of(tmp_path / "files", "bvh", shown("badminton_clear")[0])
    done = kinebox("import", str(file), "--action", "badminton_clear")
    assert (done.returncode, done.stderr) == (0, "")
    assert "version 3 counts now" in done.stdout
    done = kinebox(
        "import", str(file), "--action", "badminton_clear", "--start", "0.9", "--exertion", "1.6", "--peak", "1.9", "--end", "2.9"
    )
    assert done.returncode == 0
    assert "version 4 counts now" in done.stdout
    done = kinebox("record", "lesson", "--attempt", "1", "--again")
    assert done.returncode == 0
    assert "badminton_clear: version 5 counts now" in done.stdout
    done = kinebox("restore", "badminton_clear", "2")
    assert (done.returncode, done.stderr) == (0, "")
    assert "version 2 counts again" in done.stdout
    done = kinebox("list")
    assert (done.returncode, done.stderr) == (0, "")
    assert [line.split()[1] for line in done.stdout.splitlines() if line.startswith("badminton")] == ["2", "5", "4", "3", "1"]
    assert len({line.split()[0] for line in done.stdout.splitlines()[1:]}) == 10
    site = tmp_path / "site.toml"
    shutil.copy(SITE.parent / "rig.toml", tmp_path)
    (tmp_path / "elsewhere").mkdir()
    site.write_text(SITE.read_text() + '\n[evaluation]\nteaching = "../elsewhere"\n')
    for words in (
        ("restore", "badminton_clear", "9"),
        ("record", "nothing", "--attempt", "1"),
        ("import", "x.fbx", "--action", "run"),
        ("list", "--site", str(site)),
    ):
        refused = kinebox(*words)
        assert (refused.returncode, refused.stdout) == (2, "")
        assert refused.stderr.startswith("kinebox: ")
        assert refused.stderr.count("\n") == 1
    assert OwnStandards(data / "school").counts("badminton_clear").version == 2
    assert list((tmp_path / "elsewhere").iterdir()) == []
