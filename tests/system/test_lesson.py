"""A lesson recorded from the box as it is shipped, with fusion killed in the middle of it: everything replays, bit for bit."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tests.installed import DATA, ROOT
from tests.integration.waiting import until
from tests.system.test_box import STARTING_S, running, tablet

pytestmark = [pytest.mark.slow, pytest.mark.timeout(240)]


def kinebox(*words: str) -> "subprocess.CompletedProcess[str]":
    command = [sys.executable, "-m", "services.cli.main", *words]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=120, check=False)


def test_fusion_killed_in_a_lesson_costs_a_gap_and_both_segments_replay(tmp_path: Path) -> None:
    lessons = tmp_path / "lessons"
    with running(tmp_path, f'[lessons]\nfolder = "{lessons}"\n') as box, tablet(box) as client:
        client.pose()
        site = ("--site", str(tmp_path / "site.toml"))
        begun = kinebox("record", *site, "--detach", "--title", "With a fault")
        assert begun.returncode == 0, begun.stderr

        def recorded(seconds: float, gaps: int) -> bool:
            recording = box.status()["recording"]
            return isinstance(recording, dict) and recording["recorded_s"] >= seconds and recording["gaps"] == gaps

        until(lambda: recorded(2.0, 0), "two seconds of the lesson", STARTING_S)
        fusion = box.child("fusion")
        assert fusion is not None
        fusion.kill()
        until(lambda: recorded(5.0, 1), "the lesson to go on after a gap", STARTING_S)
        ended = kinebox("record", *site, "--stop")
        assert ended.returncode == 0, ended.stderr
        assert "1 gap" in ended.stdout
    (listed,) = json.loads(kinebox("lessons", *site, "--json").stdout)
    assert (listed["state"], listed["segments"], listed["gaps"], listed["problem"]) == ("finished", 2, 1, "")
    checked = kinebox("replay", listed["file"], "--check", "--data", str(DATA))
    assert checked.returncode == 0, checked.stdout + checked.stderr
    found = re.match(r"all (\d+) motions are equal bit for bit \(2 segments", checked.stdout)
    assert found is not None, checked.stdout
    assert int(found[1]) > 60
