"""A name that no file can have is told in one line by every command that takes one, and is no defect with a traceback."""

import subprocess
import sys
from itertools import cycle
from pathlib import Path

import pytest

from tests.integration.box import ROOT, write_site
from tests.ports import free_port

pytestmark = pytest.mark.slow

LONG = "l" * 300
DEEP = "d/" * 3000
"""No folder has room for the one, no system for the other; what the commands make of them is the same."""
COMMANDS: dict[str, tuple[str, ...]] = {
    "replay": ("replay", "{name}"),
    "replay --check": ("replay", "{name}", "--check"),
    "report": ("report", "{name}"),
    "export": ("export", "{name}", "--format", "trc"),
    "lessons delete": ("lessons", "delete", "{name}", "--yes"),
    "lessons --data": ("lessons", "--data", "{name}"),
    "simulate": ("simulate", "{name}"),
    "simulate --out": ("simulate", "tiny", "--out", "{name}"),
    "standard import": ("standard", "import", "{name}.bvh", "--action", "squat"),
    "run": ("run", "--site", "{name}"),
    "run --data": ("run", "--site", "{site}", "--data", "{name}"),
    "record": ("record", "--site", "{name}"),
    "config check": ("config", "check", "{name}"),
    "config migrate": ("config", "migrate", "{name}"),
    "logs": ("logs", "--data", "{name}"),
    "logs export": ("logs", "export", "{name}.zip"),
    "process": ("process", "fusion", "--site", "{name}"),
}
TAKES_LESSONS = ("replay", "replay --check", "report", "export")


@pytest.mark.parametrize(("command", "name"), list(zip(COMMANDS, cycle((LONG, DEEP)), strict=False)), ids=COMMANDS)
def test_a_name_that_is_too_long_is_one_short_line(tmp_path: Path, command: str, name: str) -> None:
    site = write_site(tmp_path, free_port(), free_port())
    words = [word.format(name=name, site=site) for word in COMMANDS[command]]
    result = subprocess.run(
        [sys.executable, "-m", "services.cli.main", *words], capture_output=True, text=True, cwd=ROOT, timeout=60, check=False
    )
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.startswith("kinebox: ")
    assert result.stderr.count("\n") == 1
    if command in TAKES_LESSONS:
        assert "is too long for the name of a file; shorten it" in result.stderr
