"""The folder of a replay's files: nothing of it stays for ever, and a replay that runs keeps it."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from services.cli.replay_folder import replay_folder
from tests.installed import ROOT

RUNS = """
import time
from services.cli.replay_folder import replay_folder
with replay_folder() as folder:
    (folder / "site.toml").write_text("site")
    print(folder, flush=True)
    time.sleep(60)
"""


def test_what_a_killed_replay_left_is_cleared_by_the_next_and_what_a_running_one_has_is_not(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    (tmp_path / "kinebox-replay-notes.txt").write_text("of somebody else")
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    with subprocess.Popen([sys.executable, "-c", RUNS], stdout=subprocess.PIPE, text=True, cwd=ROOT, env=environment) as other:
        try:
            assert other.stdout is not None
            its = Path(other.stdout.readline().strip())
            with replay_folder() as mine:
                assert mine.parent == its.parent == tmp_path
                assert (its / "site.toml").exists()
        finally:
            other.kill()
    assert not mine.exists()
    assert its.exists()
    with replay_folder():
        assert not its.exists()
    assert [left.name for left in tmp_path.iterdir()] == ["kinebox-replay-notes.txt"]


def test_the_folder_of_a_replay_that_is_just_beginning_is_left_to_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    beginning = tmp_path / "kinebox-replay-beginning"
    beginning.mkdir()
    with replay_folder():
        pass
    assert beginning.exists()
